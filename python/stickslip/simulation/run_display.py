"""What a notebook shows of a run: its summary, in handy units."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from stickslip._util.html import html_table
from stickslip._util.units import handy
from stickslip.simulation.columns import NUMBERS
from stickslip.simulation.note import shown_lines
from stickslip.simulation.record_blocks import turns
from stickslip.simulation.seen_from_drive import FROM_AXES, FROM_DRIVE, IN_ONE_PLANE

if TYPE_CHECKING:
    from stickslip.simulation.run import Run

_STANDS_OUT = {
    "slip while the tilt rises": "slip_up",
    "slip while the tilt falls": "slip_down",
    "largest field": "field_max",
    "largest current": "current_max",
}


def velocities(run: Run) -> dict[str, float]:
    """The mean velocities that tell the motion, m/s, by words for their direction.

    There are no words in the plane y = 0, in which the velocity is that along x.
    """
    if not turns(run.scenario):
        return {IN_ONE_PLANE["mean_velocity"]: run.mean_velocity}
    words = FROM_AXES if run.scenario.drive.mode == "program" else FROM_DRIVE
    return dict(zip(words.values(), run.velocity, strict=True))


def run_html(run: Run) -> str:
    """A table of what stands out in the summary of a run; what was not measured is left out."""
    summary = run.summary()
    rows = [("status", run.status if run.ok else f"{run.status}: {run.message}")]
    if math.isfinite(run.mean_velocity):
        low, high = (math.degrees(summary[name]) for name in ("theta_min", "theta_max"))
        window = f"{summary['window_start']:.6g} to {summary['window_end']:.6g} s"
        rows += [
            *(
                (f"mean velocity {words}".rstrip(), _shown(value, "m/s"))
                for words, value in velocities(run).items()
            ),
            ("measured", window),
            ("tilt", f"{low:.4g} to {high:.4g} degrees"),
            ("in flight", f"{100.0 * summary['airborne_fraction']:.3g} % of the time"),
        ]
    rows += [
        (words, _shown(summary[name], NUMBERS[name].unit))
        for words, name in _STANDS_OUT.items()
        if math.isfinite(summary[name])
    ]
    if turns(run.scenario):
        end = run.final_state
        rows += [
            ("turning speed", _shown(summary["turning_speed"], "m/s")),
            ("final place", f"x {_shown(end.x, 'm')}, y {_shown(end.y, 'm')}"),
            ("final heading", _shown(end.heading, "rad")),
        ]
    events = {**summary["events"], "painleve": summary["painleve_events"]}
    counted = ", ".join(f"{count} {kind}" for kind, count in events.items() if count)
    rows.append(("events", counted or "none"))
    if run.recorded:
        until = f", to {run.recorded_until:.6g} s" if math.isfinite(run.recorded_until) else ""
        rows.append(("record", f"{run.samples} samples{until}"))
    rows += [("note", line) for line in shown_lines(run.notes)]
    return html_table("Run", rows)


def _shown(value: Any, unit: str) -> str:
    factor, shown = handy(unit)
    return f"{value * factor + 0.0:.4g} {shown}"
