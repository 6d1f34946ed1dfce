"""Gain of a model on readings that its fit has not seen."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import t as t_law

from stickslip._util.arrays import Array, Indices
from stickslip._util.text import OneLine
from stickslip.diagnosis.data.series import STRETCHES, Series
from stickslip.diagnosis.fitting.descent import step_within
from stickslip.diagnosis.fitting.forms import Exact
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.fitting.search import Models

_FEWEST = 3  # parts for an interval
_LARGEST_SHARE = 0.5  # of an effect, in one part; chosen


@dataclass(frozen=True, repr=False, eq=False)
class Gain(OneLine):
    """Errors of all readings, each predicted by a fit without its part.

    Attributes
    ----------
    before, after : float
        Mean absolute error of the recalibrated and the extended model, in errors.
    interval : (float, float)
        95 % interval of the mean fall of the error over the parts, in errors, by a paired t.
    mae_before, mae_after : dict of float
        Mean absolute errors of each table, in its unit.
    parts : int
    """

    before: float
    after: float
    interval: tuple[float, float]
    mae_before: dict[str, float] = field(default_factory=dict)
    mae_after: dict[str, float] = field(default_factory=dict)
    parts: int = 0

    @property
    def certain(self) -> bool:
        """Whether the interval lies above zero."""
        return self.interval[0] > 0.0


def parts_of(problem: Problem) -> list[Indices]:
    """Rows that are held out in turn: neighbouring groups together."""
    groups = problem.group
    number = int(groups.max()) + 1
    return _numbered(groups * min(STRETCHES, number) // number)


def _finer(problem: Problem, effect: Array, parts: list[Indices]) -> list[Indices]:
    """Parts of equal shares of an effect, (n,), if one of `parts` has more than half of it.

    What no other part tells cannot be predicted. Readings of a record are parted from each other,
    conditions of a group are not. Without parts enough there are none.
    """
    whole = float(np.sum(effect**2))
    if max(float(np.sum(effect[rows] ** 2)) for rows in parts) <= _LARGEST_SHARE * whole:
        return []
    alone = np.concatenate([np.full(len(t.mean), isinstance(t, Series)) for t in problem.tables])
    order = np.argsort(problem.group, kind="stable")
    begins = np.diff(problem.group[order], prepend=-1) != 0
    unit = np.empty(len(effect), dtype=np.int64)
    unit[order] = np.cumsum(begins | alone[order]) - 1
    shares = np.bincount(unit, effect**2) / whole
    number = np.floor(STRETCHES * (np.cumsum(shares) - 0.5 * shares))
    parts = _numbered(number.astype(np.int64)[unit])
    return parts if len(parts) >= _FEWEST else []


def _numbered(part: Indices) -> list[Indices]:
    """Rows of each part."""
    return [np.flatnonzero(part == k) for k in np.unique(part)]


def gain_of(models: Models, fit: Fit) -> Gain | None:
    """The gain of the causes of a fit over no cause, by plain least squares."""
    return measured(models.problem, models.null, models.get(fit.names) or fit)


def measured(problem: Problem, before: Fit, after: Fit) -> Gain | None:
    """The gain of one fit over another, by plain least squares; None of too few parts.

    Refits are of the models that are linearised at their fits.
    """
    parts = parts_of(problem)
    if len(parts) < _FEWEST:
        return None
    finer = _finer(problem, (before.residual - after.residual) / problem.sd, parts)
    parts = finer or parts
    errors = [held_out(problem, fit, parts, not finer) for fit in (before, after)]
    size = [np.abs(values) / problem.sd for values in errors]
    falls = np.array([np.mean(size[0][rows]) - np.mean(size[1][rows]) for rows in parts])
    half = float(t_law.ppf(0.975, len(parts) - 1) * falls.std(ddof=1) / math.sqrt(len(parts)))
    middle = float(falls.mean())
    maes = [{one.name: float(np.mean(np.abs(values[one.rows]))) for one in problem.parts}
            for values in errors]  # fmt: skip
    means, interval = [float(np.mean(one)) for one in size], (middle - half, middle + half)
    return Gain(means[0], means[1], interval, maes[0], maes[1], len(parts))


def held_out(problem: Problem, fit: Fit, parts: list[Indices], shapes: bool = True) -> Array:
    """Errors of predictions of each part by a fit of the others, shape (n,), in their units.

    Without `shapes` these stay as the whole fit has them: where an event begins is told by the
    reading there alone.
    """
    errors = np.empty(len(problem.y))
    columns = np.column_stack([fit.slopes, fit.residual])
    room = problem.limits[:, fit.free] - fit.x[fit.free]
    if not shapes:
        terms = fit.free[len(problem.constants) :].tolist()
        still = [not problem.parameters[k].is_amplitude for k in terms]
        room[:, len(problem.constants) :][:, still] = 0.0
    for rows in parts:
        gram = _gram(problem, columns, rows)
        curvature = gram[:-1, :-1] + fit.precision
        downhill = gram[:-1, -1] - fit.precision @ fit.x[fit.free]
        move = step_within(curvature, downhill, *room)
        errors[rows] = fit.residual[rows] - fit.slopes[rows] @ move
    return errors


def _gram(problem: Problem, columns: Array, left_out: Indices) -> Array:
    """A' C^-1 A without the rows that are held out; weights are of the residual, the last column.

    Rows whose columns are zero do not count in an inner product of independent errors. Where errors
    are correlated, the held-out rows are free: each has a column of its own that is eliminated.
    """
    form, none = Exact(problem), np.zeros(0)
    if all(errors.covariance is None for errors in problem.errors):
        only = columns.copy()
        only[left_out] = 0.0
        return form.weighted(form.prepared(only), columns[:, -1], none)
    ones = np.zeros((len(columns), len(left_out)))
    ones[left_out, np.arange(len(left_out))] = 1.0
    gram = form.gram(form.prepared(np.hstack([columns, ones])), none)
    k = columns.shape[1]
    return np.asarray(gram[:k, :k] - gram[:k, k:] @ np.linalg.solve(gram[k:, k:], gram[k:, :k]))
