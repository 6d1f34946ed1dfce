"""Notes of a run."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from stickslip import _core
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import FIELDS, known_keys
from stickslip.scenario.waveform import Waveform
from stickslip.simulation.note import Note, by_seriousness
from stickslip.simulation.scenario_notes import (
    pulses_measured,
    resting_force,
    scenario_notes,
    without_pulses,
)
from stickslip.simulation.unit_notes import DEFAULTS

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

MUCH_TURNING = 0.05
"""Parts of the mean velocity above which `turning_speed` is noted. With a steady heading near the
centre it is 0.5 % at most; walks whose heading turns or swings have 10 % and more, and there the
rigid body with eight corners walks differently by as much (docs/theory/steering.md)."""

LEAST_TURNING = 5e-5
"""Below this `turning_speed` is never noted, m/s: with a steady heading the model is within it."""

FEWEST_PULSES = 20
"""Pulses of a window from which on its quarters are compared. Chosen: quarters of fewer differ by
chance, as the pulses of a sound walk are not all alike."""

REST, WALK = 1e-3, 2e-3
"""Parts of its length in a pulse: a robot that advances by less is at rest, one that a change makes
advance by more walks. Chosen: walks that are worth the name make 1e-2 and more."""

_TRIED_PULSES = 12  # of a trial; chosen: enough to see a step

FAST = 300.0
"""Frequency of pulses beyond which a robot is not asked for more, Hz. Chosen: the coils let none of
faster pulses through."""

BASE = 0.2
"""Part of the peak that makes a sound base, as in the first example."""

_DRAG = ("drag.linear", "drag.rotational")
_FRICTION = ("contact.static_friction", "contact.kinetic_friction")

_ODD = (
    ("rest-drag", _DRAG, 100.0, math.inf),
    ("rest-friction", _FRICTION, 10.0, math.inf),
    ("rest-adhesion", ("contact.adhesion",), 20.0, math.inf),
    ("rest-torque", ("robot.magnetization",), -math.inf, 0.05),
)
"""Code, keys, and the ratios to the default between which a constant is tried first. Chosen: beyond
published robots."""

_UNITS = {name: key.unit.replace("-", "") for name, key in known_keys().items()}


class Limit(NamedTuple):
    """A number of the summary above which there is a note."""

    number: str
    limit: float
    text: str  # of one run: with the number (n, or 100 n as p) and what to do (do)
    of_many: str  # what some of many are


_PULLED = "the gradient of the in-plane field pulls the robot with {} of what friction holds"

LIMITS: Mapping[str, Limit] = {
    "flight": Limit(
        "airborne_fraction",
        0.5,
        "the robot is in flight for {p:.0f} % of the measuring window: it hops and does not walk, "
        "and its velocity depends on how it lands; {do}",
        "in flight for more than half of the window",
    ),
    "pulled": Limit(
        "pull_ratio",
        0.5,
        _PULLED.format("up to {n:.2g}") + ", so that part of its velocity is no walk; {do}",
        _PULLED.format("more than half"),
    ),
    "field-change": Limit(
        "field_change",
        0.1,
        "the field of the coils where the run ends differs by {p:.0f} % from that where it begins: "
        "the mean velocity mixes different fields; {do}",
        "more than 10 % off in field where the run ends",
    ),
    "velocity-grows": Limit(
        "velocity_growth",
        0.03,
        "the velocity still grows, from each quarter of the window to the next by {p:.0f} % or "
        "more; more drive.pulses give the steady one",
        "still growing in velocity",
    ),
}
"""By code: the notes that depend on one number of the summary."""


def _advice(scenario: Scenario, code: str) -> str:
    """The remedy for a limit, which depends on the drive."""
    drive, program = scenario.drive, _is_program(scenario)
    if code == "flight":
        if resting_force(scenario) == 0.0:
            return "without weight and adhesion nothing holds it down"
        if program:
            return "let its voltages swing by less"
        middle = 0.5 * (drive.base + drive.peak)
        return f"bring drive.base nearer to drive.peak, such as {middle:.2g}"
    if code == "field-change":
        return f"give {'a shorter program' if program else 'fewer drive.pulses'}"
    if program:
        return "drive opposite coils with the same current"
    if drive.coils == "single":
        return 'set drive.coils = "pairs" for the walk alone'
    return "work nearer to the centre"


def run_notes(
    scenario: Scenario, status: str, summary: Mapping[str, Any], condition_met: bool
) -> list[Note]:
    """Notes of a run, the most serious first; none for most runs."""
    return by_seriousness(
        [
            *(_of_condition(scenario, summary) if condition_met else []),
            *_of_motion(scenario, summary, status == "ok"),
            *_of_limits(scenario, summary),
            *_of_turning(summary),
            *scenario_notes(scenario),
        ]
    )


def _is_program(scenario: Scenario) -> bool:
    return scenario.drive.mode == "program"


def _of_condition(scenario: Scenario, summary: Mapping[str, Any]) -> list[Note]:
    start, end = scenario.window
    ended = summary["simulated_time"]
    if ended >= end:
        return []
    over = f"over {ended - start:.4g} of the {end - start:.4g} s of the measuring window only"
    before = "before the measuring window, so that nothing is measured"
    text = f"the run was ended by its condition at {ended:.6g} s: " + (
        before if ended <= start else f"velocity and angles are measured {over}"
    )
    return [Note("window-cut", text, ended)]


def _of_limits(scenario: Scenario, summary: Mapping[str, Any]) -> list[Note]:
    beyond = {code: each for code, each in LIMITS.items() if summary[each.number] > each.limit}
    # Where the field changes, the velocity follows it; more pulses would lead further away.
    pulses = 0 if _is_program(scenario) else pulses_measured(scenario.drive.pulses)
    if "field-change" in beyond or pulses < FEWEST_PULSES:
        beyond.pop("velocity-grows", None)
    if _step(scenario, summary) < REST:
        beyond.pop("pulled", None)
    return [
        Note(code, each.text.format(n=n, p=100.0 * n, do=_advice(scenario, code)), n)
        for code, each in beyond.items()
        for n in (summary[each.number],)
    ]


def _of_motion(scenario: Scenario, summary: Mapping[str, Any], is_whole: bool) -> list[Note]:
    notes = []
    low, high = summary["theta_min"], summary["theta_max"]
    rolls = summary["events"]["roll_over"]
    drive = scenario.drive
    measured = is_whole and math.isfinite(summary["mean_velocity"])
    if measured and (summary["field_max"] == 0.0 or not without_pulses(scenario)):
        slips = any(summary[name] != 0.0 for name in ("slip_up", "slip_down", "slip_flat"))
        # A program may lead out and back.
        stays = _step(scenario, summary) < REST and not (_is_program(scenario) and slips)
        if stays:
            notes.append(_why_it_rests(scenario, summary))
        elif not slips:
            said = "the contact never slipped in the measuring window: the robot rolls or hops"
            notes.append(Note("no-slip", said))
    advice = ""
    if drive.mode == "IPP" and drive.base == 0.0:
        advice = (
            "; at drive.base = 0 the holding coil alone turns it upright: set drive.base, say "
            f"{BASE * drive.peak:.1g}"
        )
    if rolls:
        text = (
            f"the robot rolled over {rolls} time{'s' if rolls > 1 else ''}, forth or back: from "
            "one corner over a face to the next (roll_over)" + advice
        )
        notes.append(Note("roll-over", text, float(rolls)))
    upright = 0.5 * math.pi
    if low < -upright or high > upright:
        text = (
            "the robot tilted beyond upright: theta from "
            f"{math.degrees(low):.1f} to {math.degrees(high):.1f} degrees in the measuring window"
        )
        notes.append(Note("beyond-upright", text, max(high, -low)))
    return notes


def _of_turning(summary: Mapping[str, Any]) -> list[Note]:
    turning = summary["turning_speed"]
    speed = math.hypot(summary["mean_velocity"], summary["mean_velocity_y"])
    if speed == 0.0 or not turning > max(MUCH_TURNING * speed, LEAST_TURNING):
        return []
    text = (
        "the robot turned while it walked: what turning adds at its contact is not in the model, "
        f"and may change its speed along the path by up to about {1e3 * turning:.2g} mm/s "
        f"(turning_speed); straight from the start to the end of the window it made "
        f"{1e3 * speed:.3g} mm/s"
    )
    return [Note("turning", text, turning)]


def _step(scenario: Scenario, summary: Mapping[str, Any]) -> float:
    """Distance per pulse (of a program, in all) over the robot's length."""
    start, end = scenario.window
    period = end - start if _is_program(scenario) else 1.0 / min(scenario.drive.frequency, FAST)
    speed = math.hypot(summary["mean_velocity"], summary["mean_velocity_y"])
    return speed * period / scenario.robot.length


