"""What an optimiser may change of a scenario: keys within ranges, words, and a free waveform.

Every number has a coordinate from 0 to 1 along its range, which is what `search` sees.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip._util.numbers import Array
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Value, checked, find_key, full_name, meant, refuse, shown
from stickslip.scenario.path_keys import PROGRAM
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import COIL_NAMES, SAWTOOTH, refuse_sawtooth
from stickslip.scenario.waveform import Waveform

LOG_FROM = 10.0
"""Ratio of the ends of a positive range from which on its coordinate is logarithmic. Chosen: with
less, both scales put about as much of the range on either side of its middle."""

OF_A_PROGRAM = ("drive.frequency", "drive.ramp")
"""Keys of the drive that a free waveform uses: its repeats a second, and the rise to its start."""

FEWEST = 4
"""Pulses of a drive whose frequency is free: its speed is measured after the third."""

_MOST_KNOTS = 200  # of a coil; chosen: far more than a search of some thousand runs can place
_ALLOWED = "(low, high) of a number, or a list of words"


@dataclass(frozen=True)
class Axis:
    """One number that is free.

    Attributes
    ----------
    name : str
        Dotted key, or of a knot its coil and number, such as ``"xp 3"``.
    unit : str
        SI.
    low, high : float
        Ends of the range.
    """

    name: str
    unit: str
    low: float
    high: float

    @property
    def logarithmic(self) -> bool:
        """Whether equal steps of the coordinate are equal ratios."""
        return self.low > 0.0 and self.high >= LOG_FROM * self.low

    def value(self, coordinate: float) -> float:
        """The number at a coordinate from 0 to 1."""
        if not self.logarithmic:
            value = self.low + coordinate * (self.high - self.low)
        else:
            value = self.low * (self.high / self.low) ** coordinate
        return float(min(max(value, self.low), self.high))  # no rounding past an end

    def coordinate(self, value: float) -> float:
        """Inverse of `value`; of a number outside the range that of its nearer end."""
        inside = min(max(value, self.low), self.high)
        if not self.logarithmic:
            return (inside - self.low) / (self.high - self.low)
        return math.log(inside / self.low) / math.log(self.high / self.low)


@dataclass(frozen=True)
class PeriodicWaveform:
    """A periodic voltage program, linear between knots that are evenly spaced in a period.

    Coils that are not named have no voltage: a coil is not mirrored in the one across from it, so
    that each has the limits of the sawtooth's single coil.
    """

    knots: int
    coils: tuple[str, ...]
    volts: float  # greatest voltage of a knot, V

    def axes(self) -> list[Axis]:
        """The knots of one coil after those of the other."""
        return [
            Axis(f"{coil} {number}", "V", -self.volts, self.volts)
            for coil in self.coils
            for number in range(1, self.knots + 1)
        ]

    def sampled(self, scenario: Scenario) -> Array:
        """Voltages of a pulsed drive at the knots of its first period, shape (knots * coils,)."""
        drive = scenario.drive
        times = drive.ramp + np.arange(self.knots) / (self.knots * drive.frequency)
        voltages = drive_waveform(scenario).voltages(times)
        return np.concatenate([voltages[:, COIL_NAMES.index(coil)] for coil in self.coils])

    def waveform(self, scenario: Scenario, voltages: Array) -> Waveform:
        """The program: the ramp of `scenario` to the first knot, and a period for each pulse."""
        drive = scenario.drive
        period = np.zeros((self.knots + 1, len(COIL_NAMES)))
        for coil, knots in zip(self.coils, voltages.reshape(len(self.coils), -1), strict=True):
            period[:-1, COIL_NAMES.index(coil)] = knots
        period[-1] = period[0]
        times = np.linspace(0.0, 1.0 / drive.frequency, self.knots + 1)
        pulses = (times, period, drive.pulses)
        if drive.ramp == 0.0:
            return Waveform([pulses])
        return Waveform([([0.0, drive.ramp], [np.zeros(len(COIL_NAMES)), period[0]], 1), pulses])


@dataclass(frozen=True)
class DesignSpace:
    """What may change of `scenario`.

    Attributes
    ----------
    scenario : Scenario
        The start, which gives every key that is not free.
    axes : tuple of Axis
        The numbers, the knots of a waveform last.
    arms : tuple of dict
        Every combination of the words that are free; that of the scenario first.
    periodic : PeriodicWaveform or None
    """

    scenario: Scenario
    axes: tuple[Axis, ...]
    arms: tuple[Mapping[str, Value], ...]
    periodic: PeriodicWaveform | None

    @property
    def _numbers(self) -> int:
        return len(self.axes) - (len(self.periodic.axes()) if self.periodic else 0)

    def start(self, arm: int) -> Array:
        """Coordinates of the scenario with the words of an arm, shape (number of axes,)."""
        values = [float(self.scenario.get(each.name)) for each in self.axes[: self._numbers]]
        if self.periodic:
            values += self.periodic.sampled(self.scenario.replace(self.arms[arm])).tolist()
        return np.array([a.coordinate(v) for a, v in zip(self.axes, values, strict=True)])

    def values(self, arm: int, point: Array) -> dict[str, Value]:
        """Words and numbers of a candidate by name."""
        numbers = {axis.name: axis.value(u) for axis, u in zip(self.axes, point, strict=True)}
        return {**self.arms[arm], **numbers}

    def changes(self, arm: int, point: Array) -> dict[str, Any]:
        """What ``Scenario.replace`` needs for a candidate.

        A ScenarioError says that its values make no scenario together.
        """
        values = self.values(arm, point)
        names = [axis.name for axis in self.axes]
        knots = np.array([values.pop(name) for name in names[self._numbers :]])
        values = self.as_long(values)
        if self.periodic is None:
            return values
        return as_program(self.periodic.waveform(self.scenario.replace(values), knots), values)

    def as_long(self, values: Mapping[str, Value]) -> dict[str, Value]:
        """The values; where the frequency is free, with as many pulses as take the start's time.

        Of drives that are equally long the rise to the first pulse is the same part. They have at
        least `FEWEST` pulses.
        """
        if all(axis.name != "drive.frequency" for axis in self.axes):
            return dict(values)
        drive = self.scenario.drive
        pulses = round(drive.pulses * float(values["drive.frequency"]) / drive.frequency)
        return {**values, "drive.pulses": max(FEWEST, pulses)}

    def nearest(self, sawtooth: Mapping[str, Value]) -> dict[str, Value]:
        """A sawtooth as near to another as what is free allows; all else is as in the scenario.

        A free waveform can be any sawtooth, but for its frequency.
        """
        axes = {axis.name: axis for axis in self.axes}
        found = dict(sawtooth)
        for key, value in sawtooth.items():
            if key in axes:
                found[key] = axes[key].value(axes[key].coordinate(float(value)))
            elif not (self.periodic and key not in OF_A_PROGRAM):
                words = [arm[key] for arm in self.arms if key in arm] or [self.scenario.get(key)]
                found[key] = value if value in words else words[0]
        return found

    def place(self, sawtooth: Mapping[str, Value]) -> tuple[int, Array]:
        """Arm and coordinates of a sawtooth from `nearest`, where no waveform is free."""
        arm = self.arms.index({k: sawtooth.get(k, word) for k, word in self.arms[0].items()})
        values = [float(sawtooth.get(a.name, self.scenario.get(a.name))) for a in self.axes]
        return arm, np.array([a.coordinate(v) for a, v in zip(self.axes, values, strict=True)])

    def changes_or_error(self, arm: int, point: Array) -> dict[str, Any] | ScenarioError:
        """The same, with the error in place of what makes no scenario."""
        try:
            return self.changes(arm, point)
        except ScenarioError as error:
            return error


def as_program(waveform: Waveform, others: Mapping[str, Value]) -> dict[str, Any]:
    """Changes for a scenario that plays a waveform; of `others` those that it still uses."""
    left = {key: value for key, value in others.items() if key not in SAWTOOTH}
    return {**left, "drive.mode": "program", PROGRAM: waveform}


def drive_waveform(scenario: Scenario) -> Waveform:
    """The voltages of any drive as a program."""
    return Waveform(scenario.to_core().program())


def design_space(
    scenario: Scenario,
    free: Mapping[str, Any],
    knots: int | None,
    coils: Sequence[str],
    volts: float | None,
) -> DesignSpace:
    """What may change of a scenario, once all is checked.

    Parameters
    ----------
    scenario : Scenario
    free : mapping
        By key ``(low, high)`` of a number, or a list of words.
    knots : int or None
        Of a free waveform; None for none.
    coils : sequence of str
        Coils that it drives.
    volts : float or None
        Limit on the voltages, which a free waveform needs.

    Raises
    ------
    ScenarioError
        If a key, range or word is not allowed, or nothing is free.
    """
    if not free and knots is None:
        raise ScenarioError("nothing is free: allowed are keys with a range, or knots, or both")
    by_name = {full_name(key): value for key, value in free.items()}
    periodic = None if knots is None else _periodic(scenario, by_name, knots, coils, volts)
    if periodic is None:
        refuse_sawtooth(scenario.drive.mode, by_name)
    axes, words = [], {}
    drawn = scenario.uncertain
    for key, value in by_name.items():
        if drawn is not None and key in (*drawn.priors, *drawn.keys):
            raise ScenarioError(f"{key}: allowed is either free or uncertain, not both")
        if find_key(key).kind == "word":
            words[key] = _words(scenario, key, value)
        else:
            axes.append(_axis(key, value))
    arms = tuple(dict(zip(words, each, strict=True)) for each in itertools.product(*words.values()))
    return DesignSpace(scenario, (*axes, *(periodic.axes() if periodic else ())), arms, periodic)


def _axis(key: str, given: Any) -> Axis:
    known = find_key(key)
    if known.kind != "real" or known.section in ("solver", "record"):
        raise ScenarioError(f"{key}: cannot be free; allowed are words and real numbers of a model")
    if isinstance(given, str) or not isinstance(given, Sequence) or len(given) != 2:
        raise ScenarioError(f"{key} = {shown(given)}: allowed is {_ALLOWED}")
    low, high = (float(checked(key, each)) for each in given)
    if not low < high:
        raise ScenarioError(f"{key} = {shown(low)}:{shown(high)}: allowed is low below high")
    return Axis(key, known.unit, low, high)


def _words(scenario: Scenario, key: str, given: Any) -> list[Value]:
    if isinstance(given, str) or not isinstance(given, Sequence) or not given:
        raise ScenarioError(f"{key} = {shown(given)}: allowed is a list of words")
    words = list(dict.fromkeys(checked(key, each) for each in given))
    if key == "drive.mode" and "program" in words:
        raise ScenarioError(f'{key} = "program": cannot be tried; a free waveform has knots')
    return sorted(words, key=lambda word: word != scenario.get(key))


def _periodic(
    scenario: Scenario,
    free: Mapping[str, Any],
    knots: object,
    coils: Sequence[str],
    volts: float | None,
) -> PeriodicWaveform:
    if isinstance(knots, bool) or not isinstance(knots, int) or not 2 <= knots <= _MOST_KNOTS:
        raise ScenarioError(f"knots = {shown(knots)}: allowed is from 2 to {_MOST_KNOTS}")
    if scenario.drive.mode == "program":
        raise ScenarioError(
            'knots: not allowed with drive.mode = "program", whose period is not known; allowed '
            'is "IPP" or "OPP", whose frequency, pulses and ramp the waveform has'
        )
    if scenario.drive.heading != 0.0:
        raise ScenarioError(
            f"knots: not allowed with drive.heading = {scenario.drive.heading:g}: a free waveform "
            "has no heading, and goes where its coils pull"
        )
    for key in free:
        if key in SAWTOOTH and key not in OF_A_PROGRAM and find_key(key).kind != "word":
            allowed = ", ".join(OF_A_PROGRAM)
            raise ScenarioError(f"{key}: of no use with knots; of the drive, allowed are {allowed}")
    chosen = (coils,) if isinstance(coils, str) else tuple(coils)
    for coil in chosen:
        if coil not in COIL_NAMES:
            allowed = f"allowed is one of {', '.join(COIL_NAMES)}{meant(coil, COIL_NAMES)}"
            raise ScenarioError(f"coil {shown(coil)}: {allowed}")
    if not chosen or len(set(chosen)) < len(chosen):
        refuse("coils", list(chosen), "each coil once, at least one")
    if volts is None or not volts > 0.0:
        raise ScenarioError(
            "knots: a limit on voltage_max above 0 V is missing, within which the knots are placed"
        )
    return PeriodicWaveform(knots, chosen, volts)
