"""The physics of all kinds of models, which C++ (cpp/machines) moves from event to event.

Joints, axes, pendulums and oscillators are one mass, or a motor and its load, with friction that
sticks. Coefficients are per unit of inertia, 0 where a term is absent::

    x'' = u - load - rate v - rate_asymmetry |v| - quadratic v|v| - cubic_damping v^3
          - stiffness x - square x^2 - cubic x^3 - gravity sin(x) - friction
    friction = sign(v) max(coulomb + sign(v) asymmetry, 0) + sign(v) stribeck exp(-(v / vs)^2)

`u` is the input; with `swing` it is that times cos(x). At rest friction holds what is below its
limit. With a `gap` to each side or a `spring` there are two masses: the motor's with the friction,
and the load's, a `share` of the whole, with all that depends on the place. Across the gap they meet
without rebound and pull at nothing; the spring has a moment of `spring` per angle and a `damping`.

Steps are exact where the motion is linear between events and the knots of the inputs, else of
order 5. States are NaN from where a motion has no finite one, or where it takes more than 100 000
steps and 40 for each reading to follow it.
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

    def of(self, name: str) -> Array:
        """Values of one of them, 0 where there is none."""
        return self.values.get(name, np.zeros((1 + len(self.knots), 1)))

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


def _moved(inputs: Inputs, t: Array, values: _Named, inertia: str, force: Array) -> Array:
    """States of mechanics: x and v, and y and w of the load, (readings, 4, vectors)."""
    none = np.zeros_like(values["step"])
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
    if "pivot" in inputs.values:
        c["swing"] = none + 1.0
    terms = np.stack([c.get(name, none) for name in _machines.motion_terms], axis=1)
    start = np.stack([values["start_position"], values["start_speed"]], axis=1)
    acts = np.broadcast_to(force / whole, (len(force), len(none))).T[..., None]
    late = next(iter(inputs.late.values()), none)[:, None]
    states = _machines.moved(terms, start, t, inputs.knots.T, acts, late, inputs.lines)
    return states.transpose(1, 2, 0)


def joint_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    return _moved(inputs, t, values, "inertia", inputs.of("torque"))


def axis_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    zone, most, unequal = (values[k] for k in ("dead_zone", "saturation", "gain_asymmetry"))
    bends = np.any(zone) or np.any(unequal) or np.any(np.isfinite(most))
    if inputs.lines and "command" in inputs.values and bends:
        inputs = inputs.cut("command", [zone, -zone, zone + most, -zone - most])
    command = inputs.of("command")
    beyond = np.maximum(np.abs(command) - zone, 0.0)
    command = np.sign(command) * np.minimum(beyond, most)
    unequal = 1.0 + np.sign(command) * unequal
    return _moved(inputs, t, values, "mass", values["gain"] * unequal * command)


def pendulum_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    swing = {"gravity": values["gravity_acceleration"] / values["length"], **values}
    return _moved(inputs, t, swing, "", -inputs.of("pivot") / values["length"])


def oscillator_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    return _moved(inputs, t, values, "mass", inputs.of("force"))


def heater_states(t: Array, inputs: Inputs, values: _Named) -> Array:
    """Temperatures of a body, perhaps with a heater that warms it and a wall that stores heat."""
    none = np.zeros_like(values["step"])
    power = inputs.of("power") * (1.0 + values["power_error"])
    ambient = np.broadcast_to(inputs.values.get("ambient", values["ambient"]), power.shape)
    names = (
        "capacity", "loss", "loss_growth", "heater_capacity", "coupling", "wall_capacity",
        "wall_coupling",
    )  # fmt: skip
    terms = np.stack([values[name] for name in names], axis=1)
    acts = np.stack([power.T, ambient.T], axis=2)
    late = np.stack([inputs.late.get(name, none) for name in ("power", "ambient")], axis=1)
    start, knots = values["start_temperature"], inputs.knots.T
    return _machines.heated(terms, start, t, knots, acts, late, inputs.lines).T[:, None, :]
