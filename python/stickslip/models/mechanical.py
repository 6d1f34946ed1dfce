"""Joints, axes, pendulums and oscillators: one mass or two, with friction that sticks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stickslip._util.numbers import Array
from stickslip.models.model import Kind, Known, Model, Sensor, Term, made
from stickslip.models.motion import moved

_FASTEST = 1.5
"""Largest phase of an elastic resonance from one reading to the next, rad; above it the
transmission counts as rigid. Chosen: half of what readings can show."""


def _friction(force: str, of: str) -> tuple[Term, ...]:
    """Rows of friction, in units of a force and of a length."""
    return (
        Term("viscous", f"{force} s/{of}", "viscous friction", 0.1, "force / speed"),
        Term("coulomb", force, "dry friction", 0.1, "force"),
    )


def _transmission(force: str, of: str) -> tuple[Term, ...]:
    """Rows of a motor and its load, in units of a force and of a length."""
    speed = Term("stribeck_speed", f"{of}/s", "speed of the Stribeck effect", 1.0, "speed")
    return (
        *_friction(force, of),
        Term("viscous_asymmetry", f"{force} s/{of}", "viscous friction that differs by direction",
             0.05, "force / speed", signed=True),
        Term("asymmetry", force, "dry friction that differs by direction", 0.05, "force",
             signed=True),
        Term("stribeck", force, "friction that falls with speed", 0.1, "force", shape=speed),
        Term("quadratic", f"{force} s^2/{of}^2", "quadratic drag", 0.1, "force / speed speed"),
        Term("load", force, "a constant load", 0.1, "force", signed=True),
        Term("backlash", of, "backlash", 0.02, "length"),
        Term("compliance", f"{of}/({force})", "an elastic transmission", 1.0, "deflection"),
        Term("load_share", "-", "the load's share of the inertia", value=0.5),
        Term("damping_ratio", "-", "damping ratio of the elastic transmission", value=0.05),
    )  # fmt: skip


def _moved(
    t: Array, inputs: Mapping[str, Array], values: Mapping[str, Array], inertia: str, force: Array
) -> Array:
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
        step = float(np.median(np.diff(t))) if len(t) > 1 else 0.0
        soft = compliance * whole * small > (step / _FASTEST) ** 2
        c["spring"] = np.where(soft, 1.0 / np.where(soft, compliance * whole, 1.0), 0.0)
        c["damping"] = 2.0 * values["damping_ratio"] * np.sqrt(c["spring"] * small)
        c |= {"gap": 0.5 * values["backlash"], "share": share}
    if "pivot" in inputs:
        c["swing"] = none + 1.0
    start = np.array([values[name] for name in ("start_position", "start_speed")])
    return moved(c, start, t, np.broadcast_to(force / whole, (len(t), len(none))))


def _zero(t: Array) -> Array:
    return np.zeros((len(t), 1))


def _joint(t: Array, inputs: Mapping[str, Array], values: Mapping[str, Array]) -> Array:
    return _moved(t, inputs, values, "inertia", inputs.get("torque", _zero(t)))


def _axis(t: Array, inputs: Mapping[str, Array], values: Mapping[str, Array]) -> Array:
    command = inputs.get("command", _zero(t))
    beyond = np.maximum(np.abs(command) - values["dead_zone"], 0.0)
    command = np.sign(command) * np.minimum(beyond, values["saturation"])
    unequal = 1.0 + np.sign(command) * values["gain_asymmetry"]
    return _moved(t, inputs, values, "mass", values["gain"] * unequal * command)


def _pendulum(t: Array, inputs: Mapping[str, Array], values: Mapping[str, Array]) -> Array:
    swing = {"gravity": values["gravity_acceleration"] / values["length"], **values}
    return _moved(t, inputs, swing, "", -inputs.get("pivot", _zero(t)) / values["length"])


def _oscillator(t: Array, inputs: Mapping[str, Array], values: Mapping[str, Array]) -> Array:
    return _moved(t, inputs, values, "mass", inputs.get("force", _zero(t)))


_JOINT = Kind(
    "joint",
    _joint,
    (
        Term("inertia", "kg m^2", "inertia"),
        *_transmission("N m", "rad"),
        Term("gravity", "N m", "a load that hangs", 0.1, "force", signed=True),
    ),
    (("start_position", "rad"), ("start_speed", "rad/s")),
    {"angle": (0, 0), "speed": (1, 1), "load angle": (2, 0), "load speed": (3, 1)},
    {"torque": "N m"},
    (
        Sensor("late torque", "delay", 0.05, "time", "torque"),
        Sensor("slow torque", "lag", 0.05, "time", "torque"),
        Sensor("slow sensor", "lag", 0.05, "time"),
    ),
    inertia="inertia",
    placed=frozenset({"gravity"}),
)

_AXIS = Kind(
    "axis",
    _axis,
    (
        Term("mass", "kg", "mass"),
        Term("gain", "N", "force of the motor", value=1.0),
        *_transmission("N", "m"),
        Term("gain_asymmetry", "-", "gain that differs by direction", 0.05, "1", signed=True),
        Term("dead_zone", "-", "a dead zone", 0.05, "input"),
        Term("saturation", "-", "a limit of the motor", 1.0, "peak", falls=True),
    ),
    (("start_position", "m"), ("start_speed", "m/s")),
    {"position": (0, 0), "speed": (1, 1), "load position": (2, 0), "load speed": (3, 1)},
    {"command": "V or N"},
    (
        Sensor("late command", "delay", 0.05, "time", "command"),
        Sensor("slow motor", "lag", 0.05, "time", "command"),
        Sensor("slow sensor", "lag", 0.05, "time"),
    ),
    inertia="mass",
    gain="gain",
)

_PENDULUM = Kind(
    "pendulum",
    _pendulum,
    (
        Term("length", "m", "effective length"),
        Term("gravity_acceleration", "m/s^2", "acceleration of gravity", value=9.81),
        Term("viscous", "1/s", "viscous damping", 0.1, "force / speed"),
        Term("coulomb", "1/s^2", "dry friction of the pivot", 0.1, "force"),
        Term("quadratic", "-", "drag of the air", 0.1, "force / speed speed"),
        Term("stiffness", "1/s^2", "a restoring spring", 0.1, "force / length", signed=True),
    ),
    (("start_position", "rad"), ("start_speed", "rad/s")),
    {"angle": (0, 0), "speed": (1, 1)},
    {"pivot": "m/s^2"},
    (
        Sensor("zero", "offset", 0.05, "reading"),
        Sensor("late pivot", "delay", 0.05, "time", "pivot"),
        Sensor("slow sensor", "lag", 0.05, "time"),
    ),
    placed=frozenset({"length"}),
)

_OSCILLATOR = Kind(
    "oscillator",
    _oscillator,
    (
        Term("mass", "kg", "mass"),
        Term("stiffness", "N/m", "stiffness"),
        *_friction("N", "m"),
        Term("quadratic", "N s^2/m^2", "quadratic drag", 0.1, "force / speed speed"),
        Term("cubic_damping", "N s^3/m^3", "cubic damping", 0.1, "force / speed speed speed"),
        Term("quadratic_stiffness", "N/m^2", "a spring that differs by side", 0.1,
             "force / length length", signed=True),
        Term("cubic_stiffness", "N/m^3", "a spring that hardens or softens", 0.1,
             "force / length length length", signed=True),
    ),
    (("start_position", "m"), ("start_speed", "m/s")),
    {"displacement": (0, 0), "speed": (1, 1)},
    {"force": "N"},
    (
        Sensor("zero", "offset", 0.05, "reading"),
        Sensor("late force", "delay", 0.05, "time", "force"),
        Sensor("slow sensor", "lag", 0.05, "time"),
    ),
    inertia="mass",
    placed=frozenset({"stiffness"}),
)  # fmt: skip


def joint(
    *, reads: str = "speed", smooth: bool = False, without: Sequence[str] = (), **known: Known
) -> Model:
    """A joint or motor: its inertia is driven by a torque.

    ``inertia a = torque - viscous v - friction - load - gravity sin(angle)``, for a `Series` with
    the input ``torque``, N m. What is stated is a constant: ``coulomb=0.2``, or with its standard
    deviation ``coulomb=(0.2, 0.05)``, or ``coulomb=Prior(...)``. Each effect that is not stated is
    a cause, and so are a late and a slow torque and a slow sensor.

    Parameters
    ----------
    reads : {"speed", "angle", "load speed", "load angle"}
        What the log reads, rad/s or rad; of the load behind backlash or a spring.
    smooth : bool
        Whether the torque changes evenly between two readings. It is held otherwise, as by a
        digital drive.
    without : list of str
        Names of causes that are left out. More of them are given to `diagnose_model`.
    inertia : float, (float, float) or Prior
        Of motor and load, kg m^2; required. A log tells only its ratio to torque and friction.
    viscous, viscous_asymmetry : optional
        N m s/rad. Friction is ``viscous + viscous_asymmetry`` times the speed in positive
        direction.
    coulomb, asymmetry : optional
        Dry friction, N m. It is ``coulomb + asymmetry`` in positive direction, and at rest it
        holds what is less.
    stribeck, stribeck_speed : optional
        ``stribeck exp(-(v / stribeck_speed)^2)`` is added to dry friction, N m and rad/s.
    quadratic : optional
        Drag of the square of the speed, N m s^2/rad^2.
    load, gravity : optional
        N m. A load that hangs acts by gravity sin(angle).
    backlash : optional
        Free way between motor and load, rad. They meet without rebound.
    compliance : optional
        Of a spring between motor and load, rad/(N m); rigid where its period is below 4 readings.
    load_share, damping_ratio : optional
        The load's share of the inertia, 0.5, and the spring's damping ratio, 0.05, if not stated.
        Friction is the motor's, load and gravity are the load's.
    start_position, start_speed : optional
        At the first reading, rad and rad/s; one for each record is found, if not stated.

    Returns
    -------
    Model

    Raises
    ------
    ScenarioError
        If a name is unknown, a value is not allowed, or the inertia is missing.

    Notes
    -----
    Stops, reversals and contacts are events, found to 1e-11 of how far a step goes beyond them.
    Between them steps are exact where the terms are linear, and of order 5 with `stribeck`,
    `quadratic` or `gravity`. 25 000 readings of one vector take 0.03 s without friction, 0.1 s with
    dry friction, and 0.2 to 0.4 s with backlash, a spring behind friction or terms of order 5.
    Friction as in Armstrong-Helouvry et al., Automatica 30 (1994) 1083.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import models
    >>> joint = models.joint(inertia=0.1, viscous=0.2, coulomb=0.15)
    >>> t = np.array([0.0, 0.5, 1.0, 1.5])
    >>> joint.simulate(t, {"torque": np.array([0.2, 0.2, 0.0, 0.0])}).round(3).tolist()
    [0.0, 0.158, 0.216, 0.0]
    """
    return made(_JOINT, reads, smooth, without, known)


def axis(
    *, reads: str = "position", smooth: bool = False, without: Sequence[str] = (), **known: Known
) -> Model:
    """An axis or a cart: its mass is driven by a motor that is commanded.

    ``mass a = gain command - viscous v - friction - load``, for a `Series` with the input
    ``command``, in V or, with a gain of 1, in N. Each effect that is not stated is a cause, as for
    a `joint`, and so are a late command, a slow motor and a slow sensor.

    Parameters
    ----------
    reads : {"position", "speed", "load position", "load speed"}
        What the log reads, m or m/s.
    smooth, without
        As for a `joint`.
    mass : float, (float, float) or Prior
        Of all that moves, kg; required. Only its ratios to the gain and to friction act.
    gain : optional
        Force at rest for a unit of the command, N; 1, if not stated.
    gain_asymmetry : optional
        Gain of a positive command is 1 + this times `gain`, of a negative one 1 - this.
    dead_zone, saturation : optional
        In the unit of the command. What is below the dead zone does nothing and what is beyond it
        is less by it; above the saturation it is no more.
    viscous, viscous_asymmetry, coulomb, asymmetry, stribeck, stribeck_speed, quadratic : optional
        As for a `joint`, with N and m. The motor's own braking belongs to `viscous`.
    load, backlash, compliance, load_share, damping_ratio : optional
        As for a `joint`, with N and m; a slope is a load.
    start_position, start_speed : optional
        At the first reading, m and m/s; one for each record is found, if not stated.

    Returns
    -------
    Model

    Raises
    ------
    ScenarioError
        If a name is unknown, a value is not allowed, or the mass is missing.

    Notes
    -----
    Exact as far as a `joint` is.
    """
    return made(_AXIS, reads, smooth, without, known)


def pendulum(
    *, reads: str = "angle", smooth: bool = False, without: Sequence[str] = (), **known: Known
) -> Model:
    """A pendulum that swings freely, or whose pivot is moved sideways.

    ``length a = -gravity_acceleration sin(angle) - pivot cos(angle)`` and damping, for a `Series`
    without input or with the acceleration ``pivot``, m/s^2. Each effect that is not stated is a
    cause, and so are a wrong zero of the angle, a slow sensor and a late pivot.

    Parameters
    ----------
    reads : {"angle", "speed"}
        What the log reads, rad or rad/s; 0 hangs.
    smooth, without
        As for a `joint`.
    length : float, (float, float) or Prior
        Moment of inertia over mass times distance of its centre from the pivot, m; required.
    gravity_acceleration : optional
        9.81 m/s^2, if not stated.
    viscous, coulomb, quadratic, stiffness : optional
        Per unit of inertia: damping, 1/s; dry friction of the pivot, 1/s^2; drag of the square of
        the speed, no unit; a spring about 0, 1/s^2.
    start_position, start_speed : optional
        At the first reading, rad and rad/s; one for each record is found, if not stated.

    Returns
    -------
    Model

    Raises
    ------
    ScenarioError
        If a name is unknown, a value is not allowed, or the length is missing.

    Notes
    -----
    Steps are of order 5 (Dormand and Prince) between reversals, which are events.
    """
    return made(_PENDULUM, reads, smooth, without, known)


def oscillator(
    *, reads: str = "displacement", smooth: bool = False, without: Sequence[str] = (),
    **known: Known,
) -> Model:  # fmt: skip
    """A mass on a spring, free or driven by a force.

    ``mass a = force - stiffness x - quadratic_stiffness x^2 - cubic_stiffness x^3 - viscous v -
    quadratic v |v| - cubic_damping v^3 - friction``, for a `Series` without input or with
    ``force``, N. Each effect that is not stated is a cause, and so are a wrong zero, a slow
    sensor and a late force.

    Parameters
    ----------
    reads : {"displacement", "speed"}
        What the log reads, m or m/s.
    smooth, without
        As for a `joint`.
    mass, stiffness : float, (float, float) or Prior
        kg and N/m; required. Of a free oscillator only ratios act: state a mass of 1.
    viscous, quadratic, cubic_damping : optional
        N s/m, N s^2/m^2 and N s^3/m^3.
    coulomb : optional
        Dry friction, N; at rest it holds what is less.
    quadratic_stiffness, cubic_stiffness : optional
        N/m^2 and N/m^3 (Duffing, Erzwungene Schwingungen, 1918).
    start_position, start_speed : optional
        At the first reading, m and m/s; one for each record is found, if not stated.

    Returns
    -------
    Model

    Raises
    ------
    ScenarioError
        If a name is unknown, a value is not allowed, or a constant is missing.

    Notes
    -----
    Exact as far as a `joint` is; of order 5 with the square and cubic terms.
    """
    return made(_OSCILLATOR, reads, smooth, without, known)
