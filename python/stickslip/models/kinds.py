"""All ready-made models: the table of their terms, columns and usual causes, and their functions.

The table is the one place of what each term is; docstrings and files of ``init --model`` are made
of it.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.terms import instruments
from stickslip.diagnosis.terms.instruments import delay, lag, offset
from stickslip.errors import ScenarioError
from stickslip.models.model import Kind, Known, Model, Sensor, Term, made, slow_in_words
from stickslip.models.physics import (
    axis_states,
    heater_states,
    joint_states,
    oscillator_states,
    pendulum_states,
    servo_states,
)

__all__ = ["axis", "joint", "oscillator", "pendulum", "servo", "thermal"]


def _friction(force: str, of: str) -> tuple[Term, ...]:
    """Rows of friction, in units of a force and of a length."""
    return (
        Term("viscous", f"{force} s/{of}", "viscous friction", 0.1, "force / speed"),
        Term("coulomb", force, "dry friction", 0.1, "force", more="at rest it holds what is less"),
    )


def _stribeck_speed(of: str) -> Term:
    return Term("stribeck_speed", f"{of}/s", "speed of the Stribeck effect", 0.2, "speed")


def _duty(record: Series, constants: Mapping[str, float]) -> Array:
    """The duty of a servo as its log tells it."""
    if "duty" in record.inputs or "goal" not in record.inputs:
        return record.inputs.get("duty", np.zeros(0))
    gain = constants.get("gain", 0.0)
    if gain == 0.0:
        text = "allowed is a value or a range, 1/rad, with which it follows its goal; or a duty"
        raise ScenarioError(f"gain is not stated: {text}")
    return gain * (record.inputs["goal"] - record.y)


def _transmission(force: str, of: str, compliance: str) -> tuple[Term, ...]:
    """Rows of a motor and its load, in units of a force and of a length."""
    either = "added in positive direction, and taken off in the other"
    return (
        *_friction(force, of),
        Term("viscous_asymmetry", f"{force} s/{of}", "viscous friction that differs by direction",
             0.05, "force / speed", signed=True, more=either),
        Term("asymmetry", force, "dry friction that differs by direction", 0.05, "force",
             signed=True, more=either),
        Term("stribeck", force, "friction that falls with speed", 0.1, "force",
             shape=_stribeck_speed(of),
             more="stribeck exp(-(v / stribeck_speed)^2) is added to dry friction"),
        Term("quadratic", f"{force} s^2/{of}^2", "quadratic drag", 0.1, "force / speed speed"),
        Term("load", force, "a constant load", 0.1, "force", signed=True),
        Term("backlash", of, "backlash", 0.02, "length",
             more="free way between motor and load, which meet without rebound"),
        Term("compliance", compliance, "an elastic transmission", 1.0, "deflection",
             more="rigid where its period is below 4 readings"),
        Term("load_share", "-", "the load's share of the inertia", value=0.5),
        Term("damping_ratio", "-", "damping ratio of the elastic transmission", value=0.05),
    )  # fmt: skip


def _sensors(*names: str, slow: str = "", zero: bool = False, size: float = 0.05,
             meter: str = "sensor", scale: bool = True) -> tuple[Sensor, ...]:  # fmt: skip
    """Usual errors of instruments and inputs; `slow` is what lags there, "-" if nothing."""
    return (
        *([Sensor("zero", offset, 0.05, "reading", has_unit=True)] if zero else []),
        *([Sensor("scale", instruments.scale, 0.05)] if scale else []),
        *(Sensor(f"late {name}", delay, size, "time", name) for name in names),
        *(Sensor(f"slow {slow or name}", lag, size, "time", name) for name in names if slow != "-"),
        Sensor(f"slow {meter}", lag, size, "time", told=slow_in_words),
    )


_BY_CURRENT = "where it is stated, the input is a current, A"
_STATED = "state {0}=(VALUE, ERROR) (--set {0}=VALUE,ERROR)"
_COUPLING = Term("coupling", "W/K", "coupling of the heater", 20.0, "loss")
_WALL = Term("wall_coupling", "W/K", "coupling of the wall", 20.0, "loss")

KINDS = {
    kind.name: kind
    for kind in (
        Kind(
            "joint", joint_states,
            (
                Term("inertia", "kg m^2", "inertia", more="of motor and load"),
                Term("torque_constant", "N m/A", "torque constant", value=0.0, more=_BY_CURRENT),
                *_transmission("N m", "rad", "rad/(N m)"),
                Term("gravity", "N m", "a load that hangs", 0.1, "force", signed=True),
            ),
            (("start_position", "rad"), ("start_speed", "rad/s")),
            {"speed": (1, 1), "angle": (0, 0), "load speed": (3, 1), "load angle": (2, 0)},
            {"torque": "N m"}, _sensors("torque", "current", zero=True),
            inertia="inertia", drives=("torque",), placed=frozenset({"gravity"}),
            needs={"current": ("A", _STATED.format("torque_constant"))},
        ),
        Kind(
            "axis", axis_states,
            (
                Term("mass", "kg", "mass", more="of all that moves"),
                Term("gain", "N", "force of the motor", value=1.0,
                     more="at rest, for a unit of the command"),
                Term("force_constant", "N/A", "force constant", value=0.0, more=_BY_CURRENT),
                *_transmission("N", "m", "m/N"),
                Term("gain_asymmetry", "-", "gain that differs by direction", 0.05, "1",
                     signed=True,
                     more="part that a positive command has more, and a negative one less"),
                Term("dead_zone", "-", "a dead zone", 0.05, "input",
                     more="in the unit of the command, all of which is less by it"),
                Term("saturation", "-", "a limit of the motor", 1.0, "peak", falls=True,
                     more="of the command less the dead zone"),
            ),
            (("start_position", "m"), ("start_speed", "m/s")),
            {"position": (0, 0), "speed": (1, 1), "load position": (2, 0), "load speed": (3, 1)},
            {"command": "V or N or -"}, _sensors("command", "current", slow="motor"),
            inertia="mass", drives=("command",), per_command="gain",
            needs={"current": ("A", _STATED.format("force_constant"))},
        ),
        Kind(
            "pendulum", pendulum_states,
            (
                Term("length", "m", "effective length",
                     more="inertia over mass times distance of the centre from the pivot"),
                Term("gravity_acceleration", "m/s^2", "acceleration of gravity", value=9.81),
                Term("viscous", "1/s", "viscous damping", 0.1, "force / speed"),
                Term("coulomb", "1/s^2", "dry friction of the pivot", 0.1, "force"),
                Term("quadratic", "-", "drag of the air", 0.1, "force / speed speed",
                     more="of the square of the speed"),
                Term("stiffness", "1/s^2", "a restoring spring", 0.1, "force / length",
                     signed=True, more="about 0"),
            ),
            (("start_position", "rad"), ("start_speed", "rad/s")),
            {"angle": (0, 0), "speed": (1, 1)},
            {"pivot": "m/s^2"}, _sensors("pivot", slow="-", zero=True),
            per_command="1 / length", placed=frozenset({"length"}),
        ),
        Kind(
            "oscillator", oscillator_states,
            (
                Term("mass", "kg", "mass"),
                Term("stiffness", "N/m", "stiffness"),
                *_friction("N", "m"),
                Term("quadratic", "N s^2/m^2", "quadratic drag", 0.1, "force / speed speed"),
                Term("cubic_damping", "N s^3/m^3", "cubic damping", 0.1,
                     "force / speed speed speed"),
                Term("quadratic_stiffness", "N/m^2", "a spring that differs by side", 0.1,
                     "force / length length", signed=True),
                Term("cubic_stiffness", "N/m^3", "a spring that hardens or softens", 0.1,
                     "force / length length length", signed=True),
            ),
            (("start_position", "m"), ("start_speed", "m/s")),
            {"displacement": (0, 0), "speed": (1, 1)},
            {"force": "N"}, _sensors("force", slow="-", zero=True),
            inertia="mass", placed=frozenset({"stiffness"}),
        ),
        Kind(
            "thermal", heater_states,
            (
                Term("capacity", "J/K", "heat capacity", more="of the body"),
                Term("loss", "W/K", "loss to the ambient"),
                Term("ambient", "K", "temperature of the ambient", signed=True,
                     more="where it is no input, in the unit of the readings; 0 where these are "
                     "counted from it"),
                Term("loss_growth", "W/K^2", "a loss that grows with the temperature", 0.1,
                     "force / reading reading", more="by convection or radiation"),
                Term("heater_capacity", "J/K", "a second heat store", 0.2, "capacity",
                     shape=_COUPLING,
                     more="the power warms it first; it begins at the same temperature"),
                Term("wall_capacity", "J/K", "a wall that stores heat", 1.0, "capacity",
                     shape=_WALL,
                     more="the body alone warms it; it begins at the same temperature"),
                Term("power_error", "-", "another power than asked for", 0.05, "1", signed=True,
                     more="it is 1 + this times what the log says"),
            ),
            (("start_temperature", "K"),),
            {"temperature": (0, 0)},
            {"power": "W", "ambient": "K"},
            # Of a temperature above the surroundings, another scale is another power.
            _sensors("power", slow="-", zero=True, size=0.02, meter="thermometer", scale=False),
            inertia="capacity", drives=("power",),
        ),
        Kind(
            "servo", servo_states,
            (
                Term("inertia", "kg m^2", "inertia of the load", more="about its axis"),
                Term("torque_constant", "N m/A", "torque constant", more="at the output"),
                Term("resistance", "ohm", "resistance of the motor"),
                Term("supply", "V", "supply", more="where it is no input"),
                Term("gain", "1/rad", "gain of the loop", value=0.0, more="duty for an error"),
                Term("damping_gain", "s/rad", "damping gain of the loop", value=0.0,
                     more="duty for a speed"),
                Term("hangs_at", "rad", "where the arm hangs", signed=True, value=0.0),
                Term("gravity", "N m", "the weight of an arm", 0.1, "force", signed=True,
                     more="mass times gravity times the distance of its centre"),
                Term("mass_error", "-", "another mass of the arm", 0.1, "1", signed=True,
                     more="inertia and gravity are 1 + this times what is stated"),
                Term("armature", "kg m^2", "armature", 0.2, "inertia",
                     more="inertia of the rotor as the output feels it"),
                *_friction("N m", "rad"),
                Term("load_friction", "-", "friction that grows with load", 0.05, "1",
                     more="part of the sum of the motor's torque and of what the arm resists"),
                Term("stribeck", "N m", "friction that falls with speed", 0.1, "force",
                     shape=_stribeck_speed("rad")),
                Term("backlash", "rad", "play", 0.02, "length",
                     more="between the motor and the output, where the position is read"),
                Term("duty_limit", "-", "a limit of the duty", 1.0, "peak", falls=True),
            ),
            (("start_position", "rad"), ("start_speed", "rad/s")),
            {"position": (0, 0), "speed": (1, 1)},
            {"goal": "rad", "duty": "- or V", "supply": "V", "torque enable": "-"},
            (*_sensors("goal", zero=True), Sensor("late duty", delay, 0.05, "time", "duty")),
            inertia="inertia", drives=("goal", "duty"), command=_duty,
            per_command="supply torque_constant / resistance",
            placed=frozenset({"gravity", "gain"}),
            also={"goal": ("goal position", "target", "setpoint"), "duty": ("pwm", "duty cycle"),
                  "supply": ("voltage", "supply voltage", "input voltage", "present voltage"),
                  "torque enable": ("torque enabled", "enable", "enabled")},
        ),
    )
}  # fmt: skip
"""The table, by name."""


def _driven(kind: Kind, constant: str, known: Mapping[str, Known]) -> Kind:
    """The kind, driven by a current if the constant for that is stated."""
    if constant not in known:
        return kind
    terms = tuple(term for term in kind.terms if term.name != kind.per_command)
    needs = {name: (unit, f"state no {constant}") for name, unit in kind.inputs.items()}
    return replace(kind, terms=terms, inputs={"current": "A"}, drives=("current",),
                   per_command=constant, needs=needs)  # fmt: skip


_ARGUMENTS = """\
    Parameters
    ----------
{reads}    smooth : bool
        Whether inputs change evenly between two readings. They are held otherwise, as by a digital
        drive.
    without : list of str
        Names of causes that are left out. More of them are given to `diagnose_model`.
{terms}

    Returns
    -------
    Model

    Raises
    ------
    ScenarioError
        If a name is unknown, a value is not allowed, or a constant is missing."""


def _documented(make: Callable[..., Model]) -> Callable[..., Model]:
    """The function of a kind, whose docstring has the rows of the table."""
    kind = KINDS[make.__name__]
    rows = []
    for name, term in kind.every.items():
        needed = "float, (float, float) or Prior" if term.absent is None else "optional"
        unit = "" if term.unit == "-" else f", {term.unit}"
        text = f"{term.meaning[0].upper()}{term.meaning[1:]}{unit}"
        text += f"; {term.value:g}, if not stated." if term.value else "."
        text += f" {term.more[0].upper()}{term.more[1:]}." if term.more else ""
        rows.append(f"    {name} : {needed}\n" + textwrap.indent(textwrap.fill(text, 92), " " * 8))
    reads = " or ".join(f'"{quantity}"' for quantity in kind.reads)
    units = " or ".join(dict.fromkeys(unit for _, unit in kind.states))
    what = f"    reads : {{{reads.replace(' or', ',')}}}\n        What the log reads, {units}.\n"
    arguments = _ARGUMENTS.format(reads=what if len(kind.reads) > 1 else "", terms="\n".join(rows))
    make.__doc__ = (make.__doc__ or "").replace("    ARGUMENTS", arguments)
    return make


@_documented
def joint(
    *, reads: str = "speed", smooth: bool = False, without: Sequence[str] = (), **known: Known
) -> Model:
    """A joint or motor: its inertia is driven by a torque.

    ``inertia a = torque - viscous v - friction - load - gravity sin(angle)``, for a `Series` with
    the input ``torque``, N m, or ``current``, A, with a `torque_constant`. What is stated is a
    constant: ``coulomb=0.2``, or with its standard deviation ``coulomb=(0.2, 0.05)``, or
    ``coulomb=Prior(...)``. Each effect that is not stated is a cause, and so are a late and a slow
    torque and a slow sensor. A log tells the inertia only as its ratio to torque and friction.
    Friction is the motor's, load and gravity are the load's.

    ARGUMENTS

    Notes
    -----
    Stops, reversals and contacts are events, found to 1e-11 of how far a step goes beyond them.
    Between them steps are exact where the terms are linear, and of order 5 with `stribeck`,
    `quadratic` or `gravity`, also with ``smooth=True`` and whenever an input is late. Friction as
    in Armstrong-Helouvry et al., Automatica 30 (1994) 1083.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import models
    >>> joint = models.joint(inertia=0.1, viscous=0.2, coulomb=0.15)
    >>> t = np.array([0.0, 0.5, 1.0, 1.5])
    >>> joint.simulate(t, {"torque": np.array([0.2, 0.2, 0.0, 0.0])}).round(3).tolist()
    [0.0, 0.158, 0.216, 0.0]
    """
    return made(_driven(KINDS["joint"], "torque_constant", known), reads, smooth, without, known)


@_documented
def axis(
    *, reads: str = "position", smooth: bool = False, without: Sequence[str] = (), **known: Known
) -> Model:
    """An axis along a line, or a cart: its mass is driven by a motor that is commanded.

    ``mass a = gain command - viscous v - friction - load``, for a `Series` with the input
    ``command``, in V or, with a gain of 1, in N; or ``current``, A, with a `force_constant` in
    place of the gain. Each effect that is not stated is a cause, as for a `joint`, and so are a
    late command, a slow motor and a slow sensor. Only the ratios of the mass to the gain and to
    friction act. The motor's own braking belongs to `viscous`; a slope is a load. An axis that
    turns is a `joint`, or a `servo`. Steps are exact as far as those of a `joint` are.

    ARGUMENTS
    """
    return made(_driven(KINDS["axis"], "force_constant", known), reads, smooth, without, known)


@_documented
def pendulum(
    *, reads: str = "angle", smooth: bool = False, without: Sequence[str] = (), **known: Known
) -> Model:
    """A pendulum that swings freely, or whose pivot is moved sideways.

    ``length a = -gravity_acceleration sin(angle) - pivot cos(angle)`` and damping, for a `Series`
    without input or with the acceleration ``pivot``, m/s^2. An angle of 0 hangs. Each effect, per
    unit of inertia, that is not stated is a cause, and so are a wrong zero of the angle, a slow
    sensor and a late pivot. Steps are of order 5 (Dormand and Prince) from reversal to reversal.

    ARGUMENTS
    """
    return made(KINDS["pendulum"], reads, smooth, without, known)


@_documented
def oscillator(
    *, reads: str = "displacement", smooth: bool = False, without: Sequence[str] = (),
    **known: Known,
) -> Model:  # fmt: skip
    """A mass on a spring, free or driven by a force.

    ``mass a = force - stiffness x - quadratic_stiffness x^2 - cubic_stiffness x^3 - viscous v -
    quadratic v |v| - cubic_damping v^3 - friction``, for a `Series` without input or with
    ``force``, N. Each effect that is not stated is a cause, and so are a wrong zero, a slow
    sensor and a late force. Of a free oscillator only ratios act: state a mass of 1.

    ARGUMENTS

    Notes
    -----
    Exact as far as a `joint` is; of order 5 with the square and cubic terms (Duffing, Erzwungene
    Schwingungen, 1918).
    """
    return made(KINDS["oscillator"], reads, smooth, without, known)


@_documented
def thermal(*, smooth: bool = False, without: Sequence[str] = (), **known: Known) -> Model:
    """A body that is heated, or a room: one heat store, or up to three.

    ``capacity T' = power - loss (T - ambient) - loss_growth (T - ambient) |T - ambient|``, for a
    `Series` with the input ``power``, W, and perhaps ``ambient``. With a `heater_capacity` the
    power warms the heater first, which warms the body by `coupling`; with a `wall_capacity` the
    body warms a wall by `wall_coupling`. Each effect that is not stated is a cause, and so are a
    wrong zero, a slow thermometer and a late power. Steps are exact; of order 5 with `loss_growth`.

    ARGUMENTS
    """
    return made(KINDS["thermal"], "temperature", smooth, without, known)


@_documented
def servo(
    *, reads: str = "position", smooth: bool = False, without: Sequence[str] = (), **known: Known
) -> Model:
    """A servo: a motor behind a loop that holds the position of its load, such as an arm.

    ``(inertia + armature) a = torque - viscous v - friction - gravity sin(position - hangs_at)``
    with ``torque = torque_constant / resistance (supply duty - torque_constant v)`` and ``duty =
    gain (goal - position) - damping_gain v``, for a `Series` with the input ``goal``, rad. A
    ``duty`` that was logged, a part of the supply, drives the motor in place of the loop; with a
    supply of 1 it is in V. ``supply``, V, and ``torque enable``, 1 or 0, may be inputs too: without
    it the motor has no torque. Each effect that is not stated is a cause, and so are a late or slow
    goal, a late duty, a slow sensor, and one of a wrong zero or scale. Of inertia, torque and
    friction only ratios act.

    ARGUMENTS

    Notes
    -----
    Stops, contacts, and where the duty meets its limit are events as of a `joint`; steps are of
    order 5. With play the motor has a tenth of the inertia at least. Friction as in Duclusaud et
    al., Extended friction models for servo actuators, arXiv 2410.08650 (2024).
    """
    return made(KINDS["servo"], reads, smooth, without, known)
