"""Side-view tracking of one run: its frames, its camera, and the scenario of that run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.equal_numbers import are_equal
from stickslip._util.number_text import highest, is_number
from stickslip._util.one_line import OneLine
from stickslip._util.unit_factor import unit_meant
from stickslip.errors import ScenarioError, prefixed
from stickslip.facts import Code, Fact
from stickslip.measurement.tables import read_numbers, stated_number
from stickslip.scenario.keys import refuse, shown
from stickslip.scenario.path_keys import FILE
from stickslip.scenario.scenario import Scenario

_REQUIRED = {"t": "s", "x": "m", "theta": "rad"}
_OPTIONAL = {"z": "m", "current_x": "A", "current_clamp": "A"}

FEWEST = 20
"""Frames after the third pulse; runs with fewer are left out. Chosen: they tell too little."""

# Path that no robot of this size walks in one film, m: it would leave the coils. A median tilt that
# no walking robot has, rad. Beyond these the unit is wrong.
_LONGEST, _TURNS = 0.1, 2.0 * math.pi

_PATH = 1e-3
"""Path that a robot walks in one film, about, m; what is in another unit is compared with it."""

_PART = 30.0
"""Ratio of the last time to 1000 times the drive's end within which times are in ms. Chosen: a film
may show a thirtieth of the drive."""

_MS_OR_NUMBERS = "ms or numbers of frames"

_OTHER_RATE = 0.02
"""Relative difference of the stated rate from that of the times. Chosen: rounding causes less."""

_LIMIT = 20_000
"""Frames that are used. Chosen: each is a column of a matrix of a few hundred rows, in memory."""


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
    frame_rate : float
        Hz; from the times, where it was not stated.
    exposure : float
        s; 0 where it was not stated.
    noise : dict of float
        Stated standard deviation of a frame, of ``x`` (m) and ``theta`` (rad); only what is known.
    """

    file: str
    columns: Mapping[str, Array]
    scenario: Scenario
    frame_rate: float
    exposure: float = 0.0
    noise: Mapping[str, float] = field(default_factory=dict)


def read_tracking(
    path: Path, entry: Mapping[str, Any], scenario: Scenario
) -> tuple[TrackingRun | None, list[Fact]]:
    """Read one ``[[tracking]]`` entry, whose drive changes the measurement's scenario.

    Returns the run, or None where too little is sound, and what was left out; of a run that is
    None the last of these says why.
    """
    where = f"[[tracking]] {path.name}"
    with prefixed(where):
        own = _own_scenario(entry.get("drive", {}), scenario)
        noise = {
            name: stated_number(f"noise_{name}", entry[f"noise_{name}"])
            for name in ("x", "theta")
            if f"noise_{name}" in entry
        }
        stated = "frame_rate" in entry
        rate = stated_number("frame_rate", entry["frame_rate"]) if stated else math.nan
        exposure = _exposure(entry.get("exposure", 0.0), rate)
    columns, left_out = read_numbers(path, _REQUIRED, _OPTIONAL)
    unit = _unit_of_times(columns["t"], rate, own.window[1])
    if unit is not None:
        return None, [*left_out, unit.of(table=path.name)]
    columns, facts = _usable_frames(path.name, columns, own.window[1])
    left_out += facts
    why = _too_little(columns, own)
    if why is not None:
        return None, [*left_out, why.of(table=path.name)]
    spacing = float(np.median(np.diff(columns["t"])))
    if not math.isfinite(rate):
        rate = 1.0 / spacing
        with prefixed(where):
            _exposure(exposure, rate * (1 - 1e-6))
    elif abs(rate * spacing - 1.0) > _OTHER_RATE:
        rates = {"table": path.name, "stated": rate, "spacing": spacing}
        left_out.append(Fact(Code.FRAME_RATE_NOT_USED, rates))
    return TrackingRun(path.name, columns, own, rate, exposure, noise), left_out


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
    if is_number(value) and value == 0:
        return 0.0
    top = 1.0 / rate if math.isfinite(rate) else math.inf
    if not is_number(value) or not 0.0 <= float(value) <= top * (1 + 1e-9):
        most = f", {highest(top)} s" if math.isfinite(top) else ""
        refuse("exposure", value, f"from 0 to the time between two frames{most}")
    return float(value)


def _unit_of_times(times: Array, rate: float, end: float) -> Fact | None:
    """A fact if times can only be in ms or numbers of frames, as hardly one is before the `end`.

    `rate` is the stated one, Hz, or NaN.
    """
    different = np.unique(times)
    if len(different) < 2 or different[-1] <= end:
        return None
    spacing = float(np.median(np.diff(different)))
    counted = are_equal(spacing, 1.0)
    found: tuple[str, float | None] | None = None
    if math.isfinite(rate):
        found = unit_meant("s", spacing * rate, 1.0 + _OTHER_RATE)
        if counted and rate > 1.0 + _OTHER_RATE:
            found = ("numbers of frames" if found is None else _MS_OR_NUMBERS), rate
    elif np.sum(different < end) < FEWEST:
        found = unit_meant("s", float(different[-1]) / end, _PART)
        found = (_MS_OR_NUMBERS, None) if counted and found is not None else found
    if found is None:
        return None
    meant, factor = found
    of_times = {"spacing": spacing, "last": float(different[-1]), "meant": meant}
    return Fact(Code.RUN_TIME_UNIT, {**of_times, "factor": factor})


def _usable_frames(
    name: str, table: Mapping[str, Array], end: float
) -> tuple[dict[str, Array], list[Fact]]:
    """Frames in the order of time, each time once, before the end of the last pulse, s.

    What the coils do after that is not known. The facts say what was left out.
    """
    order = np.argsort(table["t"], kind="stable")
    times, first = np.unique(table["t"][order], return_index=True)
    inside = times < end
    sound, late = int(inside.sum()), int((~inside).sum())
    again = len(order) - len(times)
    met: tuple[tuple[object, Code, dict[str, Any]], ...] = (
        (np.any(np.diff(order) < 0), Code.FRAMES_SORTED, {}),
        (again, Code.REPEATED_TIMES, {"count": again}),
        (late, Code.FRAMES_AFTER_DRIVE, {"count": late, "end": end}),
        (sound > _LIMIT, Code.FRAMES_NOT_NEEDED, {"count": sound, "used": _LIMIT}),
    )
    facts = [Fact(code, {"table": name, **fields}) for holds, code, fields in met if holds]
    used = order[first][inside][:_LIMIT]
    return {key: column[used] for key, column in table.items()}, facts


def _too_little(table: Mapping[str, Array], scenario: Scenario) -> Fact | None:
    """Why a run is not used, if it is not."""
    start, end = scenario.window
    count = int(np.sum(table["t"] > start - 1e-9))
    if count < FEWEST:
        span = {"count": count, "start": start, "end": end, "needed": FEWEST}
        return Fact(Code.RUN_TOO_SHORT, span)
    turn = float(np.median(np.abs(table["theta"])))
    if turn > _TURNS:
        return Fact(Code.RUN_ANGLE_UNIT, {"theta": turn, "limit": _TURNS})
    way = float(np.ptp(table["x"]))
    if way > _LONGEST:
        meant, _ = unit_meant("m", way / _PATH, math.inf, 1e3) or ("mm or um", None)
        return Fact(Code.RUN_LENGTH_UNIT, {"span": way, "limit": _LONGEST, "meant": meant})
    if way == 0.0 and float(np.ptp(table["theta"])) == 0.0:
        return Fact(Code.RUN_STANDS_STILL, {})
    return None
