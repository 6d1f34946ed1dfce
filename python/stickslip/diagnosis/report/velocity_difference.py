"""The large figure of velocities: over the setting on which the change by a cause depends most."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from stickslip.diagnosis.data.conditions import (
    Conditions,
    heading,
    in_words,
    panel,
    shown_unit,
    varied,
)
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.chart import Line, Panel, Point
from stickslip.diagnosis.report.differences import (
    GIVEN,
    Array,
    LargeFigure,
    Rows,
    added,
    claimed_change,
    curves,
    held_out,
)
from stickslip.diagnosis.report.figures import PLACES, kinds_of
from stickslip.scenario.keys import Value, known_keys

_PILE = 0.5  # share of readings at one value; chosen: a setting that was left as it was has more
_BETWEEN = 41  # points of a curve; chosen: its bends are seen, and a figure takes a second


def velocity_figure(found: Findings, posed: PosedProblem) -> LargeFigure | None:
    """Mean velocities; None where none was measured."""
    conditions, m = posed.conditions, len(posed.conditions)
    if not m:
        return None
    sd = np.sqrt(np.diag(found.noise.covariance))[:m] * 1e3 if found.noise.dof > 0.0 else None
    observed = found.problem.observed[:m] * 1e3
    if found.verdict.kind == "data-problem":
        none = np.zeros(m)
        rows = Rows(observed, none, posed.given * 1e3, sd, np.zeros(m, dtype=bool), GIVEN)
        name, title = GIVEN, "Measured velocities"
        ylabel, measured = "mean velocity (mm/s)", "measured"
    else:
        change, name = claimed_change(found, m)
        null = found.problem.predicted(found.null.x[None, :])[0, :m] * 1e3
        part = None if change is None else change * 1e3
        rows = Rows(observed, null, part, sd, held_out(found, m), added(found))
        title = "Measured minus recalibrated model"
        ylabel, measured = "difference (mm/s)", "measured minus recalibrated"
    key = abscissa_key(conditions, rows)
    panels, kinds = _velocity_panels(found, posed, rows, key, (ylabel, name))
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
        # Where most have the same value, the others would be drawn beside a pile.
        counts = Counter(at.tolist())
        if len(counts) < 3 or counts.most_common(1)[0][1] > _PILE * len(at):
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
    found: Findings, posed: PosedProblem, rows: Rows, key: str, labels: tuple[str, str]
) -> tuple[tuple[Panel, ...], tuple[str, ...]]:
    """A panel for each mode and direction; other settings are told by markers.

    `labels` are that of the ordinate and the name of the curve.
    """
    conditions, (ylabel, name) = posed.conditions, labels
    words = [panel(each) for each in conditions]
    at = np.array([float(each[key]) for each in conditions]) * shown_unit(key)[1]
    kinds = kinds_of(conditions, key)
    levels = (0.0,) if np.any(rows.base) else ()
    panels = []
    for word in dict.fromkeys(words):
        points: list[Point] = []
        lines: list[Line] = []
        for number, (label, indices) in enumerate(kinds.items()):
            mine = [k for k in indices if words[k] == word]
            for k in mine:
                where = _condition(conditions[k], k, varied(conditions))
                points.append(rows.point(k, float(at[k]), where, "mm/s", number))
            drawn = curves(at, rows.change, mine, name, label)
            if not _alike([conditions[k] for k in mine], (*PLACES, key)):
                # Between readings of different settings there is no curve and no drive to simulate.
                drawn = [replace(each, joined=False) for each in drawn]
            finer = [_finer(found, posed, key, mine, each) for each in drawn]
            lines += [replace(each, series=number) for each in finer]
        panels.append(Panel(word, heading(key), ylabel, tuple(points), tuple(lines), levels))
    return tuple(panels), tuple(kinds)


def _alike(conditions: Conditions, shown: Sequence[str]) -> bool:
    """Whether conditions differ only in the settings that `shown` holds.

    Those of one kind do not where `sorted_by_settings` has merged all but the commonest kind.
    """
    return all(key in shown for key in varied(conditions))


def _finer(
    found: Findings, posed: PosedProblem, key: str, indices: Sequence[int], line: Line
) -> Line:
    """The curve between the readings too, by simulations of both models."""
    ends = [float(posed.conditions[k][key]) for k in indices]
    if found.extended is None or not line.joined or len(set(ends)) < 2:
        return line
    places = np.unique([*np.linspace(min(ends), max(ends), _BETWEEN), *ends])
    drives = [{**posed.conditions[indices[0]], key: float(each)} for each in places]
    problem, fit = found.extended
    null = np.zeros(problem.size)  # where all causes are absent
    null[: problem.base_count] = found.null.x[: problem.base_count]
    vectors = problem.physical(np.stack([null, fit.x]))
    before, after = posed.extended_model(found).velocities(drives, vectors) * 1e3
    x = places * shown_unit(key)[1]
    return replace(line, x=x.tolist(), y=(after - before).tolist())


def _condition(condition: Mapping[str, Value], number: int, keys: Sequence[str]) -> str:
    said_of = in_words(condition, keys)
    return f"condition {number + 1}: {said_of}" if said_of else f"condition {number + 1}"
