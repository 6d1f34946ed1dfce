"""CSV files of voltages."""

from __future__ import annotations

import csv
from array import array
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stickslip._util.files import read_bytes
from stickslip._util.numbers import Array, Mask
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.csv_cells import read_cells
from stickslip.scenario.sections import COIL_NAMES

if TYPE_CHECKING:
    from stickslip.scenario.waveform import Waveform

COLUMNS = ("t", *COIL_NAMES)

ROUNDING = 1e-12
"""Part of a time by which sums of times may be rounded. Chosen: a thousand sums of doubles."""

_MOST_ROWS = 2_000_000  # chosen: a minute of voltages at 30 kHz; 100 MB in memory
# The longest number has 24 characters, so what is written can be read.
_MOST_BYTES = _MOST_ROWS * 25 * len(COLUMNS) + 1000
_UNITS = {"t": "s", **dict.fromkeys(COIL_NAMES, "V")}


def read_points(path: str | PathLike[str]) -> tuple[Array, Array]:
    """Times (n,) in s and voltages (n, 5) in V; see `Waveform.from_csv`."""
    with prefixed(path):
        table = _table(read_bytes(path, _MOST_BYTES, "file of voltages"))
    return table[:, 0].copy(), table[:, 1:].copy()


def write_rows(waveform: Waveform, path: Path) -> None:
    """See `Waveform.to_csv`; a file that is there is overwritten."""
    rows = sum(len(t) * repeats for t, _, repeats in waveform.blocks)
    if rows > _MOST_ROWS:
        raise ValueError(f"{rows} rows of voltages: allowed are at most {_MOST_ROWS}")
    t, v = waveform.points()
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(np.column_stack([t, v]).tolist())


def _table(data: bytes) -> Array:
    """The columns in the order of COLUMNS; row numbers in messages are lines of the file."""
    table, lines = array("d"), array("l")
    line = 0
    for line, _, values in read_cells(data, _UNITS):
        _check_time(values[0], table, line)
        table.extend(values)
        lines.append(line)
        if len(table) > _MOST_ROWS * len(COLUMNS):
            raise ScenarioError(f"row {line}: allowed are at most {_MOST_ROWS} rows of voltages")
    points = np.frombuffer(table).reshape(-1, len(COLUMNS))
    if len(points) < 2:
        raise ScenarioError(f"has {len(points)} row(s) of voltages: allowed are two or more")
    if points[-1, 0] == 0.0:
        raise ScenarioError(f"row {line}, column t = 0.0: the last time has to be above 0")
    third = third_at_one_time(points[:, 0], points[:, 1:])
    if third is not None:
        raise ScenarioError(
            f"row {lines[third]}: third row at t = {float(points[third, 0])!r}: allowed are two, a "
            "jump; are the times rounded, or in ms?"
        )
    return points


def third_at_one_time(t: Array, v: Array) -> int | None:
    """The first point that is a third one at its time, not counting points that repeat another.

    Only the first and the last of them would count. Times have shape (n,), voltages (n, 5).
    """
    kept = np.flatnonzero(differing(t, v))
    times = t[kept]
    third = np.flatnonzero(times[2:] == times[:-2])
    return int(kept[third[0] + 2]) if len(third) else None


def differing(t: Array, v: Array) -> Mask:
    """Which points are not the one before them again."""
    again = (t[1:] == t[:-1]) & (v[1:] == v[:-1]).all(axis=1)
    return np.concatenate([[True], ~again])


def _check_time(time: float, table: array[float], row: int) -> None:
    if not table:
        if time != 0.0:
            raise ScenarioError(f"row {row}, column t = {time!r}: the first time has to be 0 s")
    elif time < (1.0 - ROUNDING) * table[-len(COLUMNS)]:
        raise ScenarioError(
            f"row {row}, column t = {time!r}: allowed is {table[-len(COLUMNS)]!r} s, "
            "the time of the row before, or later"
        )
