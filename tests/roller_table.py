"""The velocities of rollers as their case has them: a row a bin of 6 Hz, a column a run.

python tests/roller_table.py tests/data/roller_velocity.csv
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from statistics import median

WIDTH = 3
"""Readings of a bin; they are 2 Hz apart."""


def table(path: Path) -> str:
    """Median velocity of each run and bin, m/s; a cell is empty where a bin is not full."""
    with path.open() as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    runs = sorted({row["run"] for row in rows})
    paces = sorted({row["frequency"] for row in rows})
    lines = [",".join(["frequency", *(f"run{run:.0f}" for run in runs)])]
    for at in range(0, len(paces) - WIDTH + 1, WIDTH):
        inside = paces[at : at + WIDTH]
        cells = [f"{inside[WIDTH // 2]:g}"]
        for run in runs:
            found = [r["velocity"] for r in rows if r["run"] == run and r["frequency"] in inside]
            cells.append(f"{median(found):.3e}" if len(found) == WIDTH else "")
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(table(Path(sys.argv[1])), end="")
