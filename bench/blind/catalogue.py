"""What can be hidden in a data set, as data: causes, laws outside the library, distorted readings.

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

    Attributes
    ----------
    sizes : tuple of dict
        Variants, of which one is drawn: parameters at an amount of 1, SI units.
    offset : dict
        What a parameter has at an amount of 0, if that is not 0.
    fixed : dict
        Parameters that no amount changes. An entry without them has the library's form.
    drawn : dict of (low, high)
        Parameters that are drawn, uniform in the logarithm.
    least, most : float
        Range of the amount; one below 0 may have either sign.
    accepted : tuple of str
        Names that are as right as its own, since no velocity tells them apart.
    """

    sizes: tuple[Mapping[str, float], ...]
    most: float = 10.0
    least: float = 0.0
    offset: Mapping[str, float] = field(default_factory=dict)
    fixed: Mapping[str, Value] = field(default_factory=dict)
    drawn: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    accepted: tuple[str, ...] = ()


# Voltage of a coil at 3 mT, the largest peak of the study: 10 ohm, 0.9626 mT/A.
_TOP_VOLTAGE = 31.2
_SCALES = ("length_scale", "clock_scale")

CAUSES = {
    "coil_heating": Entry(({"coefficient": 2e-3},), 20.0, fixed={"form": "pulses"}),
    "amplifier_limit": Entry(
        ({"voltage": -0.2 * _TOP_VOLTAGE},), 3.3, offset={"voltage": _TOP_VOLTAGE}
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
    "length_scale": Entry(({"fraction": 0.03},), 13.0, -10.0, accepted=_SCALES),
    "clock_scale": Entry(({"fraction": 0.03},), 13.0, -10.0, accepted=_SCALES),
    "angle_offset": Entry(({"angle": 0.02},), 15.0, -15.0),
}


def _law(target: str, argument: str, form: str, amplitude: float, **more: object) -> Entry:
    """A law of one argument: what of, form, usual amplitude, and `scale`, `exponent`, the range."""
    fixed: dict[str, Value] = {"target": target, "argument": argument, "form": form}
    fixed["exponent"] = float(more.pop("exponent", 1.0))  # type: ignore[arg-type]
    scale = float(more.pop("scale", 1.0))  # type: ignore[arg-type]
    drawn = {"scale": (0.7 * scale, 1.4 * scale)} if scale != 1.0 else {}
    return Entry(({"amplitude": amplitude},), fixed=fixed, drawn=drawn, **more)  # type: ignore[arg-type]


LAWS = {
    "friction_speed": _law("sliding", "slip_speed", "hump", 0.3, scale=0.01, exponent=0.5),
    "friction_angle": _law("friction", "angle", "sine", 0.5, most=4.0, least=-1.5),
    "friction_load": _law("friction", "load", "rational", 0.3, scale=4e-7, least=-2.0),
    "friction_age": _law("friction", "time", "rise", -0.2, scale=0.15, most=3.5),
    "adhesion_angle": _law("adhesion", "angle", "gaussian", 0.5, scale=0.12, least=-1.8),
    "adhesion_age": _law("adhesion", "age", "power", 0.3, scale=5e-3, exponent=0.5),
    "drag_angle": _law("drag", "angle", "sine", 3.0, exponent=1.0),
    "drag_speed": _law("drag", "speed", "power", 1.0, scale=0.01, exponent=0.5),
    "drag_rate": _law("fluid", "rate", "power", 1.0, scale=100.0, exponent=0.5),
    "field_time": _law("field", "time", "rise", 0.05, scale=0.2, least=-10.0),
    "field_frequency": _law("field", "frequency", "hump", 0.05, scale=60.0, exponent=0.25),
    "field_amplitude": _law("field", "current", "saturation", -0.1, scale=2.0, most=8.0),
}
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

INSTRUMENT_NAMES = (*INSTRUMENTS, *_SCALES, "angle_offset")
"""All names that say that a reading is wrong, and not the robot."""

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
