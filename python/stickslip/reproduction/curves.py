"""The paper's Figs. 8 to 15: mean velocity over one quantity, as a band over small changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.reproduction.points import Array, evaluate_all, varied
from stickslip.reproduction.scans import SCANS, Scan
from stickslip.reproduction.settings import Mode, Setting
from stickslip.reproduction.tables import Table
from stickslip.scenario.keys import known_keys

if TYPE_CHECKING:
    from stickslip.simulation.simulate import Progress

LOW, HIGH = 10.0, 90.0
"""Percentiles of the band."""


@dataclass(frozen=True)
class Curves:
    """One figure of velocities.

    Attributes
    ----------
    modes : tuple of {"IPP", "OPP"}
    scans : dict
        Scan by the word for what it varies; the first is that of the figure.
    values : tuple of float
        Where it is evaluated, SI.
    log : bool
        Whether the values are spread evenly in their logarithm.
    caption : str
    """

    modes: tuple[Mode, ...]
    scans: Mapping[str, Scan]
    values: tuple[float, ...]
    log: bool
    caption: str

    @property
    def scan(self) -> Scan:
        """The scan of the figure."""
        return next(iter(self.scans.values()))

    @property
    def column(self) -> str:
        """Name of the column that holds what is varied."""
        return self.scan.key.rpartition(".")[2]


def _even(start: float, stop: float, count: int) -> tuple[float, ...]:
    return tuple(np.linspace(start, stop, count).tolist())


def _even_log(start: float, stop: float, count: int) -> tuple[float, ...]:
    return tuple(np.geomspace(start, stop, count).tolist())


_BOTH: tuple[Mode, ...] = ("IPP", "OPP")
_FIELDS = {"peak alone": SCANS["field"], "all fields in proportion": SCANS["fields"]}

CURVES: dict[str, Curves] = {
    "fig8": Curves(
        _BOTH,
        {"friction": SCANS["friction"]},
        _even(0.02, 2.4, 35),
        False,
        "Velocity over static friction at 100 Hz and 2.5 mT; kinetic friction is 0.7 of it.",
    ),
    "fig9": Curves(
        _BOTH,
        {"adhesion": SCANS["adhesion"]},
        _even(0.0, 0.8e-6, 33),
        False,
        "Velocity over adhesion at 100 Hz and 2.5 mT.",
    ),
    "fig10": Curves(
        _BOTH,
        {"linear drag": SCANS["linear"]},
        _even_log(1e-8, 1e-2, 31),
        True,
        "Velocity over the linear drag coefficient at 100 Hz and 2.5 mT.",
    ),
    "fig11": Curves(
        _BOTH,
        {"rotational drag": SCANS["rotational"]},
        _even_log(1e-18, 1e-12, 31),
        True,
        "Velocity over the rotational drag coefficient at 100 Hz and 2.5 mT.",
    ),
    "fig12": Curves(
        ("IPP",),
        {"frequency": SCANS["frequency"]},
        _even(5.0, 150.0, 30),
        False,
        "IPP: velocity over frequency at 2.5 mT.",
    ),
    "fig13": Curves(
        ("OPP",),
        {"frequency": SCANS["frequency"]},
        _even(5.0, 150.0, 30),
        False,
        "OPP: velocity over frequency at 2.5 mT.",
    ),
    "fig14": Curves(
        ("IPP",),
        _FIELDS,
        _even(1.5e-3, 6.5e-3, 26),
        False,
        "IPP: velocity over the sawtooth's top at 30 Hz, alone and with base and hold in "
        "proportion.",
    ),
    "fig15": Curves(
        ("OPP",),
        _FIELDS,
        _even(1.5e-3, 6.5e-3, 26),
        False,
        "OPP: velocity over the sawtooth's top at 30 Hz, alone and with base and hold in "
        "proportion.",
    ),
}
"""The figures of velocities by name."""


def curve_tables(
    names: Sequence[str],
    reference: Mapping[Mode, Setting],
    count: int,
    threads: int,
    progress: Progress | None = None,
) -> dict[str, Table]:
    """The data of some figures.

    Parameters
    ----------
    names : sequence of str
        Keys of `CURVES`.
    reference : mapping
        The setting of each mode.
    count : int
        Small changes for each point.
    threads : int
    progress : callable, optional
        Called with the fraction that is done.

    Returns
    -------
    dict of Table
        Columns: what is varied, `mode`, `varied` (words), `velocity` (m/s, without changes),
        `velocity_p10`, `velocity_median`, `velocity_p90` (m/s, over the small changes),
        `painleve_events` and `failed` (counts, over all changes).
    """
    lines = [
        (name, mode, word, scan)
        for name in names
        for mode in CURVES[name].modes
        for word, scan in CURVES[name].scans.items()
    ]
    if not lines:
        return {}
    batches = [
        varied(scan.points([reference[mode]], CURVES[name].values)[0], count)
        for name, mode, _, scan in lines
    ]
    results = evaluate_all(batches, threads, progress)
    return {
        name: _table(
            CURVES[name],
            [
                (mode, word, result)
                for (of, mode, word, _), result in zip(lines, results, strict=True)
                if of == name
            ],
        )
        for name in names
    }


def _table(curves: Curves, lines: Sequence[tuple[Mode, str, dict[str, Any]]]) -> Table:
    columns: dict[str, list[Any]] = {
        curves.column: [], "mode": [], "varied": [], "velocity": [], "velocity_p10": [],
        "velocity_median": [], "velocity_p90": [], "painleve_events": [], "failed": [],
    }  # fmt: skip
    for mode, word, result in lines:
        velocity: Array = result["mean_velocity"]
        low, median, high = np.nanpercentile(velocity, [LOW, 50.0, HIGH], axis=1)
        rows = len(curves.values)
        columns[curves.column] += curves.values
        columns["mode"] += [mode] * rows
        columns["varied"] += [word] * rows
        columns["velocity"] += velocity[:, 0].tolist()
        columns["velocity_p10"] += low.tolist()
        columns["velocity_median"] += median.tolist()
        columns["velocity_p90"] += high.tolist()
        columns["painleve_events"] += result["painleve"].sum(axis=1).tolist()
        columns["failed"] += (result["status"] != 0).sum(axis=1).tolist()
    units = dict.fromkeys(columns, "m/s")
    unit = known_keys()[curves.scan.key].unit
    units |= {curves.column: "1" if unit == "-" else unit, "mode": "", "varied": ""}
    units |= {"painleve_events": "1", "failed": "1"}
    return Table(columns, units)
