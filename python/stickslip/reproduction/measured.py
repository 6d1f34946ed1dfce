"""Points that a reader has digitised from the paper's plots; its text holds none of them."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import NamedTuple

from stickslip.errors import ScenarioError
from stickslip.measurement.tables import check_columns, number, read_rows
from stickslip.reproduction.curves import CURVES
from stickslip.scenario.keys import known_keys, shown

COLUMNS = ("figure", "mode", "x", "y")

_MAX_VELOCITY = 1.0  # m/s; far above any robot's, and a velocity that is given in mm/s is above it


class MeasuredPoint(NamedTuple):
    """One point: its figure and mode, x in the SI unit of the figure's key, y in m/s."""

    figure: str
    mode: str
    x: float
    y: float


def read_measured(path: str | PathLike[str]) -> list[MeasuredPoint]:
    """Read a CSV file with the columns figure, mode, x and y, in any order."""
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
    figure, mode = row["figure"], row["mode"]

    def refuse_unless(allowed: bool, name: str, what: str) -> None:
        if not allowed:
            raise ScenarioError(f"{where}: {name} = {shown(row[name])}: allowed {what}")

    refuse_unless(figure in CURVES, "figure", f"is one of {', '.join(CURVES)}")
    modes = CURVES[figure].modes
    refuse_unless(mode in modes, "mode", f"in {figure} is {' or '.join(modes)}")
    key = known_keys()[CURVES[figure].scan.key]
    x, y = number(row["x"]), number(row["y"])
    refuse_unless(key.low <= x <= key.high, "x", f"is {key.name}, {key.allowed}")
    refuse_unless(abs(y) <= _MAX_VELOCITY, "y", "is a velocity in m/s from -1 to 1")
    return MeasuredPoint(figure, mode, x, y)
