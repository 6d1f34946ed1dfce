"""Points that a reader has digitised from the paper's plots; its text holds none of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from stickslip.errors import ScenarioError
from stickslip.measurement.tables import check_columns, read_rows
from stickslip.reproduction.curves import CURVES
from stickslip.scenario.keys import known_keys, shown

COLUMNS = ("figure", "mode", "x", "y")

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
    header, rows = read_rows(path)
    check_columns(path, header, COLUMNS)
    points = []
    for line, cells in rows:
        where = f"{path}: line {line}"
        if len(cells) != len(header):
            raise ScenarioError(f"{where}: {len(cells)} cells; allowed are {len(header)}")
        points.append(_point(where, dict(zip(header, cells, strict=True))))
    return points


def _point(where: str, row: dict[str, str]) -> MeasuredPoint:
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
