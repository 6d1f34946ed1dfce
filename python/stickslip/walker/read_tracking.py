"""Side-view tracking of one run: its frames, its camera, and the scenario of that run."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from stickslip._util.arrays import Array, Mask
from stickslip._util.columns import SourceTable, sound_numbers
from stickslip._util.messages import refuse, shown
from stickslip._util.note import Note
from stickslip._util.recipes import Recipe
from stickslip._util.text import OneLine, counted, highest, is_number, plain
from stickslip._util.units import split_unit
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import FILE
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.quantities import COLUMNS, headings
from stickslip.walker.outliers import NEIGHBOURS, ONE_TRACK, lost_frames, one_place_each

REQUIRED = {"t": "s", "x": "m", "theta": "rad"}
_TRACKED = "", "track", "particle", "robot", "object"
"""Columns that number bodies where several were tracked."""

_OPTIONAL = {"z": "m", "current_x": "A", "current_clamp": "A"}

_OF_A_RUN = [split_unit(heading)[0] for name in COLUMNS for heading in headings(name)]
"""Columns of the CSV file of a run, which is a film too."""

_RECIPE = Recipe.of(REQUIRED | _OPTIONAL, REQUIRED, information=frozenset(_OF_A_RUN))

FEWEST = 20
"""Frames after the third pulse; runs with fewer are left out. Chosen: they tell too little."""

_NOISIEST = 0.5
"""Error of an angle that still says something, rad; that of a place is the robot's length. Chosen:
half of what the robot tilts. Larger ones are in degrees or um."""

_WRAPPED, _ODD = 2, 0.1
"""Most turns by which an angle is moved, and share of the large jumps that may be no whole turns.
Chosen: counts of turns are small, and what a lost frame has is a jump of any size."""

_OTHER_RATE = 0.02
"""Relative difference of the stated rate from that of the times. Chosen: rounding causes less."""

_LIMIT = 20_000
"""Frames that are used. Chosen: each is a column of a matrix of a few hundred rows, in memory."""


_Why = tuple[str, str, float]
"""Code, text and value of the note that a run is left out; the text goes on after ``as``."""


@dataclass(frozen=True, repr=False, eq=False)
class TrackingRun(OneLine):
    """Tracked frames of one run, sound ones only, in the order of time.

    Attributes
    ----------
    file : str
        Name of the table.
    columns : dict of ndarray, shape (n,)
        ``t`` (s, 0 at the start of the drive), ``x`` (m), ``theta`` (rad); ``z`` (m), ``current_x``
        and ``current_clamp`` (A) where they were measured, NaN in frames that lack them.
    scenario : Scenario
        Of this run: the measurement's with this run's drive.
    exposure : float
        s; 0 where it was not stated.
    noise : dict of float
        Stated standard deviation of a frame, of ``x`` (m) and ``theta`` (rad); only what is known.
    """

    file: str
    columns: Mapping[str, Array]
    scenario: Scenario
    exposure: float = 0.0
    noise: Mapping[str, float] = field(default_factory=dict)


def read_tracking(
    path: Path, entry: Mapping[str, Any], scenario: Scenario
) -> tuple[TrackingRun | None, list[Note]]:
    """Read one ``[[tracking]]`` entry, whose drive changes the measurement's scenario.

    Returns the run, or None where too little is sound, and what was left out; of a run that is
    None the last of these says why.
    """
    where = f"[[tracking]] {path.name}"
    with prefixed(where):
        driven = _own_scenario(entry.get("drive", {}), scenario)
        most = {"x": driven.robot.length, "theta": _NOISIEST}
        noise = {
            name: stated_number(f"noise_{name}", entry[f"noise_{name}"], highest, REQUIRED[name])
            for name, highest in most.items()
            if f"noise_{name}" in entry
        }
        stated = "frame_rate" in entry
        rate = stated_number("frame_rate", entry["frame_rate"]) if stated else math.nan
        exposure = _exposure(entry.get("exposure", 0.0), rate)
    columns, left_out = sound_numbers(path, _RECIPE, _refuse_several)
    try:
        columns = _usable_frames(path.name, columns, driven, left_out)
        why = _too_little(columns, driven)
    except ScenarioError as error:
        why = "run-of-two-bodies", str(error), math.nan
    if why is not None:
        code, text, value = why
        text = f"{path.name}: the run is left out, as {text}."
        return None, [*left_out, Note(code, text, value)]
    spacing = float(np.median(np.diff(columns["t"])))
    if not stated:
        with prefixed(where):
            _exposure(exposure, 1.0 / spacing)
    elif abs(rate * spacing - 1.0) > _OTHER_RATE:
        text = f"{path.name}: frame_rate = {rate:g} Hz is not used, as most frames are "
        left_out.append(Note("frame-rate-not-used", f"{text}{spacing:g} s apart.", rate))
    return TrackingRun(path.name, columns, driven, exposure, noise), left_out


def stated_number(key: str, value: object, highest: float = math.inf, unit: str = "") -> float:
    """A number of a measurement file above 0 and below `highest`."""
    if not is_number(value) or not 0.0 < value < highest:
        below = "" if math.isinf(highest) else f" and below {highest:g} {unit}".rstrip()
        refuse(key, value, f"a number above 0{below}")
    return float(value)


def _refuse_several(table: SourceTable) -> None:
    """Refuse a column that numbers tracked bodies, two of which are there at the same times."""
    times = table.columns["t"].values.tolist()
    for name, column in table.columns.items():
        if plain(name).removesuffix("id").strip() not in _TRACKED:
            continue
        seen: dict[str, list[float]] = {}
        for value, t in zip(column.texts, times, strict=True):
            if not math.isnan(t) and value:
                seen.setdefault(value, []).append(t)
        spans = sorted((min(of), max(of), value) for value, of in seen.items())
        for (_, end, one), (begin, _, other) in itertools.pairwise(spans):
            if begin < end:
                raise ScenarioError(
                    f"{table.path}: column {name} has {shown(one)} and {shown(other)} at the same "
                    f"times: allowed is {ONE_TRACK}"
                )


def _own_scenario(drive: object, scenario: Scenario) -> Scenario:
    if not isinstance(drive, dict):
        refuse("drive", drive, "a table of keys of [drive]")
    changes = {f"drive.{key}": value for key, value in drive.items()}
    if FILE in changes:
        raise ScenarioError(
            f"{FILE} = {shown(changes[FILE])}: the voltages of a program stand in the scenario "
            "file, not in an override"
        )
    return scenario.replace(changes)


def _exposure(value: object, rate: float) -> float:
    top = 1.0 / rate if math.isfinite(rate) else math.inf
    # Both come rounded from files.
    if not is_number(value) or not 0.0 <= float(value) <= top * (1 + 1e-6):
        most = f", {highest(top)} s" if math.isfinite(top) else ""
        refuse("exposure", value, f"from 0 to the time between two frames{most}")
    return float(value)


def _usable_frames(
    name: str, table: Mapping[str, Array], scenario: Scenario, left_out: list[Note]
) -> dict[str, Array]:
    """Frames of the robot in the order of time, each once, before the end of the last pulse.

    What the coils do after that is not known. A ScenarioError says that there are two bodies.
    """
    end, length = scenario.window[1], scenario.robot.length
    back = np.flatnonzero(np.diff(table["t"]) < 0.0)
    if back.tolist() == [len(table["t"]) - 2]:
        text = f"{name}: the last row goes back in time, as means below a table do; left out."
        left_out.append(Note("last-row-back", text))
        table = {key: column[:-1] for key, column in table.items()}
    order = one_place_each(table["t"], table["x"])
    inside = table["t"][order] < end
    sound, late = int(inside.sum()), int((~inside).sum())
    again = len(table["t"]) - len(order)
    if np.any(np.diff(table["t"]) < 0.0):
        text = f"{name}: the rows were not in the order of time; they were sorted."
        left_out.append(Note("frames-sorted", text))
    if again:
        text = f"{name}: of frames with the same time only the first is used; {again} left out."
        left_out.append(Note("repeated-times", text, again))
    if late:
        text = f"{name}: the last pulse ends at {end:g} s, and later frames are not used; "
        left_out.append(Note("frames-after-drive", f"{text}{late} left out.", late))
    if sound > _LIMIT:
        text = f"{name}: the first {_LIMIT} of {sound} frames are enough."
        left_out.append(Note("frames-not-needed", text, sound))
    used = order[inside][:_LIMIT]
    if len(used) > 2:
        times = table["t"][used]
        lost = lost_frames(times, table["x"][used], length)
        if lost.any():
            text = f"{name}: in {counted(int(lost.sum()), 'frame')} x is not where the robot can "
            text += f"be, the first at {times[lost][0]:.5g} s; left out."
            left_out.append(Note("lost-frames", text, int(lost.sum())))
        used = used[~lost]
    columns = {key: column[used] for key, column in table.items()}
    columns["theta"], moved = _without_turns(columns["theta"])
    if moved.any():
        text = f"{name}: theta of {counted(int(moved.sum()), 'frame')} is moved by whole turns, by "
        text += f"which it jumps, the first at {columns['t'][moved][0]:.5g} s."
        left_out.append(Note("whole-turns", text, int(moved.sum())))
    return columns


def _without_turns(theta: Array) -> tuple[Array, Mask]:
    """Angles that follow from frame to frame, and which of them were moved by whole turns, if any.

    Only where nearly all large jumps are by whole turns; the first frames are near lying flat.
    """
    whole = 2.0 * math.pi
    jump = np.abs(np.diff(theta))
    large = jump[(jump > 0.25 * whole) & (jump < (_WRAPPED + 0.25) * whole)]
    odd = np.abs(large - whole * np.round(large / whole)) > 0.25 * whole
    if not len(large) or np.mean(odd) > _ODD:
        return theta, np.zeros(len(theta), dtype=bool)
    even, last = theta.copy(), theta[0]
    for k, angle in enumerate(theta.tolist()):
        turns = round((angle - last) / whole)
        near = abs(angle - last - whole * turns) < 0.25 * whole
        last = even[k] = angle - whole * turns if near and abs(turns) <= _WRAPPED else angle
    even -= whole * np.round(np.median(even[:NEIGHBOURS]) / whole)
    return even, np.abs(even - theta) > 0.5 * whole


def _too_little(table: Mapping[str, Array], scenario: Scenario) -> _Why | None:
    """Why a run is not used, if it is not."""
    start, end = scenario.window
    count = int(np.sum(table["t"] > start - 1e-9))
    if count < FEWEST:
        text = f"it has {counted(count, 'sound frame')} from {start:g} s to {end:g} s, where the "
        text += f"robot walks steadily; {FEWEST} are needed (times are in s, from the start of the "
        return "run-too-short", f"{text}drive)", count
    if float(np.ptp(table["x"])) == 0.0 and float(np.ptp(table["theta"])) == 0.0:
        return "run-stands-still", "neither x nor theta ever changes", 0.0
    return None
