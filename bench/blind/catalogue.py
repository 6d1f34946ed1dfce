"""Catalogue of what a data set may hide: causes, laws outside the library, distorted readings.

Every entry has sizes for an amount of 1; the amount is scaled until the signal to noise is that of
the kind. Where the form of a law is a matter of choice it differs from the library's: friction
falls as 1/(1 + (v/vs)^2), drag goes with |cos theta|, patches are triangles.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

Value = float | str


@dataclass(frozen=True)
class Entry:
    """Something to hide.

    sizes: Variants, of which one is drawn: parameters at an amount of 1, SI units. offset: What
    a parameter has at an amount of 0, if that is not 0. fixed: Parameters that no amount
    changes. An entry without them has the library's form. drawn: Parameters that are drawn,
    uniform in the logarithm. least, most: Range of the amount; one below 0 may have either
    sign. rivals: Causes and constants of another kind that look alike. A law has to be as strong as
    its kind asks for beside each of them: what one of them explains is no truth outside the
    library.
    """

    sizes: tuple[Mapping[str, float], ...]
    most: float = 10.0
    least: float = 0.0
    offset: Mapping[str, float] = field(default_factory=dict)
    fixed: Mapping[str, Value] = field(default_factory=dict)
    drawn: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    rivals: tuple[str, ...] = ()


# Voltage of a coil at 3 mT, the largest peak of the study: 10 ohm, 0.9626 mT/A.
TOP_VOLTAGE = 31.2

CAUSES = {
    "coil_heating": Entry(({"coefficient": 2e-3},), 20.0, fixed={"form": "pulses"}),
    "amplifier_limit": Entry(
        ({"voltage": -0.2 * TOP_VOLTAGE},), 3.3, offset={"voltage": TOP_VOLTAGE}
    ),
    "eddy_lag": Entry(({"time": 3e-4},), 8.0),
    "sample_hold": Entry(({"period": 5e-4},), 8.0),
    "edge_time": Entry(({"time": 5e-4},), 6.0),
    "mutual_inductance": Entry(({"coupling": 0.03},), 7.0, -20.0),
    "gradient_scale": Entry(({"fraction": 0.5},), 10.0, -1.8),
    "field_gain": Entry(({"in_plane": 0.05}, {"clamp": 0.05}), 8.0, -8.0),
    "misalignment": Entry(({"angle": 0.04},), 20.0, -20.0),
    "magnetization_scale": Entry(({"fraction": 0.05},), 10.0, -10.0),
    "ambient_field": Entry(({"Bx": 5e-5}, {"Bz": 5e-5}), 10.0, -10.0),
    "stribeck_friction": Entry(({"speed": 8e-3},), 5.0, fixed={"form": "rational"}),
    "viscous_friction": Entry(({"coefficient": 10.0},), 15.0, fixed={"power": 0.8, "scale": 0.02}),
    "friction_anisotropy": Entry(({"fraction": 0.1},), 7.0, -7.0),
    "angle_adhesion": Entry(({"strength": 0.3},), 3.3, -10.0, fixed={"power": 1.0}),
    "adhesion_ageing": Entry(({"rate": 0.3},), 15.0, fixed={"form": "rise", "time": 5e-3}),
    "restitution": Entry(({"coefficient": 0.2},), 2.5),
    "angle_drag": Entry(({"amplitude": 3.0},), 7.0, fixed={"power": 1.0}),
    "quadratic_drag": Entry(({"coefficient": 1e-3},), 40.0),
    "rotational_drag": Entry(({"coefficient": 2e-14},), 15.0),
    "surface_tilt": Entry(({"angle": 0.01},), 20.0, -20.0),
    "friction_patches": Entry(
        ({"amplitude": 0.2},), 4.5, fixed={"form": "triangle"}, drawn={"period": (2e-4, 1e-3)}
    ),
    "length_scale": Entry(({"fraction": 0.03},), 13.0, -10.0),
    "clock_scale": Entry(({"fraction": 0.03},), 13.0, -10.0),
    "angle_offset": Entry(({"angle": 0.02},), 15.0, -15.0),
}


# What of, over what, in which form.
_Words = tuple[str, str, str]
_FRICTION, _ADHESION = "contact.kinetic_friction", "contact.adhesion"
_GAINS = ("magnetization_scale", "field_gain")


def _law(
    words: _Words,
    rivals: tuple[str, ...],
    amplitude: float,
    span: tuple[float, float] = (0.0, 10.0),
    scale: float | None = None,
    exponent: float = 1.0,
) -> Entry:
    """A law of one argument, its usual amplitude, the range of its amount, the form's numbers."""
    target, argument, form = words
    fixed: dict[str, Value] = {"target": target, "argument": argument, "form": form}
    fixed |= {"exponent": exponent}
    drawn = {} if scale is None else {"scale": (0.7 * scale, 1.4 * scale)}
    least, most = span
    return Entry(({"amplitude": amplitude},), most, least, {}, fixed, drawn, rivals)


