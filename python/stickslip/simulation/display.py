"""How a run is shown: one line, and in a notebook its summary."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

from stickslip._util.text import printable
from stickslip._util.units import handy
from stickslip.simulation.note import shown_lines
from stickslip.simulation.quantities import NUMBERS
from stickslip.simulation.seen_from_drive import FROM_AXES, FROM_DRIVE, IN_ONE_PLANE, VELOCITIES

if TYPE_CHECKING:
    from stickslip.simulation.run import Run


def headline(run: Run) -> str:
    """Status, mean velocities in mm/s and number of samples, in one line."""
    words = IN_ONE_PLANE
    if run.scenario.whole_plane:
        words = FROM_AXES if run.scenario.drive.mode == "program" else FROM_DRIVE
    # Along x there is one, which `Run.velocity` sees from the drive.
    velocities = run.velocity if run.scenario.whole_plane else (run.mean_velocity,)
    factor, unit = handy("m/s")
    velocity = ", ".join(
        f"{value * factor:.6g} {unit} {direction}".rstrip()
        for direction, value in zip(words.values(), velocities, strict=True)
    )
    samples = f"{run.samples} samples" if run.recorded else "no record"
    return f"{run.status}, {velocity}, {samples}"


def run_html(run: Run) -> str:
    """The headline and notes of a run, and with pandas a table of its numbers."""
    summary = run.summary()
    lines = [headline(run), *([] if run.ok else [run.message]), *shown_lines(run.notes)]
    texts = "".join(f"<p>{escape(printable(line))}</p>\n" for line in lines)
    try:
        import pandas as pd
    except ModuleNotFoundError:
        return texts
    rows = [
        (name, f"{summary[name]:.6g}", "" if unit == "1" else unit, meaning)
        for name, (unit, meaning) in {**VELOCITIES, **NUMBERS}.items()
        if math.isfinite(summary.get(name, math.nan))
    ]
    events = ", ".join(f"{count} {kind}" for kind, count in summary["events"].items() if count)
    rows.append(("events", events or "none", "", ""))
    table = pd.DataFrame(rows, columns=["", "value", "unit", "is"])
    return texts + str(table.to_html(index=False, border=0))