def _why_it_rests(scenario: Scenario, summary: Mapping[str, Any]) -> Note:
    """Why a robot rests: the first cause whose removal makes it walk, by trial runs."""
    still = summary["theta_min"] == summary["theta_max"] and not any(summary["events"].values())
    rests = "the robot never moved" if still else "the robot stays in its place"
    if summary["field_max"] == 0.0:
        more = "give voltages" if _is_program(scenario) else "set drive.peak and drive.hold"
        return Note("rest-no-field", f"{rests}: there is no field; {more}", 0.0)
    if _moment(scenario) == 0.0:
        said = f"{rests}: it has no magnetic moment, which no field moves; set robot.magnetization"
        return Note("rest-no-moment", said, 0.0)
    for code, changes, text, value in _trials(scenario, summary):
        if _walks_with(scenario, changes):
            return Note(code, f"{rests}: {text}", value)
    tried = "5 times the field, a quarter of the friction or a thousandth of the drag"
    return Note("rest", f"{rests}; none of {tried} alone makes it walk")


def _trials(
    scenario: Scenario, summary: Mapping[str, Any]
) -> Iterator[tuple[str, dict[str, Any], str, float]]:
    """Causes of rest, the likeliest first: code, changes that would remove it, text, value."""
    for code, keys, low, high in _ODD:
        for key in keys:
            value = float(scenario.get(key))
            if low < value / DEFAULTS[key] < high:
                times = f"{value / DEFAULTS[key]:.2g} times the default"
                given = f"{key} = {value:g} {_UNITS[key]}".rstrip()
                changes = {each: DEFAULTS[each] for each in keys}
                yield code, changes, f"{given} is {times}; with the default it walks", value
    field = summary["field_max"]
    torque, held = abs(_moment(scenario)) * field, _holding_torque(scenario, summary)
    # A field that is too weak by more than a thousand is not what is meant.
    for factor in (2.0, 20.0, 200.0) if 1e-3 * held < torque < 2.0 * held else ():
        stronger = _with_field(scenario, factor * held / torque)
        text = (
            f"the field, {1e3 * field:.3g} mT at most, turns it with at most {torque:.2g} N m, and "
            f"weight and adhesion hold it with {held:.2g} N m; it walks with {_in_words(stronger)}"
        )
        yield "rest-torque", stronger, text, torque
    tilting = 0.0 if _is_program(scenario) else 0.4 * scenario.drive.peak
    if scenario.drive.hold < tilting:
        changes = {"drive.hold": tilting}
        text = f"no field across its moment tips it; it walks with {_in_words(changes)}"
        yield "rest-torque", changes, text, torque
    friction, drag = scenario.contact.static_friction, scenario.drag
    pressed = resting_force(scenario)
    text = (
        f"friction holds it, contact.static_friction = {friction:g} with "
        f"{friction * pressed:.3g} N under weight and adhesion of {pressed:.3g} N; with a quarter "
        "of the friction it walks"
    )
    # The kinetic one first, which may not be the larger one.
    quarter = {key: 0.25 * float(scenario.get(key)) for key in reversed(_FRICTION)}
    yield "rest-friction", quarter, text, friction * pressed
    text = (
        f"drag holds it, drag.linear = {drag.linear:g} N s/m and drag.rotational = "
        f"{drag.rotational:g} N m s^2; with a thousandth of both it walks"
    )
    thousandth = {key: 1e-3 * float(scenario.get(key)) for key in _DRAG}
    yield "rest-drag", thousandth, text, drag.rotational
    for factor in (2.0, 5.0):
        stronger = _with_field(scenario, factor)
        text = f"the field rocks it too little; it walks with {_in_words(stronger)}"
        yield "rest-torque", stronger, text, torque


