"""The simulator's named extensions as causes: size that would not surprise, and range to search.

Names, units, meanings and physical ranges are the core's; the sizes here are rough orders of what
the apparatus of the paper could hide, and serve as the width of each amplitude's prior.
"""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.diagnosis.model.problem import Cause, CauseParameter
from stickslip.measurement.priors import Prior
from stickslip.scenario.keys import Key, known_keys
from stickslip.scenario.named_effects import effects
from stickslip.scenario.scenario import Scenario


@dataclass(frozen=True)
class _Size:
    """Scale of the prior and the range that is searched, in the parameter's unit."""

    scale: float
    low: float
    high: float


_SIZES = {
    "coil_heating.coefficient": _Size(1e-3, 0.0, 0.02),
    "eddy_lag.time": _Size(3e-4, 0.0, 5e-3),
    "sample_hold.period": _Size(4e-4, 0.0, 4e-3),
    "edge_time.time": _Size(4e-4, 0.0, 4e-3),
    "mutual_inductance.coupling": _Size(0.05, -0.19, 0.3),
    "gradient_scale.fraction": _Size(0.3, -0.9, 3.0),
    "field_gain.in_plane": _Size(0.05, -0.5, 0.6),
    "field_gain.clamp": _Size(0.05, -0.5, 0.6),
    "misalignment.angle": _Size(0.08, -1.5, 1.5),
    "magnetization_scale.fraction": _Size(0.1, -0.6, 1.0),
    "ambient_field.Bx": _Size(5e-5, -5e-4, 5e-4),
    "ambient_field.Bz": _Size(5e-5, -5e-4, 5e-4),
    "stribeck_friction.velocity": _Size(4e-3, 0.0, 0.1),
    "viscous_friction.coefficient": _Size(10.0, 0.0, 200.0),
    "friction_anisotropy.fraction": _Size(0.12, -0.8, 0.8),
    "angle_adhesion.strength": _Size(0.5, -4.0, 1.0),
    "adhesion_ageing.rate": _Size(0.2, 0.0, 5.0),
    "restitution.coefficient": _Size(0.15, 0.0, 0.8),
    "angle_drag.strength": _Size(1.0, -0.9, 20.0),
    "quadratic_drag.coefficient": _Size(1e-3, 0.0, 0.05),
    # About that of a sphere of the magnet's size in water, 8 pi times viscosity times radius cubed.
    "rotational_drag.coefficient": _Size(1e-13, 0.0, 1e-12),
    "surface_tilt.angle": _Size(0.025, -0.3, 0.3),
    "friction_patches.amplitude": _Size(0.2, 0.0, 0.9),
    "length_scale.fraction": _Size(0.03, -0.3, 0.4),
    "clock_scale.fraction": _Size(0.03, -0.3, 0.4),
    "angle_offset.angle": _Size(0.03, -0.3, 0.3),
}
_SHAPES = {"adhesion_ageing.time": 0.01, "friction_patches.period": 5e-4}
# A controller that is this fast cannot be told from one without steps, but takes long to simulate.
_NEGLIGIBLE = {"sample_hold.period": 1e-4}
_CLIP_SHARE = 0.15
_SHORT = len("effects.")
_RANGE_SHARE = 5.0


def library(scenario: Scenario, uncertain: dict[str, Prior], volts: float) -> tuple[Cause, ...]:
    """All extensions that the scenario does not know yet, as causes.

    Parameters
    ----------
    scenario : Scenario
        An extension that it already has is part of the baseline.
    uncertain : dict of Prior
        An extension of which a parameter is uncertain is part of the baseline too.
    volts : float
        Largest voltage of the drives, V; the voltage limit begins to act there.
    """
    taken = {*scenario.effects, *(key.split(".")[1] for key in uncertain if key[:8] == "effects.")}
    causes = []
    for effect in effects():
        if effect.name in taken:
            continue
        parameters = []
        for key in effect.parameters:
            name = key.name[_SHORT:]
            if name == "amplifier_limit.voltage":
                parameters.append(
                    CauseParameter(
                        key.name, key.unit, 0.3 * volts, volts, _CLIP_SHARE * volts, downward=True
                    )
                )
            elif name in _SHAPES:
                parameters.append(
                    CauseParameter(
                        key.name, key.unit, key.low, key.high, 0.0, _SHAPES[name], shape=True
                    )
                )
            elif name in _SIZES:
                size = _SIZES[name]
                parameters.append(
                    CauseParameter(
                        key.name,
                        key.unit,
                        size.low,
                        size.high,
                        size.scale,
                        float(key.default),
                        negligible=_NEGLIGIBLE.get(name, 0.0),
                    )
                )
            else:
                parameters.append(_unsized(key))
        if parameters:
            causes.append(Cause(effect.name, tuple(parameters), effect.meaning))
    return tuple(causes)


def _unsized(key: Key) -> CauseParameter:
    """A parameter without a row above, as of a user's own effect: only its range is known."""
    absent = float(key.default)
    scale = max(key.high - absent, absent - key.low) / _RANGE_SHARE
    return CauseParameter(key.name, key.unit, key.low, key.high, scale, absent)


def parameter_unit(name: str) -> str:
    """Unit of a dotted key."""
    return known_keys()[name].unit
