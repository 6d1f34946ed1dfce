"""The table of notes, notes.toml: which rows hold for a scenario and what came of it."""

from __future__ import annotations

import functools
import math
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from stickslip import _core
from stickslip._util.note import Note
from stickslip._util.toml import own_table
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import FIELDS, known_keys
from stickslip.scenario.waveform import Waveform
from stickslip.simulation.seen_from_drive import seen_from_drive
from stickslip.simulation.unit_notes import DEFAULTS

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

TABLE = own_table("simulation/notes.toml")

FAST = 300.0
"""Frequency of pulses beyond which a robot is not asked for more, Hz. Chosen: the coils let none of
faster pulses through."""

BASE = 0.2
"""Part of the peak that makes a sound base, as in the first example."""

STEADY_PULSES = 4
"""Fewest pulses whose measuring window, from the end of the third, has no start-up; section VII."""

_TRIED_PULSES = 12  # of a trial; chosen: enough to see a step

_COMPARISONS: Mapping[str, Callable[[Any, Any], Any]] = {
    ">": operator.gt, ">=": operator.ge, "<": operator.lt, "<=": operator.le,
    "is": operator.eq,
}  # fmt: skip

_PLACE = re.compile(r"\{([\w.-]+)(?:(=)([^}]*)|:([^}]*))?\}")


def resting_force(scenario: Scenario) -> float:
    """Normal force on a body that lies still without field: weight and adhesion, N."""
    return scenario.robot.mass * scenario.environment.gravity + scenario.contact.adhesion


def pulses_measured(pulses: Any) -> Any:
    """Pulses of the measuring window of a drive of so many, or of each of an array; section VII."""
    return pulses - (STEADY_PULSES - 1) * (pulses >= STEADY_PULSES)


class Facts:
    """The names of the table for one scenario, and for a run of it with its summary."""

    def __init__(
        self, scenario: Scenario, summary: Mapping[str, Any] | None = None, ok: bool = True
    ):
        self.scenario = scenario
        self._numbers = _of_scenario(scenario)
        if summary is not None:
            self._numbers |= {**summary, **_of_run(self, summary, ok)}

    def __getitem__(self, name: str) -> Any:
        if name in self._numbers:
            return self._numbers[name]
        if name.startswith("default."):
            return DEFAULTS[name.removeprefix("default.")]
        self._numbers[name] = self.scenario.get(name)
        return self._numbers[name]


def _of_scenario(scenario: Scenario) -> dict[str, Any]:
    robot, drive, contact = scenario.robot, scenario.drive, scenario.contact
    shake, pull = scenario.shake, robot.mass * scenario.environment.gravity
    volume = robot.length * robot.width * robot.height
    tilt = abs(float(scenario.get("effects.surface_tilt.angle")))
    pressed, resting = pull * math.cos(tilt) + contact.adhesion, pull + contact.adhesion
    return {
        "weight": pull,
        "resting_force": resting,
        "friction_held": contact.static_friction * resting,
        "density": robot.mass / volume,
        "moment": abs(robot.magnetization) * volume,
        "slope": tilt,
        # Along the surface, and the largest friction against it.
        "slope_force": pull * math.sin(tilt),
        "slope_hold": contact.static_friction * pressed,
        "drive.kind": drive.kind,
        "swing": drive.peak - drive.base if drive.kind == "sawtooth" else math.inf,
        "middle_field": 0.5 * (drive.base + drive.peak),
        # By the surface or by a mass inside; a table has no amplitude.
        "shaken": shake.accelerations is not None
        or max(shake.amplitude_x, shake.amplitude_z, scenario.inner.mass) > 0.0,
        "measured_pulses": 0 if drive.kind == "program" else pulses_measured(drive.pulses),
    }


def _of_run(facts: Facts, summary: Mapping[str, Any], ok: bool) -> dict[str, Any]:
    scenario, drive = facts.scenario, facts.scenario.drive
    program = drive.kind == "program"
    start, end = scenario.window
    period = end - start if program else 1.0 / min(scenario.pulse_rate, FAST)
    speeds = summary["mean_velocity"], summary["mean_velocity_y"]
    forward = float(seen_from_drive(*speeds, drive.kind, drive.direction, drive.heading)[0])
    rocks = abs(summary["slip_up"]) + abs(summary["slip_down"])
    slips = rocks + abs(summary["slip_flat"])
    # A program may lead out and back.
    way = math.hypot(*speeds) + (slips if program else 0.0)
    # Weight and adhesion, about the corner that a robot on a face would tip on.
    stands = abs(math.sin(summary["theta_max"])) > math.sqrt(0.5)
    lever = 0.5 * (scenario.robot.height if stands else scenario.robot.length)
    torque, held = facts["moment"] * summary["field_max"], lever * facts["resting_force"]
    rolls = summary["events"]["roll_over"]
    return {
        "step": way * period / scenario.robot.length if ok else math.nan,
        "advance": forward * period / scenario.robot.length if ok else math.nan,
        "forward": forward,
        "rocks": rocks,
        "slips": slips,
        "tilt": max(summary["theta_max"], -summary["theta_min"]),
        "torque": torque,
        "held_torque": held,
        "tipping": held / torque if torque > 0.0 else math.inf,
        "roll_over": rolls,
        # One or two may be those of the start; without a base it rolls over in any case.
        "rolls": rolls if drive.base != 0.0 else 0,
    }


