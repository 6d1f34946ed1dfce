"""The physics of all kinds of models, which C++ (cpp/machines) moves from event to event.

Joints, axes, pendulums and oscillators are one mass, or a motor and its load, with friction that
sticks: see `MotionTerms` in cpp/machines/motion.hpp. Steps are exact where the motion is linear
between events and the knots of the inputs, else of order 5. States are NaN from
where a motion has no finite one, or where it takes more than 100 000 steps and 40 for each reading.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stickslip import _machines
from stickslip._util.arrays import Array

_Named = Mapping[str, Array]

_FASTEST = 1.5
"""Largest phase of an elastic resonance from one reading to the next, rad; above it the
transmission counts as rigid. Chosen: half of what readings can show."""

_MOST_LOAD = 0.9
"""Largest part of the inertia that a servo's load has behind play, whatever the armature. Chosen:
a motor without inertia would cross the play at once."""
_LIGHTEST = 0.1
"""Least mass of a servo's arm beside the stated one. Chosen: what is less is another arm."""


@dataclass(frozen=True)
class Inputs:
    """Inputs of a record, as some vectors have them.

    Attributes
    ----------
    knots : ndarray, shape (knots, 1 or vectors)
        Where their values stand, s.
    values : dict of ndarray, shape (1 + knots, vectors)
        By name: what acts before the first knot, and from each knot on.
    late : dict of ndarray, shape (vectors,)
        By name: by how much all of it acts later, s.
    lines : bool
        Whether they change evenly from one knot to the next; they are held otherwise.
    """

    knots: Array
    values: _Named
    late: _Named
    lines: bool

    def of(self, name: str, absent: float | Array = 0.0) -> Array:
        """Values of one of them, or what acts where there is none."""
        return self.values.get(name, np.zeros((1 + len(self.knots), 1)) + absent)

    def cut(self, name: str, edges: list[Array]) -> Inputs:
        """With a knot more wherever the line of an input crosses an edge, (vectors,)."""
        knots, u = self.knots, self.values[name]
        begins, ends = u[1:-1], u[2:]
        times, values = [np.broadcast_to(knots, u[1:].shape)], [u[1:]]
        for edge in edges:
            crossed = (begins - edge) * (ends - edge) < 0.0
            rows = np.flatnonzero(crossed.any(axis=1))
            part = np.where(crossed, (edge - begins) / (ends - begins), 1.0)[rows]
            times.append(knots[rows] + part * (knots[rows + 1] - knots[rows]))
            values.append(np.where(crossed, edge, ends)[rows])
        order = np.argsort(whole := np.vstack(times), axis=0, kind="stable")
        cut = np.take_along_axis(np.vstack(values), order, axis=0)
        at = np.take_along_axis(whole, order, axis=0)
        return Inputs(at, {name: np.vstack([u[:1], cut])}, self.late, self.lines)


def _states(
    machine: str, terms: _Named, start: list[Array], t: Array, inputs: Inputs, acts: _Named
) -> Array:
    """States of a machine of cpp/machines, (readings, states, vectors).

    Terms by the names that it has there, 0 where they are not given; what acts in its order, with
    the names of the inputs by which it may be late.
    """
    none = np.zeros_like(start[0])
    c = np.stack([terms.get(name, none) for name in _machines.terms[machine]], axis=1)
    late = np.stack([inputs.late.get(name, none) for name in acts], axis=1)
    shape = 1 + len(inputs.knots), len(none)
    rows = np.stack([np.broadcast_to(each, shape).T for each in acts.values()], axis=2)
    states = _machines.states[machine](
        c, np.stack(start, axis=1), t, inputs.knots.T, rows, late, inputs.lines
    )
    return states.transpose(1, 2, 0)


