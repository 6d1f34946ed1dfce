"""The paper's Figs. 8 to 15: mean velocity over one quantity, as a band over small changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from stickslip.reproduction.points import SCANS, Array, Scan, evaluate, varied
from stickslip.reproduction.settings import MODES, Mode, Setting
from stickslip.reproduction.tables import table
from stickslip.scenario.keys import known_keys

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

LOW, HIGH = 10.0, 90.0
"""Percentiles of the band: a choice of this study, which its page names."""


@dataclass(frozen=True)
class Curves:
    """One figure of velocities."""

    modes: tuple[Mode, ...]
    scans: tuple[Scan, ...]  # the first is that of the figure
    values: Array  # where it is evaluated, SI
    caption: str
    log: bool = False  # whether the values are spread evenly in their logarithm

    @property
    def scan(self) -> Scan:
        """The scan of the figure."""
        return self.scans[0]

    @property
    def column(self) -> str:
        """Name of the column that holds what is varied."""
        return self.scan.key.rpartition(".")[2]


_FREQUENCY = ((SCANS["frequency"],), np.linspace(5.0, 150.0, 30))
_FIELDS = ((SCANS["field"], SCANS["fields"]), np.linspace(1.5e-3, 6.5e-3, 26))
_OVER_FIELDS = (
    "velocity over the sawtooth's top at 30 Hz, alone and with base and hold in proportion."
)

# Values span the axes of the paper's figures.
CURVES: dict[str, Curves] = {
    "fig8": Curves(
        MODES,
        (SCANS["friction"],),
        np.linspace(0.02, 2.4, 35),
        "Velocity over static friction at 100 Hz and 2.5 mT; kinetic friction is 0.7 of it.",
    ),
    "fig9": Curves(
        MODES,
        (SCANS["adhesion"],),
        np.linspace(0.0, 0.8e-6, 33),
        "Velocity over adhesion at 100 Hz and 2.5 mT.",
    ),
    "fig10": Curves(
        MODES,
        (SCANS["linear"],),
        np.geomspace(1e-8, 1e-2, 31),
        "Velocity over the linear drag coefficient at 100 Hz and 2.5 mT.",
        log=True,
    ),
    "fig11": Curves(
        MODES,
        (SCANS["rotational"],),
        np.geomspace(1e-18, 1e-12, 31),
        "Velocity over the rotational drag coefficient at 100 Hz and 2.5 mT.",
        log=True,
    ),
    "fig12": Curves(("IPP",), *_FREQUENCY, "IPP: velocity over frequency at 2.5 mT."),
    "fig13": Curves(("OPP",), *_FREQUENCY, "OPP: velocity over frequency at 2.5 mT."),
    "fig14": Curves(("IPP",), *_FIELDS, f"IPP: {_OVER_FIELDS}"),
    "fig15": Curves(("OPP",), *_FIELDS, f"OPP: {_OVER_FIELDS}"),
}
"""The figures of velocities by name."""


def curve_tables(
    names: Sequence[str],
    reference: Mapping[Mode, Setting],
    count: int,
    threads: int,
    progress: Progress | None = None,
) -> dict[str, pd.DataFrame]:
    """The data of some figures, keys of `CURVES`, with `count` small changes for each point.

    Columns are what is varied, `mode`, `varied` (words), `velocity` (m/s, without changes),
    `velocity_p10`, `velocity_median`, `velocity_p90` (m/s, over the small changes),
    `painleve_events` and `failed` (counts, over all changes).
    """
    lines = [
        (name, mode, scan)
        for name in names
        for mode in CURVES[name].modes
        for scan in CURVES[name].scans
    ]
    if not lines:
        return {}
    batches = [
        varied(scan.points([reference[mode]], CURVES[name].values)[0], count)
        for name, mode, scan in lines
    ]
    parts: dict[str, list[pd.DataFrame]] = {name: [] for name in names}
    for (name, mode, scan), result in zip(lines, evaluate(batches, threads, progress), strict=True):
        curves, velocity = CURVES[name], result["mean_velocity"]
        low, median, high = np.nanpercentile(velocity, [LOW, 50.0, HIGH], axis=1)
        columns = {
            curves.column: curves.values,
            "mode": mode,
            "varied": scan.words,
            "velocity": velocity[:, 0],
            "velocity_p10": low,
            "velocity_median": median,
            "velocity_p90": high,
            "painleve_events": result["painleve"].sum(axis=1),
            "failed": (result["status"] != 0).sum(axis=1),
        }
        parts[name].append(pd.DataFrame(columns))
    return {
        name: table(pd.concat(each, ignore_index=True), _units(CURVES[name]))
        for name, each in parts.items()
    }


def _units(curves: Curves) -> dict[str, str]:
    unit = known_keys()[curves.scan.key].unit
    speeds = ("velocity", "velocity_p10", "velocity_median", "velocity_p90")
    return {
        curves.column: "1" if unit == "-" else unit,
        **dict.fromkeys(("mode", "varied"), ""),
        **dict.fromkeys(speeds, "m/s"),
        **dict.fromkeys(("painleve_events", "failed"), "1"),
    }
