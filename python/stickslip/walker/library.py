"""The simulator's effects as causes.

Names, units, meanings and possible ranges are the core's. Here stand the sizes that would not
surprise: rough orders of what the paper's apparatus could hide, which are the widths of the priors.
"""

from __future__ import annotations

import math
from collections.abc import Collection

import numpy as np

from stickslip._util.prior import Prior
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.scenario.effects import effects, is_free_shape
from stickslip.scenario.keys import PREFIX, Key, known_keys
from stickslip.scenario.scenario import Scenario

_SIZES = {
    "coil_heating.coefficient": (1e-3, 0.0, 0.02),
    "eddy_lag.time": (3e-4, 0.0, 5e-3),
    "sample_hold.period": (4e-4, 0.0, 4e-3),
    "mutual_inductance.coupling": (0.05, -0.19, 0.3),
    "gradient_scale.fraction": (0.3, -0.9, 3.0),
    "field_gain.in_plane": (0.05, -0.5, 0.6),
    "field_gain.clamp": (0.05, -0.5, 0.6),
    "misalignment.angle": (0.08, -1.5, 1.5),
    "ambient_field.Bx": (5e-5, -5e-4, 5e-4),
    "ambient_field.Bz": (5e-5, -5e-4, 5e-4),
    "stribeck_friction.velocity": (4e-3, 0.0, 0.1),
    "viscous_friction.coefficient": (10.0, 0.0, 200.0),
    "friction_anisotropy.fraction": (0.12, -0.8, 0.8),
    "angle_adhesion.strength": (0.5, -4.0, 1.0),
    "adhesion_ageing.rate": (0.2, 0.0, 5.0),
    "angle_drag.strength": (1.0, -0.9, 20.0),
    "quadratic_drag.coefficient": (1e-3, 0.0, 0.05),
    # About that of a sphere of the magnet's size in water, 8 pi times viscosity times radius cubed.
    "rotational_drag.coefficient": (1e-13, 0.0, 1e-12),
    "surface_tilt.angle": (0.025, -0.3, 0.3),
    "friction_patches.amplitude": (0.2, 0.0, 0.9),
}
"""Size that would not surprise, and lowest and highest value of the search, in SI units."""

_SHAPES = {"adhesion_ageing.time": 0.01, "friction_patches.period": 5e-4}
"""Middle of the prior of a parameter that says how a cause looks, not how strong it is."""

_SHAPE_FACTOR = math.exp(0.7)
"""Standard deviation of a shape's prior, as a factor. Chosen: two."""

_NEGLIGIBLE = {"sample_hold.period": 1e-4}
"""A controller as fast as this, s, is costly to simulate and looks like one without steps."""

_FINENESS = {"sample_hold.period": 0.01}
"""How the steps fall into a hundred pulses changes with parts in a thousand of the period."""

_CLIP_SIZE, _CLIP_LOWEST = 0.15, 0.3
"""Size and lowest value of the amplifiers' limit, in the largest voltage. Chosen: rough orders."""

_SIZES_IN_RANGE = 5.0
"""Sizes from `absent` to the farther end of a range. Chosen: a fifth of what is possible does not
surprise where nothing else is known, as of a user's own effect."""

_ACROSS = {"effects.ambient_field.By", "effects.surface_tilt.azimuth"}
"""What pushes or turns a robot out of the plane y = 0 of the data."""

CONSTANTS = {
    "edge_time": ("drive.edge_time", (4e-4, 0.0, 4e-3)),
    "magnetization_scale": ("robot.magnetization", (0.1, -0.6, 1.0)),
    "restitution": ("contact.restitution", (0.15, 0.0, 0.8)),
}
"""Causes that are a constant which is other than stated, and its change: size, lowest, highest.

Those of `_PARTS` are parts of it."""

_SHAKEN_KEYS = "shake.amplitude_x", "shake.amplitude_z", "inner.amplitude", "inner.stiffness"
SHAKEN = {key.replace(".", "_"): (key, (0.1, -0.6, 1.0)) for key in _SHAKEN_KEYS}
"""The same of what shakes a robot, where it does. Chosen: what is known to a tenth."""

_PARTS = {"robot.magnetization", *_SHAKEN_KEYS}

_ALIKE = {
    **{name: key for name, (key, _) in (*CONSTANTS.items(), *SHAKEN.items())},
    # Torques against turning by the rate and by its square: over drives of the paper's range a
    # change of one changes the velocities as a change of the other does, to a cosine of 0.99.
    "rotational_drag": "drag.rotational",
}
"""Causes that look like a constant: not offered where that is uncertain."""


def library(scenario: Scenario, uncertain: Collection[str], volts: float) -> tuple[Cause, ...]:
    """All effects with a known law that the model does not have yet, `CONSTANTS` and `SHAKEN`.

    Curves of a free shape are in `laws`. Values of single coils are measured, and `field_gain`
    stands for them. The scenario's own effects are part of the model, and no causes; so is an
    effect with a parameter in `uncertain`: dotted keys of constants that are uncertain, or that
    conditions state on their own. `volts` is the largest voltage of the drives, V, where the
    amplifiers' limit begins to act.
    """
    named = {key.split(".")[1] for key in uncertain if key.startswith(PREFIX)}
    same = {name for name, constant in _ALIKE.items() if constant in uncertain}
    known = {**CONSTANTS, **SHAKEN}
    constants = [_constant(name, *known[name], scenario) for name in known if name not in same]
    return tuple(filter(None, constants)) + tuple(
        Cause(
            effect.name,
            tuple(_parameter(key, volts) for key in effect.parameters if key.name not in _ACROSS),
            effect.meaning,
        )
        for effect in effects()
        if effect.parameters
        and effect.name not in {*scenario.effects, *named, *same}
        and not is_free_shape(effect.name)
    )


def _constant(name: str, key: str, changes: tuple[float, ...], scenario: Scenario) -> Cause | None:
    """A constant that is other than stated; None where it is at the end of its range, or zero."""
    known, stated = known_keys()[key], float(scenario.get(key))
    size, low, high = np.array(changes) * (abs(stated) if key in _PARTS else 1.0)
    low, high = max(known.low, stated + low), min(known.high, stated + high)
    if not low < high:
        return None
    parameter = Parameter(key, unit=known.unit, low=low, high=high, size=size, absent=stated)
    return Cause(name, (parameter,), f"{key} is other than stated")


def _parameter(key: Key, volts: float) -> Parameter:
    name = key.name.removeprefix(PREFIX)
    if name == "amplifier_limit.voltage":
        lowest, size = _CLIP_LOWEST * volts, _CLIP_SIZE * volts
        return Parameter(key.name, unit=key.unit, low=lowest, high=volts, size=size, falls=True)
    if name in _SHAPES:
        prior = Prior("log-normal", _SHAPES[name], _SHAPE_FACTOR)
        return Parameter(key.name, prior, key.unit, key.low, key.high, cause=False)
    absent = float(key.default)
    farthest = max(key.high - absent, absent - key.low)
    size, low, high = _SIZES.get(name, (farthest / _SIZES_IN_RANGE, key.low, key.high))
    return Parameter(
        key.name,
        unit=key.unit,
        low=low,
        high=high,
        size=size,
        absent=absent,
        negligible=_NEGLIGIBLE.get(name, 0.0),
        fineness=_FINENESS.get(name, 1.0),
    )
