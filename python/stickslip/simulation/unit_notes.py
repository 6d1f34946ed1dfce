"""Values of a scenario that are hardly in SI units, or that did not follow others."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array
from stickslip._util.note import Note
from stickslip._util.units import NEAR, unit_meant
from stickslip.field.coils import AXES
from stickslip.scenario.keys import COIL_NAMES, known_keys

if TYPE_CHECKING:
    from stickslip.field.field_map import FieldMap
    from stickslip.scenario.scenario import Scenario

DEFAULTS = {
    name: float(key.default)
    for name, key in known_keys().items()
    if not isinstance(key.default, str)
}
"""Numbers of a scenario where none are given, by key."""

LONG_PULSE = 1.0
"""Shortest pulse that is noted, s. Chosen: the paper drives at 1 to 200 Hz."""

MANY_TIME_CONSTANTS = 100.0
"""The same in time constants of the slowest coil, which has to be exceeded too: large coils with
little resistance take seconds to follow."""

_LONG_LATENCY = 1.0
"""Longest latency of the drive that is not noted, s. Chosen: amplifiers and cards take ms."""

_TIMES_TABLE_I = 10.0
"""Ratio to the size of Table I's coils below which those of a laboratory lie, 1 m: ten times more
is in cm, and what is nearer to 1000 times more in mm."""

_OTHER_WINDING = 1.3
"""Ratio of turns^2 side from which on an inductance that did not follow is noted. Chosen: as much
as the shape of a winding changes it."""

_OF_A_WINDING = ("coil.turns", "coil.side", "coil.inductance", "coil.resistance")

_LONG = 30.0
"""Ratio of a length of the body to its shortest beyond which it alone is in another unit. Chosen:
thin sheets and rods have less."""

_LEAST_BACKGROUND = 0.01
"""Part of the coils' field below which a background is not noted: 10 uT at 1 A in those of Table
I."""

_COMMON = 5.0
"""Ratio of a background to its scatter among coils from which on it is common. Chosen: of coils
turned each on its own by chance, 3 sets of five in 10 000 have that, and 3 sets of four in 1000."""


def unit_notes(scenario: Scenario, core: _core.Scenario) -> list[Note]:
    """Notes on values in another unit; none for sound scenarios. `core` is that of the scenario."""
    return [
        *_of_map(scenario),
        *_of_pulses(scenario, core),
        *_of_latency(scenario),
        *_of_pitch(scenario),
        *_of_coils(scenario),
        *_of_robot(scenario),
    ]


def time_constants(scenario: Scenario, core: _core.Scenario) -> dict[str, float]:
    """L/R of each coil, s."""
    return {
        name: float(scenario.get(f"coil.{name}.inductance")) / resistance
        for name, resistance in zip(_core.coil_names, core.resistances(), strict=True)
    }


def _of_map(scenario: Scenario) -> list[Note]:
    field_map = scenario.coil.map
    if field_map is None:
        return []
    made = _core.Scenario()
    made.set_map(field_map.to_core())
    return [*_of_places(field_map, made, scenario.coil.distance), *_of_background(field_map, made)]


def _of_places(field_map: FieldMap, made: _core.Scenario, distance: float) -> list[Note]:
    """Whether the places of a map are in another unit.

    A wide map alone may be one of wide coils. How fast a field changes tells how far its coils are.
    """
    span = max(high - low for low, high in zip(field_map.low, field_map.high, strict=True))
    if span <= distance:
        return []
    farther = np.median(_decay_lengths(made) / _decay_lengths(_core.Scenario()))
    meant = unit_meant("m", float(farther), _TIMES_TABLE_I)
    if meant is None:
        return []
    unit, factor = meant
    text = (
        f"coil.map spans {span:.3g} m, {span / distance:.2g} times coil.distance = {distance:g}, "
        f"and its field changes as slowly as that of coils {farther * distance:.2g} m away: are x, "
        f"y and z in {unit}? Divide them by {factor:.7g}"
    )
    return [Note("unit-map", text, span)]


def _decay_lengths(made: _core.Scenario) -> Array:
    """Field over its derivative along itself, at the centre, of each coil with a field, m."""
    coils, centre, currents = made.coils(), np.zeros((len(AXES), 3)), np.eye(len(AXES))
    at = np.arange(len(AXES))
    field = coils.field(centre, currents)[at, AXES]
    slope = coils.gradient(centre, currents).reshape(-1, 3, 3)[at, AXES, AXES]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.abs(field / slope))


def _of_background(field_map: FieldMap, made: _core.Scenario) -> list[Note]:
    """Whether the field of the surroundings is in that of each coil.

    At the centre a coil has no field across its axis, but by its mounting, which differs from coil
    to coil. A frame that is turned as a whole gives coils of two axes opposite fields.
    """
    fields = made.coils().field(np.zeros((len(AXES), 3)), np.eye(len(AXES)))
    sizes = np.linalg.norm(fields, axis=1)
    used = sizes > 0.0
    if np.sum(used) < len(AXES) - 1:
        return []
    along = np.arange(3) == np.array(AXES)[:, None]
    across = np.ma.masked_array(fields, along | ~used[:, None])
    common = across.mean(axis=0).data
    scatter = math.sqrt(np.sum((across - common) ** 2) / (across.count() - 3))
    # The error of a mean over all points.
    noise = np.max(np.array(field_map.residual)[used] / np.sqrt(np.array(field_map.points)[used]))
    size, coil = float(np.linalg.norm(common)), float(np.median(sizes[used]))
    if size < max(_LEAST_BACKGROUND * coil, _COMMON * math.hypot(scatter, noise)):
        return []
    vector = ", ".join(f"{1e6 * value:.1f}" for value in common)
    text = (
        f"coil.map: every coil has the field ({vector}) uT/A beside its own, "
        f"{size / coil:.2g} of it, as if the field without current, such as the Earth's, was not "
        "subtracted; subtract what the probe reads without current, then divide by the current"
    )
    return [Note("unit-map-background", text, size)]


def _of_pulses(scenario: Scenario, core: _core.Scenario) -> list[Note]:
    drive = scenario.drive
    lasting = 1.0 / drive.frequency
    meant = f"is drive.frequency = {drive.frequency:g} in kHz? Multiply it by 1000"
    if drive.kind == "none":
        return []
    if drive.kind == "program":
        lasting = shortest_tooth(core.program().blocks)
        meant = "are the times of the voltages in ms? Divide them by 1000"
    slowest = max(time_constants(scenario, core).values())
    if not max(LONG_PULSE, MANY_TIME_CONSTANTS * slowest) < lasting < math.inf:
        return []
    text = f"a pulse lasts {lasting:.4g} s"
    if slowest > 0.0:  # not of an inductance next to zero
        text += f", {lasting / slowest:.3g} times the longest time constant of a coil"
    return [Note("unit-time", f"{text}; {meant}", lasting)]


def _of_latency(scenario: Scenario) -> list[Note]:
    latency = scenario.drive.latency
    if latency <= _LONG_LATENCY:
        return []
    text = f"drive.latency = {latency:g} s, before which nothing drives: {_question(('ms', 1e3))}"
    return [Note("unit-time", text, latency)]


def _of_pitch(scenario: Scenario) -> list[Note]:
    """Whether the pitch at the start is in degrees.

    A robot that rolled over may be beyond a turn too; a run returns such a number with all digits.
    """
    theta = scenario.initial.theta
    if abs(theta) <= math.tau or round(theta, 1) != theta:
        return []
    text = (
        f"initial.theta = {theta:g} rad is more than a turn: is it in degrees? {theta:g} degrees "
        f"are {math.radians(theta):.4g} rad"
    )
    return [Note("unit-angle", text, theta)]


def shortest_tooth(blocks: Sequence[tuple[Array, Array, int]]) -> float:
    """Shortest time between two edges of a coil's voltage between which it comes back, s.

    `blocks` are times (s), voltages (n x 5) and repeats. An edge is a jump, or a slope of over five
    times the mean of its block. Slow ramps have no edges, and after the edge of a hold the voltage
    stays; infinity where no block has two teeth.
    """
    shortest = math.inf
    for t, v, repeats in blocks:
        count = min(repeats, 3)
        times = np.concatenate([t + k * t[-1] for k in range(count)])
        voltages = np.tile(v, (count, 1))
        shortest = min(shortest, *(_shortest_tooth(times, coil) for coil in voltages.T))
    return shortest


def _shortest_tooth(times: Array, volts: Array) -> float:
    step, last = np.diff(volts), np.diff(times)
    mean = float(np.sum(np.abs(step))) / float(times[-1])
    edges = np.flatnonzero(np.abs(step) > 5.0 * mean * last)
    if len(edges) < 3:
        return math.inf
    back = volts[edges[1:]] - volts[edges[:-1] + 1]
    teeth = back * step[edges[:-1]] < -0.5 * step[edges[:-1]] ** 2
    return float(np.min(np.diff(times[edges])[teeth])) if np.sum(teeth) > 1 else math.inf


def _of_coils(scenario: Scenario) -> list[Note]:
    cases = [
        ("coil.side", 1.0, _TIMES_TABLE_I, "m", "unit-length", "that of Table I"),
        ("coil.distance", 1.0, _TIMES_TABLE_I, "m", "unit-length", "that of Table I"),
    ]
    left = []
    if scenario.coil.map is None:  # beside which turns and side are not stated
        shared = _shared(scenario)
        left = _of_windings(scenario, shared)
        if shared["coil.inductance"] != DEFAULTS["coil.inductance"]:
            likely, what = _winding(shared, DEFAULTS), "what the turns and the side make likely"
            cases.append(("coil.inductance", likely, NEAR, "H", "unit-inductance", what))
    notes = []
    for key, usual, within, unit, code, what in cases:
        ratio = _times_default(scenario, key) / usual
        meant = unit_meant(unit, ratio, within)
        if meant is not None:
            value = float(scenario.get(key))
            text = f"{key} = {value:g} {unit} is {ratio:.3g} times {what}: {_question(meant)}"
            notes.append(Note(code, text, value))
    return notes or left  # a side in another unit makes another winding


def _of_windings(scenario: Scenario, shared: Mapping[str, float]) -> list[Note]:
    """Whether an inductance stayed where the turns or the side of its coil did not."""
    for coil in COIL_NAMES:
        own = {key: float(scenario.get(key.replace(".", f".{coil}."))) for key in _OF_A_WINDING}
        henry = own["coil.inductance"]
        tabled = henry == DEFAULTS["coil.inductance"]
        usual, whose = (DEFAULTS, "Table I's") if tabled else (shared, "that of all coils")
        ratio = _winding(own, usual)
        off = abs(math.log(ratio)) > math.log(_OTHER_WINDING)
        if henry == usual["coil.inductance"] and off:
            at = "coil" if _winding(own, shared) == 1.0 else f"coil.{coil}"
            text = (
                f"{at}.inductance = {henry:g} H is {whose}, but the turns or the side are not: "
                f"they make about {henry * ratio:.2g} H. State {at}.inductance"
            )
            if own["coil.resistance"] == usual["coil.resistance"]:
                text += f" and {at}.resistance"
            return [Note("inductance", text, henry)]
    return []


def _shared(scenario: Scenario) -> dict[str, float]:
    """Values of all coils; the median where all five have turns, or a side, of their own."""
    shared = {key: float(scenario.get(key)) for key in _OF_A_WINDING}
    for key in ("coil.turns", "coil.side"):
        own = [float(scenario.get(key.replace(".", f".{coil}."))) for coil in COIL_NAMES]
        if shared[key] not in own:
            shared[key] = float(np.median(own))
    return shared


def _winding(values: Mapping[str, float], usual: Mapping[str, float]) -> float:
    """What an inductance grows with, turns^2 side, over the usual one.

    Coils without iron have a third to three times of it, by the shape of the winding.
    """
    turns, side = (values[key] / usual[key] for key in ("coil.turns", "coil.side"))
    return turns**2 * side


def _times_default(scenario: Scenario, *keys: str) -> float:
    """Product of the values of some keys, over that of their defaults."""
    return math.prod(float(scenario.get(key)) / DEFAULTS[key] for key in keys)


def _of_robot(scenario: Scenario) -> list[Note]:
    """Whether the mass or the lengths make a density that only another unit can.

    Magnets and what is made with them have 2 500 to 25 000 kg/m3.
    """
    names = [f"robot.{name}" for name in ("length", "width", "height")]
    mass, sizes = scenario.robot.mass, np.array([float(scenario.get(name)) for name in names])
    density = f"a density of {mass / float(np.prod(sizes)):.3g} kg/m3"
    times_usual = _times_default(scenario, "robot.mass") / _times_default(scenario, *names)
    meant = unit_meant("kg", times_usual)
    if meant is not None:
        text = f"robot.mass = {mass:g} kg makes {density}: {_question(meant)}"
        return [Note("unit-mass", text, mass)]
    for wrong in (sizes > _LONG * np.min(sizes), np.ones(3, dtype=bool)):
        share = 1.0 / max(int(wrong.sum()), 1)  # each of them has the factor
        meant = unit_meant("m", times_usual**-share, NEAR**share)
        if meant is not None and wrong.any():
            given = [f"{names[k]} = {sizes[k]:g} m" for k in np.flatnonzero(wrong)]
            text = f"{' and '.join(given)} make{'s' if len(given) == 1 else ''} {density}"
            largest = float(np.max(sizes[wrong]))
            return [Note("unit-length", f"{text}: {_question(meant, len(given))}", largest)]
    return []


def _question(meant: tuple[str, float], count: int = 1) -> str:
    """Whether numbers are in another unit."""
    unit, factor = meant
    ask, what = ("is it", "it") if count == 1 else ("are they", "them")
    return f"{ask} in {unit}? Divide {what} by {factor:.7g}"