def _moved(inputs: Inputs, t: Array, values: _Named, inertia: str, force: Array) -> Array:
    """States of mechanics: x and v, and y and w of the load, (readings, 4, vectors)."""
    none = np.zeros_like(values["step"])
    whole = values.get(inertia, none + 1.0)

    def of(name: str) -> Array:
        return values.get(name, none) / whole

    same = ("quadratic", "cubic_damping", "stiffness", "gravity", "coulomb", "asymmetry",
            "stribeck", "load")  # fmt: skip
    c = {
        **{name: of(name) for name in same},
        "rate": of("viscous"),
        "rate_asymmetry": of("viscous_asymmetry"),
        "square": of("quadratic_stiffness"),
        "cubic": of("cubic_stiffness"),
        "stribeck_speed": values.get("stribeck_speed", none),
    }
    if "backlash" in values:
        share, compliance = values["load_share"], values["compliance"]
        small = share * (1.0 - share)
        soft = compliance * whole * small > (values["step"] / _FASTEST) ** 2
        c["spring"] = np.where(soft, 1.0 / np.where(soft, compliance * whole, 1.0), 0.0)
        c["damping"] = 2.0 * values["damping_ratio"] * np.sqrt(c["spring"] * small)
        c |= {"gap": 0.5 * values["backlash"], "share": share}
    if "pivot" in inputs.values:
        c["swing"] = none + 1.0
    start = [values["start_position"], values["start_speed"]]
    return _states("motion", c, start, t, inputs, {next(iter(inputs.late), ""): force / whole})


def joint_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    per = values["torque_constant"] if "current" in inputs.values else 1.0
    acts = inputs.of(next(iter(inputs.values), "torque"))
    return _moved(inputs, t, values, "inertia", per * acts)


def axis_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    zone, most, unequal = (values[k] for k in ("dead_zone", "saturation", "gain_asymmetry"))
    bends = np.any(zone) or np.any(unequal) or np.any(np.isfinite(most))
    name = next(iter(inputs.values), "command")
    if inputs.lines and inputs.values and bends:
        inputs = inputs.cut(name, [zone, -zone, zone + most, -zone - most])
    command, strength = inputs.of(name), "force_constant" if name == "current" else "gain"
    beyond = np.maximum(np.abs(command) - zone, 0.0)
    command = np.sign(command) * np.minimum(beyond, most)
    unequal = 1.0 + np.sign(command) * unequal
    return _moved(inputs, t, values, "mass", values[strength] * unequal * command)


def pendulum_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    swing = {"gravity": values["gravity_acceleration"] / values["length"], **values}
    return _moved(inputs, t, swing, "", -inputs.of("pivot") / values["length"])


def oscillator_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    return _moved(inputs, t, values, "mass", inputs.of("force"))


def heater_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    """Temperatures of a body, perhaps with a heater that warms it and a wall that stores heat."""
    acts = {
        "power": inputs.of("power") * (1.0 + values["power_error"]),
        "ambient": inputs.of("ambient", values["ambient"]),
    }
    return _states("heat", values, [values["start_temperature"]], t, inputs, acts)


def servo_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    """Place and speed of the load; angles count from where the arm hangs."""
    heavier, zero = np.maximum(1.0 + values["mass_error"], _LIGHTEST), values["hangs_at"]
    inertia = values["inertia"] * heavier
    whole = inertia + values["armature"]
    strength = values["torque_constant"] / (values["resistance"] * whole)
    looped = np.array("duty" not in inputs.values)
    terms = {
        **{name: values[name] / whole for name in ("coulomb", "stribeck")},
        "stribeck_speed": values["stribeck_speed"],
        "rate": values["viscous"] / whole,
        "gravity": values["gravity"] * heavier / whole,
        "gap": 0.5 * values["backlash"],
        "share": np.minimum(inertia / whole, _MOST_LOAD),
        "gain": values["gain"] * looped,
        "damping_gain": values["damping_gain"] * looped,
        "limit": values["duty_limit"],
        "strength": strength,
        "braking": strength * values["torque_constant"],
        "gear": values["load_friction"],
    }
    acts = {
        "goal": inputs.of("goal") - zero,
        "duty": inputs.of("duty"),
        "supply": inputs.of("supply", values["supply"]),
        "torque enable": inputs.of("torque enable", 1.0),
    }
    start = [values["start_position"] - zero, values["start_speed"]]
    states = _states("servo", terms, start, t, inputs, acts)
    states[:, 0] += zero
    return states
