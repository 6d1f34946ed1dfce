"""The simulator's named extensions as causes: size that would not surprise, and range to search.

Names, units, meanings and physical ranges are the core's. The sizes here are rough orders of what
the apparatus of the paper could hide, and are the width of each amplitude's prior.
"""

from __future__ import annotations

from stickslip.diagnosis.model.problem import Cause, CauseParameter
from stickslip.scenario.keys import Key
from stickslip.scenario.named_effects import effects, is_lawful
from stickslip.scenario.priors import Prior
from stickslip.scenario.scenario import Scenario

# Scale of the prior, and lowest and highest value that is searched, in the parameter's unit.
_SIZES = {
    "coil_heating.coefficient": (1e-3, 0.0, 0.02),
    "eddy_lag.time": (3e-4, 0.0, 5e-3),
    "sample_hold.period": (4e-4, 0.0, 4e-3),
    "edge_time.time": (4e-4, 0.0, 4e-3),
    "mutual_inductance.coupling": (0.05, -0.19, 0.3),
    "gradient_scale.fraction": (0.3, -0.9, 3.0),
    "field_gain.in_plane": (0.05, -0.5, 0.6),
    "field_gain.clamp": (0.05, -0.5, 0.6),
    "misalignment.angle": (0.08, -1.5, 1.5),
    "magnetization_scale.fraction": (0.1, -0.6, 1.0),
    "ambient_field.Bx": (5e-5, -5e-4, 5e-4),
    "ambient_field.Bz": (5e-5, -5e-4, 5e-4),
    "stribeck_friction.velocity": (4e-3, 0.0, 0.1),
    "viscous_friction.coefficient": (10.0, 0.0, 200.0),
    "friction_anisotropy.fraction": (0.12, -0.8, 0.8),
    "angle_adhesion.strength": (0.5, -4.0, 1.0),
    "adhesion_ageing.rate": (0.2, 0.0, 5.0),
    "restitution.coefficient": (0.15, 0.0, 0.8),
    "angle_drag.strength": (1.0, -0.9, 20.0),
    "quadratic_drag.coefficient": (1e-3, 0.0, 0.05),
    # About that of a sphere of the magnet's size in water, 8 pi times viscosity times radius cubed.
    "rotational_drag.coefficient": (1e-13, 0.0, 1e-12),
    "surface_tilt.angle": (0.025, -0.3, 0.3),
    "friction_patches.amplitude": (0.2, 0.0, 0.9),
    "length_scale.fraction": (0.03, -0.3, 0.4),
    "clock_scale.fraction": (0.03, -0.3, 0.4),
    "angle_offset.angle": (0.03, -0.3, 0.3),
}
# Middle of the prior of a parameter that says how the cause looks, in its unit: rough orders too.
_SHAPES = {"adhesion_ageing.time": 0.01, "friction_patches.period": 5e-4}
# A controller that is this fast, s, cannot be told from one without steps, but takes long to
# simulate.
_NEGLIGIBLE = {"sample_hold.period": 1e-4}
# How its steps fall into some hundred pulses changes with parts in a thousand of the period.
_FINENESS = {"sample_hold.period": 0.01}
# What pushes or turns a robot out of the plane y = 0, in which the data of a diagnosis are.
_ACROSS = {"effects.ambient_field.By", "effects.surface_tilt.azimuth"}
# Shares of the largest voltage, for the amplifier's limit: the scale of its prior, and the lowest
# value that is searched. Chosen as rough orders too.
_CLIP_SCALE, _CLIP_LOWEST = 0.15, 0.3
# Where only the range of a parameter is known, its scale is the distance from where it does nothing
# to the farther end over this. Chosen: a fifth of what is possible does not surprise.
_SCALES_IN_RANGE = 5.0


def library(scenario: Scenario, uncertain: dict[str, Prior], volts: float) -> tuple[Cause, ...]:
    """All extensions of a known law that the scenario does not know yet, as causes.

    A free shape fits whatever is odd at its place, so that it would always win: it is no cause. Nor
    are a coil's own values, which are measured, and which `field_gain` stands for.

    Parameters
    ----------
    scenario : Scenario
        An extension that it already has is part of the baseline.
    uncertain : dict of Prior
        An extension of which a parameter is uncertain is part of the baseline too.
    volts : float
        Largest voltage of the drives, V; the voltage limit begins to act there.
    """
    stated = {key.split(".")[1] for key in uncertain if key.startswith("effects.")}
    return tuple(
        Cause(
            each.name,
            tuple(_parameter(key, volts) for key in each.parameters if key.name not in _ACROSS),
            each.meaning,
        )
        for each in effects()
        if each.parameters
        and each.name not in {*scenario.effects, *stated}
        and is_lawful(each.name)
    )


def _parameter(key: Key, volts: float) -> CauseParameter:
    """A parameter of a cause; of one without a row above, as a user's, only the range is known."""
    name = key.name.removeprefix("effects.")
    named = key.name, key.unit
    if name == "amplifier_limit.voltage":
        return CauseParameter(
            *named, _CLIP_LOWEST * volts, volts, _CLIP_SCALE * volts, downward=True
        )
    if name in _SHAPES:
        return CauseParameter(*named, key.low, key.high, 0.0, _SHAPES[name], shape=True)
    absent = float(key.default)
    widest = max(key.high - absent, absent - key.low)
    scale, low, high = _SIZES.get(name, (widest / _SCALES_IN_RANGE, key.low, key.high))
    negligible, fineness = _NEGLIGIBLE.get(name, 0.0), _FINENESS.get(name, 1.0)
    return CauseParameter(
        *named, low, high, scale, absent, negligible=negligible, fineness=fineness
    )
