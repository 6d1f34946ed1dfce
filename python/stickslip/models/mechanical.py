"""Joints, axes, pendulums and oscillators: what their terms are in the motion of their masses."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stickslip._util.arrays import Array
from stickslip.models.motion import moved

_Named = Mapping[str, Array]

_FASTEST = 1.5
"""Largest phase of an elastic resonance from one reading to the next, rad; above it the
transmission counts as rigid. Chosen: half of what readings can show."""


def _moved(t: Array, late: _Named, values: _Named, inertia: str, force: Array) -> Array:
    """States of all kinds: their terms over the inertia."""
    none = np.zeros_like(next(iter(values.values())))
    whole = values.get(inertia, none + 1.0)

    def of(name: str) -> Array:
        return values.get(name, none) / whole

    c = {
        "rate": of("viscous"),
        "rate_asymmetry": of("viscous_asymmetry"),
        "quadratic": of("quadratic"),
        "cubic_damping": of("cubic_damping"),
        "stiffness": of("stiffness"),
        "square": of("quadratic_stiffness"),
        "cubic": of("cubic_stiffness"),
        "gravity": of("gravity"),
        "coulomb": of("coulomb"),
        "asymmetry": of("asymmetry"),
        "stribeck": of("stribeck"),
        "stribeck_speed": values.get("stribeck_speed", none),
        "load": of("load"),
    }
    if "backlash" in values:
        share, compliance = values["load_share"], values["compliance"]
        small = share * (1.0 - share)
        soft = compliance * whole * small > (values["step"] / _FASTEST) ** 2
        c["spring"] = np.where(soft, 1.0 / np.where(soft, compliance * whole, 1.0), 0.0)
        c["damping"] = 2.0 * values["damping_ratio"] * np.sqrt(c["spring"] * small)
        c |= {"gap": 0.5 * values["backlash"], "share": share}
    if "pivot" in late:
        c["swing"] = none + 1.0
    start = np.array([values[name] for name in ("start_position", "start_speed")])
    inputs = np.broadcast_to(force / whole, (1 + len(t), len(none)))
    return moved(c, start, t, inputs, next(iter(late.values()), none))


def _zero(t: Array) -> Array:
    return np.zeros((1 + len(t), 1))


def joint_states(t: Array, inputs: _Named, late: _Named, values: _Named) -> Array:
    return _moved(t, late, values, "inertia", inputs.get("torque", _zero(t)))


def axis_states(t: Array, inputs: _Named, late: _Named, values: _Named) -> Array:
    command = inputs.get("command", _zero(t))
    beyond = np.maximum(np.abs(command) - values["dead_zone"], 0.0)
    command = np.sign(command) * np.minimum(beyond, values["saturation"])
    unequal = 1.0 + np.sign(command) * values["gain_asymmetry"]
    return _moved(t, late, values, "mass", values["gain"] * unequal * command)


def pendulum_states(t: Array, inputs: _Named, late: _Named, values: _Named) -> Array:
    swing = {"gravity": values["gravity_acceleration"] / values["length"], **values}
    return _moved(t, late, swing, "", -inputs.get("pivot", _zero(t)) / values["length"])


def oscillator_states(t: Array, inputs: _Named, late: _Named, values: _Named) -> Array:
    return _moved(t, late, values, "mass", inputs.get("force", _zero(t)))