LAWS = {
    "friction_speed": _law(
        ("sliding", "slip_speed", "hump"), ("friction_anisotropy", _FRICTION), 0.3, (0.0, 10.0),
        0.01, 0.5,
    ),
    "friction_angle": _law(
        ("friction", "angle", "sine"), ("angle_adhesion", _FRICTION), 0.5, (-1.5, 4.0)
    ),
    "friction_load": _law(
        ("friction", "load", "rational"), ("angle_adhesion", _FRICTION), 0.3, (-2.0, 10.0), 4e-7
    ),
    "friction_age": _law(("friction", "time", "rise"), (_FRICTION,), -0.2, (0.0, 3.5), 0.15),
    "adhesion_angle": _law(
        ("adhesion", "angle", "gaussian"), (_ADHESION,), 0.5, (-1.8, 10.0), 0.12
    ),
    "adhesion_age": _law(
        ("adhesion", "age", "power"), ("angle_adhesion", _ADHESION), 0.3, (0.0, 10.0), 5e-3, 0.5
    ),
    "drag_angle": _law(("drag", "angle", "sine"), ("quadratic_drag",), 3.0),
    "drag_speed": _law(("drag", "speed", "power"), ("angle_drag",), 1.0, (0.0, 10.0), 0.01, 0.5),
    "drag_rate": _law(
        ("fluid", "rate", "power"), ("rotational_drag", "quadratic_drag"), 1.0, (0.0, 10.0),
        100.0, 0.5,
    ),
    "field_time": _law(("field", "time", "rise"), _GAINS, 0.05, (-10.0, 10.0), 0.2),
    "field_frequency": _law(
        ("field", "frequency", "hump"), ("eddy_lag",), 0.05, (0.0, 10.0), 60.0, 0.25
    ),
    "field_amplitude": _law(("field", "current", "saturation"), _GAINS, -0.1, (0.0, 8.0), 2.0),
}  # fmt: skip
"""Truths outside the library, by the one place where each acts and what it depends on there.

The names are those of the extensions `free_*` of free shape, without that beginning.
"""

HOOK_OF = {
    "stribeck_friction": "friction_speed",
    "viscous_friction": "friction_speed",
    "angle_adhesion": "adhesion_angle",
    "adhesion_ageing": "adhesion_age",
    "angle_drag": "drag_angle",
    "quadratic_drag": "drag_speed",
    **{f"free_{name}": name for name in LAWS},
}
"""Where a cause of the library acts, if it is a law of one argument."""

INSTRUMENTS = {
    "velocity_offset": Entry(({"offset": 2e-5},), 30.0, -30.0),
    "velocity_clipping": Entry(({"share": 0.1},), 8.0),
    "angle_scale": Entry(({"fraction": 0.04},), 10.0, -10.0),
    "angle_clipping": Entry(({"share": 0.1},), 8.0),
    "probe_turned": Entry(({"angle": 0.02},), 15.0, -15.0),
    "probe_clipping": Entry(({"share": 0.1},), 8.0),
    "film_delay": Entry(({"time": 1e-3},), 10.0, -10.0),
    "film_clipping": Entry(({"share": 0.1},), 8.0),
    "marker_place": Entry(({"along": 2e-5}, {"above": 2e-5}), 10.0, -10.0),
}
"""Distortions of what is read that are no cause of the library; `share` is cut off the top."""

HIDING = (
    ("magnetization_scale", "field_gain"),
    ("misalignment", "ambient_field"),
    ("surface_tilt", "friction_anisotropy"),
    ("eddy_lag", "edge_time"),
    ("field_gain", "coil_heating"),
    ("rotational_drag", "quadratic_drag"),
    ("length_scale", "surface_tilt"),
    ("ambient_field", "surface_tilt"),
)
"""Causes of which the first hides the second, which looks much like it."""


def entry(name: str) -> Entry:
    """The entry of a cause, a law or a distortion."""
    return {**CAUSES, **LAWS, **INSTRUMENTS}[name]


def parameters(name: str, base: Mapping[str, Value], amount: float) -> dict[str, Value]:
    """Parameters at an amount; `base` has what was drawn for an amount of 1."""
    own = entry(name)
    changing = {key for each in own.sizes for key in each}
    return {
        key: own.offset.get(key, 0.0) + amount * value
        if key in changing and not isinstance(value, str)
        else value
        for key, value in base.items()
    }
