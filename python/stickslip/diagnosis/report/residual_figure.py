"""The large figure of a report: what was measured less what the recalibrated model gives.

It is drawn over the condition on which the cause's change depends most, with that change through
it; each panel has axes of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.observables import Comparison
from stickslip.diagnosis.observables.tracking.film import FilmComparison
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.chart import Panel, said
from stickslip.diagnosis.report.differences import (
    Array,
    LargeFigure,
    Rows,
    added,
    claimed_change,
    curves,
    held_out,
)
from stickslip.diagnosis.report.film_figure import traces
from stickslip.diagnosis.report.velocity_difference import velocity_figure

_SAMPLES = 90  # points of a film's trace; chosen: they can be told apart


def large_figure(
    found: Findings, posed: PosedProblem, comparisons: Sequence[Comparison | FilmComparison]
) -> LargeFigure | None:
    """The figure of the data in which the cause improves the fit most, or most misfit is left.

    None where no kind of data can be drawn.
    """
    fall = found.null.residual[: len(found.problem.observed)] ** 2
    if found.extended is not None:
        fall = fall - found.extended[1].residual[: len(fall)] ** 2
    end = len(posed.conditions)
    drawn = [(float(np.sum(fall[:end])), velocity_figure(found, posed))]
    for observable, each in zip(posed.model.observables, comparisons, strict=True):
        start, end = end, end + len(observable.observed)
        if isinstance(each, FilmComparison):
            drawn.append((float(np.sum(fall[start:end])), film_difference(each, added(found))))
        else:
            drawn.append((float(np.sum(fall[start:end])), table_figure(each, added(found))))
    there = [(size, figure) for size, figure in drawn if figure is not None]
    return max(there, key=lambda each: each[0])[1] if there else None


def table_figure(found: Comparison, name: str) -> LargeFigure:
    """A table of angles over the field that was varied most, or of fields row by row.

    `name` says what the extended model has.
    """
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
        at, xlabel, names = (
            np.arange(1.0, len(observed) + 1.0),
            "row of the table",
            ["Bx", "By", "Bz"],
        )
    panels = []
    for k, part in enumerate(names):
        change = None if extended is None else extended[:, k] - base[:, k]
        rows = Rows(observed[:, k], base[:, k], change, sd[:, k], found.held_out, name)
        everywhere = range(len(at))
        points = tuple(
            rows.point(n, float(at[n]), f"{xlabel.split(' (')[0]} {said(at[n])}", unit)
            for n in everywhere
        )
        lines = curves(at, change, everywhere, name)
        if not degrees:
            lines = [replace(each, joined=False) for each in lines]
        panels.append(Panel(part, xlabel, f"difference ({unit})", points, tuple(lines)))
    return LargeFigure(
        f"{found.title}: measured minus recalibrated model", tuple(panels),
        "" if extended is None else name, "measured minus recalibrated (bars: 2 sd)",
        (), bool(found.held_out.any()),
    )  # fmt: skip


def film_difference(found: FilmComparison, name: str) -> LargeFigure | None:
    """Tilt and place over the phase of the drive; None where a film shows no phases."""
    if found.recalibrated is None:
        return None
    panels = []
    phase = found.recalibrated.phase
    step = max(1, len(phase) // _SAMPLES)
    for each in traces(found.recalibrated, found.extended):
        change = None if each.extended is None else each.extended - each.recalibrated
        rows = Rows(each.measured, each.recalibrated, change, None,
                    np.full(len(phase), found.held_out), name)  # fmt: skip
        points = tuple(
            rows.point(k, float(phase[k]), f"phase {phase[k]:.3f}", "")
            for k in range(0, len(phase), step)
        )
        lines = curves(phase, change, range(len(phase)), name)
        panels.append(Panel(each.label.split(" (")[0], "phase of the drive",
                            f"difference of {each.label}", points, tuple(lines)))  # fmt: skip
    return LargeFigure(
        f"{found.file}: measured minus recalibrated model", tuple(panels),
        "" if found.extended is None else name, "measured (smoothed) minus recalibrated",
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
        change, name = claimed_change(found, m)
        base = found.problem.predicted(found.null.x[None, :])[0, :m]
        title, ylabel = "Data minus recalibrated model", f"difference of {labels[1]}"
    rows = Rows(observed, base, change, sd, held_out(found, m), added(found))
    points = tuple(
        rows.point(k, float(place[k]), f"condition {k + 1}: {labels[0]} {said(place[k])}", "")
        for k in range(m)
    )
    lines = tuple(curves(place, change, range(m), name))
    levels = (0.0,) if np.any(base) else ()
    return LargeFigure(
        f"{title}, over {labels[0]}", (Panel("", labels[0], ylabel, points, lines, levels),), name,
        "measured" + (" minus recalibrated" if np.any(base) else "")
        + (" (bars: 2 sd)" if known else ""), (), bool(rows.held_out.any()),
    )  # fmt: skip
