"""A run's summary for a reader."""

from __future__ import annotations

import math
from typing import Any

# SI unit, and what a reader of micro-robots would rather see: factor and unit.
_UNITS = {
    "mean_velocity": ("m/s", 1e3, "mm/s"),
    "theta_min": ("rad", math.degrees(1.0), "degrees"),
    "theta_max": ("rad", math.degrees(1.0), "degrees"),
    "slip_up": ("m/s", 1e3, "mm/s, mean slip speed while theta rises"),
    "slip_down": ("m/s", 1e3, "mm/s, mean slip speed while theta falls"),
    "slip_flat": ("m/s", 1e3, "mm/s, mean slip speed on a face"),
    "airborne_fraction": ("", 100.0, "%"),
    "simulated_time": ("s", 1.0, ""),
}


def summary_table(summary: dict[str, Any]) -> str:
    """Names, SI values and handier units in columns."""
    measured = "nothing"
    if math.isfinite(summary["mean_velocity"]):
        measured = f"over {summary['window_start']:.6g} to {summary['window_end']:.6g} s"
    rows = [("status", summary["status"], "")]
    for name, (unit, factor, handy) in _UNITS.items():
        value = summary[name] + 0.0  # no negative zero
        other = f"{value * factor:.5g} {handy}" if handy else ""
        rows.append((name, f"{value:.6g} {unit}", other))
    rows.append(("measured", measured, ""))
    counts = {**summary["events"], "painleve": summary["painleve_events"]}
    met = ", ".join(f"{name} {count}" for name, count in counts.items() if count)
    rows.append(("events", met or "none", ""))
    rows += [("note", note, "") for note in summary["notes"]]
    return "\n".join(f"{name:<19}{value:<22}{other}".rstrip() for name, value, other in rows)
