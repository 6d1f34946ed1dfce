"""The large figure of a report: what was measured less what the recalibrated model gives.

It is drawn over the condition on which the cause's change depends most, with that change through
it; each panel has axes of its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.data.conditions import (
    Conditions,
    heading,
    in_words,
    panel,
    shown_unit,
    sorted_by_settings,
    varied,
)
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.observables import Comparison
from stickslip.diagnosis.observables.tracking.film import FilmComparison
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.chart import MARKERS, Line, Panel, Point, said
from stickslip.diagnosis.report.film_figure import traces
from stickslip.scenario.keys import Value, known_keys

Array = NDArray[np.float64]

_PLACES = ("drive.mode", "drive.direction")  # which have a panel each
_SAMPLES = 90  # points of a film's trace; chosen: they can be told apart


@dataclass(frozen=True)
class LargeFigure:
    """Panels with what a reader has to know of them.

    Attributes
    ----------
    title : str
    panels : tuple of Panel
    curve : str
        What the curve is; empty without one.
    measured : str
        What the points are.
    kinds : tuple of str
        Settings that each marker stands for, in the order of `MARKERS`; one or none needs no word.
    held_out : bool
        Whether some points are hollow.
    """

    title: str
    panels: tuple[Panel, ...]
    curve: str
    measured: str
    kinds: tuple[str, ...]
    held_out: bool


@dataclass(frozen=True)
class Rows:
    """Readings beside the recalibrated model, in the unit that is drawn; shape (m,) each.

    `change` is what the claimed cause adds to the recalibrated model, where there is one, and
    `base` what is drawn as zero: the recalibrated model, or nothing where none was fitted.
    """

    observed: Array
    base: Array
    change: Array | None
    sd: Array | None
    held_out: NDArray[np.bool_]

    def point(self, k: int, x: float, where: str, unit: str, marker: int = 0) -> Point:
        """Reading k at `x`."""
        value = float(self.observed[k] - self.base[k])
        sd = None if self.sd is None else float(self.sd[k])
        parts = [where, f"measured {said(self.observed[k])} {unit}".rstrip()]
        if sd is not None:
            parts[-1] += f" (sd {said(sd)})"
        if np.any(self.base):
            parts.append(f"recalibrated {said(self.base[k])}")
        if self.change is not None:
            parts.append(f"with the cause {said(self.base[k] + self.change[k])}")
        parts += ["held out"] if self.held_out[k] else []
        return Point(x, value, sd, "; ".join(parts), bool(self.held_out[k]), marker)


def claimed_change(found: Findings) -> tuple[Array | None, str]:
    """What the extended model adds at all observables, SI units, and what to call it."""
    problem, fit = found.problem, found.verdict.fit
    null = problem.predicted(found.null.x[None, :])[0]
    if fit is not None:
        return problem.predicted(fit.x[None, :])[0] - null, f"with {fit.name}"
    shape, tried = found.free_shape, found.open_set
    if shape is not None and tried is not None:
        changed = tried.problem.predicted(shape.fit.x[None, :])[0]
        return changed - null, f"with the curve of {shape.hook.name}"
    return None, ""


def large_figure(
    found: Findings, posed: PosedProblem, comparisons: Sequence[Comparison | FilmComparison]
) -> LargeFigure | None:
    """The figure of the data in which the cause improves the fit most, or most misfit is left.

    None where no kind of data can be drawn.
    """
    fall = found.null.residual[: len(found.problem.observed)] ** 2
    if found.verdict.fit is not None:
        fall = fall - found.verdict.fit.residual[: len(fall)] ** 2
    end = len(posed.conditions)
    drawn = [(float(np.sum(fall[:end])), velocity_figure(found, posed))]
    for observable, each in zip(posed.model.observables, comparisons, strict=True):
        start, end = end, end + len(observable.observed)
        film = isinstance(each, FilmComparison)
        figure = film_difference(each) if film else table_figure(each)
        drawn.append((float(np.sum(fall[start:end])), figure))
    there = [(size, figure) for size, figure in drawn if figure is not None]
    return max(there, key=lambda each: each[0])[1] if there else None


def velocity_figure(found: Findings, posed: PosedProblem) -> LargeFigure | None:
    """Mean velocities; None where none was measured."""
    conditions, m = posed.conditions, len(posed.conditions)
    if not m:
        return None
    sd = np.sqrt(np.diag(found.noise.covariance))[:m] * 1e3 if found.noise.dof > 0.0 else None
    observed = found.problem.observed[:m] * 1e3
    if found.verdict.kind == "data-problem":
        none = np.zeros(m)
        rows = Rows(observed, none, posed.given * 1e3, sd, np.zeros(m, dtype=bool))
        name, title = "scenario as given", "Measured velocities"
        ylabel, measured = "mean velocity (mm/s)", "measured"
    else:
        change, name = claimed_change(found)
        null = found.problem.predicted(found.null.x[None, :])[0, :m] * 1e3
        part = None if change is None else change[:m] * 1e3
        rows = Rows(observed, null, part, sd, found.held_out[:m])
        title = "Measured minus recalibrated model"
        ylabel, measured = "difference (mm/s)", "measured minus recalibrated"
    key = abscissa_key(conditions, rows)
    panels, kinds = _velocity_panels(conditions, rows, key, ylabel, name)
    return LargeFigure(
        f"{title}, over {key.split('.')[1]}", panels, name if rows.change is not None else "",
        measured + (" (bars: 2 sd)" if sd is not None else ""), kinds, bool(rows.held_out.any()),
    )  # fmt: skip


def abscissa_key(conditions: Conditions, rows: Rows) -> str:
    """The setting on which the change depends most smoothly; frequency where there is none.

    Von Neumann's ratio: squared differences of neighbours along the setting, within a panel, over
    the variance. Without a change the residuals take its place.
    """
    values = rows.observed - rows.base if rows.change is None else rows.change
    values = np.where(np.isfinite(values), values, 0.0)
    words = np.array([panel(each) for each in conditions])
    ratios = {}
    for key in varied(conditions):
        if known_keys()[key].kind != "real":
            continue
        at = np.array([float(each[key]) for each in conditions])
        if len(set(at.tolist())) < 3:
            continue
        ratios[key] = sum(_roughness(at[words == word], values[words == word])
                          for word in dict.fromkeys(words.tolist()))  # fmt: skip
    return min(ratios, key=lambda key: ratios[key], default="drive.frequency")


def _roughness(at: Array, values: Array) -> float:
    order = np.argsort(at, kind="stable")
    steps = np.diff(values[order])
    # Readings at one place can have any order, so that their differences count as they are.
    return float(np.sum(steps**2) / (np.sum((values - values.mean()) ** 2) + 1e-300))


def _velocity_panels(
    conditions: Conditions, rows: Rows, key: str, ylabel: str, name: str
) -> tuple[tuple[Panel, ...], tuple[str, ...]]:
    """A panel for each mode and direction; other settings are told by markers."""
    words = [panel(each) for each in conditions]
    factor = shown_unit(key)[1]
    at = np.array([float(each[key]) * factor for each in conditions])
    kinds = sorted_by_settings(conditions, (*_PLACES, key), len(MARKERS))
    panels = []
    for word in dict.fromkeys(words):
        points: list[Point] = []
        lines: list[Line] = []
        for number, (label, indices) in enumerate(kinds.items()):
            mine = [k for k in indices if words[k] == word]
            for k in mine:
                where = _condition(conditions[k], k, varied(conditions))
                points.append(rows.point(k, float(at[k]), where, "mm/s", number))
            lines += _curves(at, rows.change, mine, name, label)
        panels.append(Panel(word, heading(key), ylabel, tuple(points), tuple(lines)))
    return tuple(panels), tuple(kinds)


def _condition(condition: Mapping[str, Value], number: int, keys: Sequence[str]) -> str:
    said_of = in_words(condition, keys)
    return f"condition {number + 1}: {said_of}" if said_of else f"condition {number + 1}"


def _curves(
    at: Array, change: Array | None, indices: Sequence[int], name: str, label: str = ""
) -> list[Line]:
    """The change at some places: a curve where it is a function of the place, else dashes."""
    if change is None or not len(indices):
        return []
    order = sorted(indices, key=lambda k: at[k])
    x, y = at[order], change[order]
    spread = float(np.ptp(y[np.isfinite(y)])) if np.isfinite(y).any() else 0.0
    twice = np.diff(x) == 0.0
    joined = bool(np.all(np.abs(np.diff(y)[twice]) <= 1e-6 * spread))
    title = f"{name}, {label}" if label else name
    kind = "given" if name == "scenario as given" else "cause"
    return [Line(x.tolist(), y.tolist(), kind, title, joined)]


def table_figure(found: Comparison) -> LargeFigure:
    """A table of angles over the field that was varied most, or of fields row by row."""
    degrees = found.kind == "angle"
    factor, unit = (math.degrees(1.0), "degrees") if degrees else (1e3, "mT")
    observed = np.atleast_2d(found.observed.T).T * factor
    base = np.atleast_2d(found.recalibrated.T).T * factor
    extended = None if found.extended is None else np.atleast_2d(found.extended.T).T * factor
    sd = found.sd.reshape(observed.shape) * factor
    if degrees:
        fields = {name: found.settings[name] for name in ("Bx", "Bz")}
        most = max(fields, key=lambda name: float(np.ptp(fields[name])))
        at, xlabel, names = fields[most] * 1e3, f"{most} (mT)", ["theta"]
    else:
        at, xlabel, names = np.arange(1.0, len(observed) + 1.0), "row of the table", ["Bx", "By", "Bz"]
    panels = []
    for k, name in enumerate(names):
        change = None if extended is None else extended[:, k] - base[:, k]
        rows = Rows(observed[:, k], base[:, k], change, sd[:, k], found.held_out)
        everywhere = range(len(at))
        points = tuple(
            rows.point(n, float(at[n]), f"{xlabel.split(' (')[0]} {said(at[n])}", unit)
            for n in everywhere
        )
        lines = _curves(at, change, everywhere, "with the cause")
        if not degrees:
            lines = [Line(each.x, each.y, each.kind, each.title, False) for each in lines]
        panels.append(Panel(name, xlabel, f"difference ({unit})", points, tuple(lines)))
    return LargeFigure(
        f"{found.title}: measured minus recalibrated model", tuple(panels),
        "" if extended is None else "with the cause", "measured minus recalibrated (bars: 2 sd)",
        (), bool(found.held_out.any()),
    )  # fmt: skip


def film_difference(found: FilmComparison) -> LargeFigure | None:
    """Tilt and place over the phase of the drive; None where a film shows no phases."""
    if found.view is None:
        return None
    panels = []
    step = max(1, len(found.view.phase) // _SAMPLES)
    phase = found.view.phase
    for each in traces(found.view, found.after):
        change = None if each.extended is None else each.extended - each.recalibrated
        rows = Rows(each.measured, each.recalibrated, change, None,
                    np.full(len(phase), found.held_out))  # fmt: skip
        points = tuple(
            rows.point(k, float(phase[k]), f"phase {phase[k]:.3f}", "")
            for k in range(0, len(phase), step)
        )
        lines = _curves(phase, change, range(len(phase)), "with the cause")
        panels.append(Panel(each.label.split(" (")[0], "phase of the drive",
                            each.label, points, tuple(lines)))  # fmt: skip
    return LargeFigure(
        f"{found.file}: measured minus recalibrated model", tuple(panels),
        "" if found.after is None else "with the cause", "measured (smoothed) minus recalibrated",
        (), found.held_out,
    )  # fmt: skip


def own_figure(found: Findings, place: Array, labels: tuple[str, str]) -> LargeFigure:
    """Data of a model of one's own over their abscissa, shape (m,)."""
    m = len(place)
    known = found.noise.dof > 0.0
    observed, sd = found.problem.observed[:m], found.problem.sd[:m] if known else None
    change, name = (None, "")
    base, title, ylabel = np.zeros(m), "Data", labels[1]
    if found.verdict.kind != "data-problem":
        change, name = claimed_change(found)
        change = None if change is None else change[:m]
        base = found.problem.predicted(found.null.x[None, :])[0, :m]
        title, ylabel = "Data minus recalibrated model", f"difference of {labels[1]}"
    rows = Rows(observed, base, change, sd, found.held_out[:m])
    points = tuple(
        rows.point(k, float(place[k]), f"condition {k + 1}: {labels[0]} {said(place[k])}", "")
        for k in range(m)
    )
    lines = tuple(_curves(place, change, range(m), name))
    return LargeFigure(
        f"{title}, over {labels[0]}", (Panel("", labels[0], ylabel, points, lines),), name,
        "measured" + (" minus recalibrated" if np.any(base) else "")
        + (" (bars: 2 sd)" if known else ""), (), bool(rows.held_out.any()),
    )  # fmt: skip