def _in_words(changes: Mapping[str, Any]) -> str:
    """The drive of `_with_field`."""
    if "drive.program" in changes:
        return "larger voltages"
    return ", ".join(f"{key} = {value:.2g}" for key, value in changes.items())


def _moment(scenario: Scenario) -> float:
    """A m^2."""
    robot = scenario.robot
    return robot.magnetization * robot.length * robot.width * robot.height


def _holding_torque(scenario: Scenario, summary: Mapping[str, Any]) -> float:
    """Of weight and adhesion about the corner that a robot on a face would tip on, N m."""
    stands = abs(math.sin(summary["theta_max"])) > math.sqrt(0.5)
    lever = 0.5 * (scenario.robot.height if stands else scenario.robot.length)
    return lever * resting_force(scenario)


def _with_field(scenario: Scenario, factor: float) -> dict[str, Any]:
    """Changes that multiply the fields of the drive."""
    if _is_program(scenario):
        blocks = scenario.to_core().program()
        return {"drive.program": Waveform([(t, factor * volts, n) for t, volts, n in blocks])}
    stronger = {key: factor * float(scenario.get(key)) for key in FIELDS}
    # At no base the holding coil alone turns it upright.
    return stronger | {"drive.base": stronger["drive.base"] or BASE * stronger["drive.peak"]}


def _walks_with(scenario: Scenario, changes: Mapping[str, Any]) -> bool:
    """Whether a robot walks with these changes, by its first pulses."""
    if not _is_program(scenario):
        changes = {"drive.pulses": min(scenario.drive.pulses, _TRIED_PULSES), **changes}
    try:
        tried = scenario.replace({"record.rate": "none", **changes})
    except ScenarioError:  # a value beyond its range
        return False
    (result,) = _core.simulate_batch([tried.to_core()], 1, lambda _: None, None)
    found = result.summary()
    rocks = found["slip_up"] != 0.0 or found["slip_down"] != 0.0  # and is not dragged on a face
    # One or two may be those of the start; without a base it rolls over in any case.
    rolls = found["events"]["roll_over"] > 2 and tried.drive.base != 0.0
    steps = rocks and not rolls and found["airborne_fraction"] < LIMITS["flight"].limit
    return result.status == "ok" and steps and _step(tried, found) > WALK
