"""The search space of an optimisation: keys within ranges, words, and a free waveform."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.messages import refuse, shown
from stickslip.errors import ScenarioError
from stickslip.scenario.changes import Changes
from stickslip.scenario.keys import (
    COIL_NAMES,
    PROGRAM,
    SAWTOOTH,
    Value,
    checked,
    coil_places,
    find_key,
    refuse_sawtooth,
)
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.waveform import Waveform, drive_waveform
from stickslip.simulation.notes import STEADY_PULSES

Values = Mapping[str, Value]
"""The free values of a drive: words and numbers by key, and knots such as "xp 3", V."""

_DECADE = 10.0  # ratio of the ends of a range that is searched in its logarithm
_OF_A_PROGRAM = ("drive.frequency", "drive.ramp")  # what a free waveform uses of a sawtooth
_MOST_KNOTS = 200  # of a coil; chosen: far more than a search of some thousand runs can place


@dataclass(frozen=True)
class Space:
    """The free values of the scenario `start`.

    `words` has the choices of each free word, that of the start first. `ranges` has low and high of
    each free number, the knots of a waveform last. `columns` are the coils of a waveform of `knots`
    knots each; 0 for none. A point has a coordinate for each word, its place among the choices, and
    then one for each number, 0 to 1 along its range.
    """

    start: Scenario
    words: Mapping[str, Sequence[Value]]
    ranges: Mapping[str, tuple[float, float]]
    knots: int = 0
    columns: Sequence[int] = ()

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """Lowest and highest of each coordinate."""
        places = [(0.0, len(choices) - 1.0) for choices in self.words.values()]
        return places + [(0.0, 1.0)] * len(self.ranges)

    @property
    def holds_start(self) -> bool:
        """Whether a free waveform may be that of the start, with its words and numbers."""
        words = all(self.start.get(key) in choices for key, choices in self.words.items())
        within = all(low <= float(self.start.get(name)) <= high
                     for name, (low, high) in self.ranges.items() if " " not in name)  # fmt: skip
        volts = drive_waveform(self.start).voltages(np.linspace(0.0, self.start.duration, 1000))
        others = np.delete(volts, self.columns, axis=1)
        return bool(self.knots) and words and within and not others.any()

    def starts(self) -> Array:
        """Return the start with each combination of words as points, a row each, its own first.

        A number outside its range is at its nearer end.
        """
        rows = []
        for places in itertools.product(*(range(len(each)) for each in self.words.values())):
            chosen = zip(self.words.items(), places, strict=True)
            scenario = self.start.replace({key: choices[place] for (key, choices), place in chosen})
            numbers = [float(scenario.get(name)) for name in self.ranges if " " not in name]
            if self.knots:
                drive = scenario.drive
                times = drive.ramp + np.arange(self.knots) / (self.knots * drive.frequency)
                volts = drive_waveform(scenario).voltages(times)
                numbers += volts[:, self.columns].T.ravel().tolist()
            pairs = zip(self.ranges.values(), numbers, strict=True)
            rows.append([*places, *(_coordinate(*pair) for pair in pairs)])
        return np.array(rows, dtype=float)

    def values(self, point: Array) -> Values:
        """Return words and numbers of a point."""
        places, along = np.split(point, [len(self.words)])
        chosen = zip(self.words.items(), places, strict=True)
        numbers = zip(self.ranges.items(), along.tolist(), strict=True)
        return {
            **{key: choices[round(place)] for (key, choices), place in chosen},
            **{name: _number(ends, part) for (name, ends), part in numbers},
        }

    def changes(self, values: Values) -> dict[str, Any]:
        """Return the arguments of ``Scenario.replace`` for values by name.

        Where the frequency is free, pulses take the start's time: of drives that are equally long
        the rise to the first pulse is the same part. Where a waveform is free, any drive is played
        as a program, which is measured over all of it, a pulsed drive after its third pulse only.
        """
        keys = {name: value for name, value in values.items() if " " not in name}
        if "drive.frequency" in keys:
            per_hertz = self.start.drive.pulses / self.start.drive.frequency
            pulses = round(per_hertz * float(keys["drive.frequency"]))
            keys["drive.pulses"] = max(STEADY_PULSES, pulses)
        if not self.knots:
            return keys
        scenario = self.start.replace(keys)
        volts = [value for name, value in values.items() if " " in name]
        waveform = self._waveform(scenario, np.array(volts)) if volts else drive_waveform(scenario)
        others = {key: value for key, value in keys.items() if key not in SAWTOOTH}
        return {**others, "drive.mode": "program", PROGRAM: waveform}

    def _waveform(self, scenario: Scenario, volts: Array) -> Waveform:
        """Make the ramp of a scenario to the first knot, and a period for each pulse.

        A coil is not mirrored in the one across from it, so that each has the limits of the
        sawtooth's single coil.
        """
        drive = scenario.drive
        period = np.zeros((self.knots + 1, len(COIL_NAMES)))
        period[:-1, self.columns] = volts.reshape(len(self.columns), -1).T
        period[-1] = period[0]
        pulses = (np.linspace(0.0, 1.0 / drive.frequency, self.knots + 1), period, drive.pulses)
        rise = ([0.0, drive.ramp], [np.zeros(len(COIL_NAMES)), period[0]], 1)
        return Waveform([rise, pulses] if drive.ramp > 0.0 else [pulses])


def _coordinate(ends: tuple[float, float], value: float) -> float:
    inside = min(max(value, ends[0]), ends[1])
    low, at, high = map(math.log if _is_wide(ends) else float, (ends[0], inside, ends[1]))
    return (at - low) / (high - low)


def _number(ends: tuple[float, float], part: float) -> float:
    low, high = ends
    value = low * (high / low) ** part if _is_wide(ends) else low + part * (high - low)
    return min(max(value, low), high)  # no rounding past an end


def _is_wide(ends: tuple[float, float]) -> bool:
    return 0.0 < _DECADE * ends[0] <= ends[1]


def make_space(
    scenario: Scenario, free: Mapping[str, Any], knots: int | None, coils: Sequence[str],
    volts: float | None, either_way: bool = False,
) -> Space:  # fmt: skip
    """Check what is free and make the search space; `volts` is the limit on the voltages.

    With `either_way` a sawtooth is tried in both directions unless its direction is stated.
    """
    if not free and knots is None:
        raise ScenarioError("nothing is free: allowed are keys with a range, or knots, or both")
    by_name = Changes(free)
    columns: list[int] = []
    if knots is None:
        refuse_sawtooth(scenario.drive.mode, by_name)
        if either_way and scenario.drive.kind == "sawtooth":
            by_name = Changes({"drive.direction": ["+x", "-x"], **by_name})
    else:
        _check_waveform(scenario, by_name, knots, volts)
        columns = coil_places(coils)
    ranges: dict[str, tuple[float, float]] = {}
    words: dict[str, list[Value]] = {}
    for key, given in by_name.items():
        if scenario.uncertain is not None and key in scenario.uncertain.names:
            raise ScenarioError(f"{key}: allowed is either free or uncertain, not both")
        if find_key(key).kind == "word":
            words[key] = _words(scenario, key, given)
        else:
            ranges[key] = _range(key, given)
    most = volts or 0.0  # used with knots alone, and above 0 then
    for column in columns:
        names = (f"{COIL_NAMES[column]} {k}" for k in range(1, (knots or 0) + 1))
        ranges |= dict.fromkeys(names, (-most, most))
    return Space(scenario, words, ranges, knots or 0, columns)


def _range(key: str, given: Any) -> tuple[float, float]:
    known = find_key(key)
    if known.kind != "real" or known.section in ("solver", "record"):
        raise ScenarioError(f"{key}: cannot be free; allowed are words and real numbers of a model")
    if isinstance(given, str) or not isinstance(given, Sequence) or len(given) != 2:
        refuse(key, given, "(low, high) of a number, or a list of words")
    low, high = (float(checked(key, end)) for end in given)
    if not low < high:
        raise ScenarioError(f"{key} = {shown(low)}:{shown(high)}: allowed is low below high")
    return low, high


def _words(scenario: Scenario, key: str, given: Any) -> list[Value]:
    if isinstance(given, str) or not isinstance(given, Sequence) or not given:
        refuse(key, given, "a list of words")
    words = list(dict.fromkeys(checked(key, word) for word in given))
    if key == "drive.mode" and "program" in words:
        raise ScenarioError(f'{key} = "program": cannot be tried; a free waveform has knots')
    return sorted(words, key=lambda word: word != scenario.get(key))


def _check_waveform(
    scenario: Scenario, free: Mapping[str, Any], knots: object, volts: float | None
) -> None:
    if isinstance(knots, bool) or not isinstance(knots, int) or not 2 <= knots <= _MOST_KNOTS:
        refuse("knots", knots, f"a whole number from 2 to {_MOST_KNOTS}")
    if scenario.drive.kind == "program":
        raise ScenarioError(
            'knots: not allowed with drive.mode = "program", whose period is not known; allowed '
            'is "IPP" or "OPP"'
        )
    if scenario.drive.heading != 0.0:
        raise ScenarioError(
            f"knots: not allowed with drive.heading = {scenario.drive.heading:g}: a free waveform "
            "goes where its coils pull"
        )
    for key in free:
        if key in SAWTOOTH and key not in _OF_A_PROGRAM and find_key(key).kind != "word":
            allowed = ", ".join(_OF_A_PROGRAM)
            raise ScenarioError(f"{key}: of no use with knots; of the drive, allowed are {allowed}")
    if volts is None or not volts > 0.0:
        raise ScenarioError(
            "knots: a limit on voltage_max above 0 V is missing, within which the knots are placed"
        )
