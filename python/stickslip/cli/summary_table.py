"""A run's summary for a reader."""

from __future__ import annotations

import math
from typing import Any

from stickslip._util.handy_units import handy

# SI units of what is shown; "1" for a part of one.
UNITS = {
    "mean_velocity": "m/s",
    "theta_min": "rad",
    "theta_max": "rad",
    "slip_up": "m/s",
    "slip_down": "m/s",
    "slip_flat": "m/s",
    "airborne_fraction": "1",
    "simulated_time": "s",
}
_WORDS = {
    "slip_up": ", mean slip speed while theta rises",
    "slip_down": ", mean slip speed while theta falls",
    "slip_flat": ", mean slip speed on a face",
}


def shown_in(name: str) -> tuple[float, str]:
    """Factor and unit in which a number of a summary is shown beside its SI unit."""
    return (100.0, "%") if UNITS[name] == "1" else handy(UNITS[name])


def summary_table(summary: dict[str, Any]) -> str:
    """Names, SI values and handier units in columns."""
    measured = "nothing"
    if math.isfinite(summary["mean_velocity"]):
        measured = f"over {summary['window_start']:.6g} to {summary['window_end']:.6g} s"
    rows = [("status", summary["status"], "")]
    for name, unit in UNITS.items():
        value = summary[name] + 0.0  # no negative zero
        factor, other = shown_in(name)
        handier = f"{value * factor:.5g} {other}{_WORDS.get(name, '')}" if other != unit else ""
        rows.append((name, f"{value:.6g} {unit}".removesuffix(" 1"), handier))
    rows.append(("measured", measured, ""))
    counts = {**summary["events"], "painleve": summary["painleve_events"]}
    met = ", ".join(f"{name} {count}" for name, count in counts.items() if count)
    rows.append(("events", met or "none", ""))
    rows += [("note", note, "") for note in summary["notes"]]
    return "\n".join(f"{name:<19}{value:<22}{other}".rstrip() for name, value, other in rows)
