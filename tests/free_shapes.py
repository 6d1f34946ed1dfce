"""Effects and laws of a free shape for tests: their spans and knots, and their curves by scipy."""

import numpy as np
from scipy.interpolate import CubicHermiteSpline

# Each with a span over which these runs go, and the places of its knots over the span.
ZERO_UP, ANCHORED, BOTH_WAYS = np.linspace(0, 1, 5), np.linspace(0.2, 1, 5), np.linspace(-1, 1, 5)
SHAPES = {
    "free_friction_speed": (0.02, ANCHORED),
    "free_friction_angle": (1.5, BOTH_WAYS),
    "free_friction_load": (1e-6, ZERO_UP),
    "free_friction_age": (0.1, ZERO_UP),
    "free_adhesion_angle": (1.5, BOTH_WAYS),
    "free_adhesion_age": (0.1, ZERO_UP),
    "free_contact_place": (1.5, BOTH_WAYS),
    "free_drag_angle": (1.5, BOTH_WAYS),
    "free_drag_speed": (0.02, ZERO_UP),
    "free_drag_rate": (500.0, ZERO_UP),
    "free_field_time": (0.1, ZERO_UP),
    "free_field_frequency": (200.0, ZERO_UP),
    "free_field_amplitude": (2.5, ZERO_UP),
}
LAWS = {
    "free_friction_speed": ("sliding_friction", "slip_speed"),
    "free_friction_angle": ("friction", "tilt"),
    "free_friction_load": ("friction", "load"),
    "free_friction_age": ("friction", "time"),
    "free_adhesion_angle": ("adhesion", "tilt"),
    "free_adhesion_age": ("adhesion", "age"),
    "free_drag_angle": ("drag", "tilt"),
    "free_drag_speed": ("drag", "speed"),
    "free_drag_rate": ("fluid", "rate"),
}
KNOTS = (0.1, -0.15, 0.2, -0.1, 0.15)


def shaped(name, knots, span=None):
    """Keys of an effect or a law with these knots."""
    span = SHAPES[name][0] if span is None else span
    section = f"laws.{name}" if name in LAWS else f"effects.{name}"
    given = {f"{section}.knot_{i}": float(knot) for i, knot in enumerate(knots, 1)}
    if name not in LAWS:
        return {**given, f"{section}.span": span}
    quantity, over = LAWS[name]
    law = {"quantity": quantity, "over": over, "form": "curve", "fraction": 1.0, "scale": span}
    return {**given, **{f"{section}.{key}": value for key, value in law.items()}}


def curve(name, knots, arguments, span=None):
    """f by scipy, from slopes that are computed here."""
    usual, places = SHAPES[name]
    span = usual if span is None else span
    x, y = np.array(places) * span, np.array(knots, float)
    if places is ANCHORED:
        x, y = np.concatenate([[0.0], x]), np.concatenate([[0.0], y])
    slopes = np.gradient(y, x)
    slopes[-1] = 0.0
    if places is BOTH_WAYS:
        slopes[0] = 0.0
    return CubicHermiteSpline(x, y, slopes)(np.clip(arguments, x[0], x[-1]))