@functools.cache
def _factors(text: str) -> tuple[float, tuple[str, ...]]:
    words = text.split()
    number = math.prod([float(word) for word in words if not word[0].isalpha()])
    return number, tuple(word for word in words if word[0].isalpha())


def product(text: str, facts: Any) -> Any:
    """Numbers and names, multiplied."""
    result, names = _factors(text)
    for name in names:
        result = result * facts[name]
    return result


def holds(conditions: Iterable[str], facts: Any) -> Any:
    """Whether all conditions hold; of facts that are arrays, at each place."""
    result: Any = True
    for condition in conditions:
        result = result & _condition(condition)(facts)
        if result is False:  # what follows is not asked: each run asks a hundred times
            break
    return result


@functools.cache
def _condition(text: str) -> Callable[[Any], Any]:
    first, _, rest = text.partition(" ")
    if first == "not":
        turned = _condition(rest)
        return lambda facts: True ^ turned(facts)
    if not rest:
        return lambda facts: holds(TABLE["lists"][first], facts)
    how, _, other = rest.partition(" ")
    compare = _COMPARISONS[how]
    if how == "is":
        return lambda facts: compare(facts[first], other)
    return lambda facts: compare(facts[first], product(other, facts))


def notes_of_table(facts: Facts, of: str) -> Iterator[Note]:
    """Notes of the rows that hold, of a "scenario" or of a "run"."""
    first_given = set()
    for row in TABLE["notes"]:
        if row.get("of", "run") != of or row.get("first_of") in first_given:
            continue
        if holds(row["when"], facts) and (trial := _after_trial(row, facts)):
            first_given.update([row["first_of"]] if "first_of" in row else [])
            value = facts[row["value"]] if "value" in row else None
            yield Note(row["code"], _text(row, facts, *trial), value)


def _after_trial(row: Mapping[str, Any], facts: Facts) -> tuple[Mapping[str, Any], Facts] | None:
    """Changes and facts of the first trial of a row that does what it says; of a row without, none
    and those of the run."""
    if "set" not in row and "fields" not in row:
        return {}, facts
    for factor in row.get("fields", [None]):
        if factor is not None:
            changes = _with_field(facts.scenario, product(factor, facts))
        else:
            changes = {key: _changed(text, facts) for key, text in row["set"].items()}
        tried = _tried(facts.scenario, changes)
        if tried is not None and holds(row.get("then", ["walks"]), tried):
            return changes, tried
    return None


def _changed(text: str, facts: Facts) -> Any:
    is_word = " " not in text and "." not in text
    return text if is_word else product(text, facts)


def _with_field(scenario: Scenario, factor: float) -> dict[str, Any]:
    """Changes that multiply the fields of the drive."""
    if scenario.drive.kind == "program":
        blocks = scenario.to_core().program()
        return {"drive.program": Waveform([(t, factor * volts, n) for t, volts, n in blocks])}
    stronger = {key: factor * float(scenario.get(key)) for key in FIELDS}
    # At no base the holding coil alone turns it upright.
    return stronger | {"drive.base": stronger["drive.base"] or BASE * stronger["drive.peak"]}


def _tried(scenario: Scenario, changes: Mapping[str, Any]) -> Facts | None:
    """Its first pulses with these changes; None of one that is refused or fails."""
    if scenario.drive.kind != "program":
        changes = {"drive.pulses": min(scenario.drive.pulses, _TRIED_PULSES), **changes}
    try:
        tried = scenario.without_record().replace(changes)
    except ScenarioError:  # a value beyond its range
        return None
    (result,) = _core.simulate_batch([tried.to_core()], 1, lambda _: None, None)
    return Facts(tried, result.summary()) if result.status == "ok" else None


def _text(row: Mapping[str, Any], facts: Facts, changes: Mapping[str, Any], tried: Facts) -> str:
    def filled(match: re.Match[str]) -> str:
        name, given, other, unit = match.groups()
        if name == "advice":
            advice = (case["text"] for case in row["advice"] if holds(case["when"], facts))
            return _PLACE.sub(filled, next(advice, ""))
        if name == "set":
            if "drive.program" in changes:
                return "larger voltages"
            return ", ".join(_setting(key, value) for key, value in changes.items())
        if given:
            word = other and isinstance(facts[name], str)
            return _setting(name, other if word else product(other or name, facts))
        if unit is None:
            return name
        of, name = (tried, name[6:]) if name.startswith("tried.") else (facts, name)
        return f"{of[name] * TABLE['units'][unit]:.3g} {unit}".rstrip()

    return _PLACE.sub(filled, row["text"])


def _setting(key: str, value: Any) -> str:
    if isinstance(value, str):
        return f'{key} = "{value}"'
    return f"{key} = {value:.4g} {known_keys()[key].unit.replace('-', '')}".rstrip()
