"""A run as a CSV file."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from os import PathLike
from typing import Any

from stickslip._util.atomic_files import replacing
from stickslip.simulation.coils import COIL_NAMES
from stickslip.simulation.run import COLUMNS, Run

_ROWS_AT_A_TIME = 10_000


def write_csv(run: Run, path: str | PathLike[str]) -> None:
    """See `Run.to_csv`."""
    headings, columns = _columns(run)
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(headings)
        for start in range(0, len(run.t), _ROWS_AT_A_TIME):
            part = slice(start, start + _ROWS_AT_A_TIME)
            writer.writerows(zip(*(_cells(*column, part) for column in columns), strict=True))


def _columns(run: Run) -> tuple[list[str], list[tuple[Any, tuple[str, ...] | None]]]:
    """Headings, and for each its array with the words that its numbers stand for, if any."""
    headings: list[str] = []
    columns: list[tuple[Any, tuple[str, ...] | None]] = []
    for name, column in COLUMNS.items():
        if name == "event" and run.scenario.record.rate != "events":
            continue
        values = getattr(run, name)
        if name == "current":
            headings += [f"current {coil} ({column.unit})" for coil in COIL_NAMES]
            columns += [(values[:, k], None) for k in range(len(COIL_NAMES))]
        elif name in ("contact", "event"):
            headings.append(name)
            columns.append((values, run.contact_names if name == "contact" else run.event_names))
        else:
            headings.append(f"{name} ({column.unit})")
            columns.append((values, None))
    return headings, columns


def _cells(values: Any, words: tuple[str, ...] | None, part: slice) -> Iterator[object]:
    """Cells of one column; what is not a number, such as a contact in flight, is empty."""
    chosen = values[part].tolist()
    if words is not None:
        return (words[code] for code in chosen)
    return ("" if math.isnan(value) else value for value in chosen)
