"""Points that a reader has digitised from the paper's plots; its text holds none of them."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from stickslip.errors import ScenarioError
from stickslip.keys import known_keys, shown
from stickslip.reproduction.curves import CURVES

COLUMNS = ("figure", "mode", "x", "y")

_MOST_BYTES = 1 << 20
_FASTEST = 1.0  # m/s; a velocity in mm/s is well above


@dataclass(frozen=True)
class MeasuredPoint:
    """One point: its figure and mode, x in the SI unit of the figure's key, y in m/s."""

    figure: str
    mode: str
    x: float
    y: float


def read_measured(path: str | PathLike[str]) -> list[MeasuredPoint]:
    """Read a CSV file with the columns figure, mode, x and y, in any order.

    Raises
    ------
    ScenarioError
        If the file cannot be read, lacks a column, or a row has a value that is not allowed.
    """
    path = Path(path)
    try:
        return _points(_rows(path))
    except ScenarioError as error:
        raise ScenarioError(f"{path}: {error}") from None


def _rows(path: Path) -> list[dict[str, str]]:
    try:
        with path.open("rb") as file:
            data = file.read(_MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ScenarioError(f"cannot be read: {reason}") from None
    if len(data) > _MOST_BYTES:
        raise ScenarioError(f"is longer than {_MOST_BYTES} bytes, so it is no file of points")
    try:
        lines = data.decode("utf-8-sig").splitlines()
        table = list(csv.reader(lines, strict=True))
    except UnicodeDecodeError as error:
        raise ScenarioError(f"is no text: byte {error.start + 1} is not UTF-8") from None
    except csv.Error as error:
        raise ScenarioError(f"is not valid CSV: {error}") from None
    if not table:
        raise ScenarioError(f"is empty; its first line is {','.join(COLUMNS)}")
    names = [name.strip() for name in table[0]]
    for name in COLUMNS:
        if names.count(name) != 1:
            raise ScenarioError(
                f"line 1: the column {name} must be there once; needed are {', '.join(COLUMNS)}"
            )
    rows = []
    for number, cells in enumerate(table[1:], start=2):
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(names):
            raise ScenarioError(f"line {number}: {len(cells)} cells: allowed are {len(names)}")
        rows.append({"line": str(number), **dict(zip(names, map(str.strip, cells), strict=True))})
    if not rows:
        raise ScenarioError("holds no point")
    return rows


def _points(rows: list[dict[str, str]]) -> list[MeasuredPoint]:
    return [_point(row) for row in rows]


def _point(row: dict[str, str]) -> MeasuredPoint:
    where = f"line {row['line']}"
    figure = row["figure"]
    if figure not in CURVES:
        raise ScenarioError(
            f"{where}: figure = {shown(figure)}: allowed is one of {', '.join(CURVES)}"
        )
    modes = CURVES[figure].modes
    if row["mode"] not in modes:
        raise ScenarioError(
            f"{where}: mode = {shown(row['mode'])}: allowed in {figure} is {' or '.join(modes)}"
        )
    key = known_keys()[CURVES[figure].scan.key]
    x = _number(where, "x", row["x"], key.low, key.high, f"{key.name}, {key.allowed}")
    y = _number(where, "y", row["y"], -_FASTEST, _FASTEST, "a velocity in m/s from -1 to 1")
    return MeasuredPoint(figure, row["mode"], x, y)


def _number(where: str, name: str, text: str, low: float, high: float, allowed: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise ScenarioError(f"{where}: {name} = {shown(text)}: allowed is {allowed}")
    return value
