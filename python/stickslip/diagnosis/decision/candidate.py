"""A fitted model as a person gets it: its sizes, share, gain and prediction, and what is left."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import t as t_law

from stickslip._util.arrays import Array
from stickslip._util.text import OneLine
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.decision.gain import Gain, gain_of
from stickslip.diagnosis.decision.posterior import share
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.search import Models
from stickslip.diagnosis.terms.parameter import Parameter

if TYPE_CHECKING:
    from pandas import DataFrame

_STEP = 1e-4  # of a coordinate, for the slope of its value
# Least share by which a discrepancy widens errors: a cause that takes nothing has no size.
_LEAST_SHARE = 0.01
_MOST_FREEDOM = 1e6  # beyond it Student's law is the normal one


@dataclass(frozen=True, repr=False, eq=False)
class Candidate(OneLine):
    """A model that was fitted: some causes, or none, and perhaps a discrepancy beside them."""

    fit: Fit
    models: Models

    @property
    def name(self) -> str:
        """Names of the causes, such as ``a + b``, or ``none``."""
        return self.fit.name

    @cached_property
    def share(self) -> float:
        """Part of the squares that the causes take, NaN where without them little is left."""
        return share(self.models, self.fit) if self.fit.causes else 0.0

    @cached_property
    def gain(self) -> Gain | None:
        """Error on held-out readings; None for ``none``, or if there are too few to hold out."""
        return gain_of(self.models, self.fit) if self.fit.causes else None

    @property
    def widening(self) -> float:
        """Factor of the errors of a fit beside a discrepancy.

        The discrepancy may be alike the cause itself: what is left counts as a part of its size,
        by ``sqrt(1 + left / taken)`` with the mean squares of what is left and what is taken. Along
        runs it may last, too: see `covariance_beside`.
        """
        if not self.fit.causes or self.fit.form == "exact" or math.isnan(self.share):
            return 1.0
        return 1.0 / math.sqrt(max(self.share, _LEAST_SHARE))

    @property
    def params(self) -> DataFrame:
        """Parameters: `value` and `sd` in the column `unit`, `prior`, and `pull`.

        The pull is the coordinate: standard deviations of the prior from its middle.
        """
        x, root = self.fit.x[self.fit.free], np.abs(self.rates) * self._spread
        rows = [
            (float(p.value(x[k : k + 1])[0]), float(root[k]), p.unit, p.prior_in_words,
             float(x[k]))
            for k, p in enumerate(self._parameters)
        ]  # fmt: skip
        return frame("parameter", self._names, rows, ["value", "sd", "unit", "prior", "pull"])

    def interval(self, level: float) -> DataFrame:
        """`low`, `high` and `unit` of each parameter, within its limits.

        By quantiles of Student's law of its coordinate, with the degrees of freedom of the errors.
        """
        freedom = min(self.models.problem.freedom, _MOST_FREEDOM)
        reach = float(t_law.ppf(0.5 + 0.5 * level, freedom)) * self._spread
        rows = []
        for k, parameter in enumerate(self._parameters):
            x = self.fit.x[self.fit.free[k]]
            ends = np.clip(x + np.array([-reach[k], reach[k]]), *parameter.limits)
            low, high = np.sort(parameter.smooth_value(ends)).tolist()
            rows.append((low, high, parameter.unit))
        return frame("parameter", self._names, rows, ["low", "high", "unit"])

    @property
    def covariance(self) -> DataFrame:
        """Covariance of `params`, in products of their units."""
        matrix = self.rates[:, None] * self._covariance * self.rates
        return frame("parameter", self._names, matrix, self._names)

    @property
    def left(self) -> dict[str, Any]:
        """The discrepancy that is left beside the causes.

        Keys are `form`; `kappa`, the scatter in the stated errors; `size`, of each table in the
        unit of its readings; for ``ar1`` `correlation`, how many places of a run it lasts in each
        table. Of the form ``exact`` no more than the first.
        """
        fit, problem = self.fit, self.models.problem
        if fit.form == "exact":
            return {"form": fit.form}
        unit, kappa = self.models.forms[fit.form].unit, fit.sizes["kappa"]
        size = fit.sizes.get("s", math.sqrt(max(kappa**2 - 1.0, 0.0)))
        sizes, lasts = {}, {}
        for table, part, name, *_ in problem.parts:
            level = size * float(unit[part][0])
            if not level:
                continue
            sizes[name] = level
            if fit.form == "ar1" and table.run is not None and table.order is not None:
                spans = [np.ptp(table.order[table.run == run]) for run in np.unique(table.run)]
                lasts[name] = fit.sizes["tau"] * float(np.median(spans))
        left: dict[str, Any] = {"form": fit.form, "kappa": kappa, "size": sizes}
        return left | {"correlation": lasts} if fit.form == "ar1" else left

    @property
    def prediction(self) -> DataFrame:
        """All readings in order: `table`, `reading`, `sd`, `predicted`, `predicted_sd`, `unit`."""
        problem, fit = self.models.problem, self.fit
        variance = np.einsum("ij,jk,ik->i", fit.slopes, self._covariance, fit.slopes)
        sd = np.sqrt(np.maximum(variance, 0.0))
        rows = [
            (one.name, float(problem.y[i]), float(problem.sd[i]),
             float(problem.y[i] - fit.residual[i]), float(sd[i]), one.table.unit)
            for one in problem.parts for i in range(one.rows.start, one.rows.stop)
        ]  # fmt: skip
        columns = ["table", "reading", "sd", "predicted", "predicted_sd", "unit"]
        return frame("row", list(range(len(rows))), rows, columns)

    def values(self) -> Array:
        """Values of all parameters: at the fit, and one standard deviation up and down each
        principal axis of its covariance, shape (1 + 2 axes, size); see `spread_of`.
        """
        scale, vectors = np.linalg.eigh(self._covariance)
        axes = (vectors * np.sqrt(np.maximum(scale, 0.0))).T[scale > 0.0]
        x = np.tile(self.fit.x, (1 + 2 * len(axes), 1))
        x[1:, self.fit.free] += np.vstack([axes, -axes])
        return self.models.problem.physical(np.clip(x, *self.models.problem.limits))

    @property
    def _parameters(self) -> list[Parameter]:
        return [self.models.problem.parameters[k] for k in self.fit.free.tolist()]

    @property
    def _names(self) -> list[str]:
        return [parameter.name for parameter in self._parameters]

    @cached_property
    def _covariance(self) -> Array:
        """Covariance of the coordinates.

        All places of an edge in a gap of the readings are alike.
        """
        matrix, problem = self.models.covariance(self.fit) * self.widening**2, self.models.problem
        steps = {table.name: table.step for table in problem.tables if isinstance(table, Series)}
        for cause in self.fit.causes:
            if cause.between is None or cause.read is None:
                continue
            step = steps[cause.table] if cause.table else max(steps.values())
            edges = [p.name for p in cause.parameters if not p.is_amplitude]
            for count, name in enumerate(edges, 1):  # a length has two
                k = self._names.index(name)
                matrix[k, k] += count * step**2 / 12.0 / self.rates[k] ** 2
        return matrix

    @property
    def _spread(self) -> Array:
        """Standard deviations of the coordinates; of one that is pushed against its end, its own.

        There its covariance is none, so the curvature along it alone stands for it.
        """
        whitened = self.models.problem.whitened(self.fit.slopes)
        alone = np.sum(whitened**2, axis=0) + np.diag(self.fit.precision)
        variance = np.diag(self._covariance)
        return np.sqrt(np.where(variance > 0.0, variance, self.widening**2 / alone))

    @cached_property
    def rates(self) -> Array:
        """Change of each parameter by its coordinate."""
        slopes = np.empty(len(self.fit.free))
        for k, parameter in enumerate(self._parameters):
            x = self.fit.x[self.fit.free[k]]
            ends = np.clip(x + np.array([-_STEP, _STEP]), *parameter.limits)
            slopes[k] = float(np.diff(parameter.smooth_value(ends))[0]) / max(np.ptp(ends), 1e-300)
        return slopes


def spread_of(predicted: Array) -> Array:
    """Covariance of predictions at `Candidate.values`, shape (1 + 2 axes, n) to (n, n)."""
    up, down = np.split(predicted[1:], 2)
    half = (up - down) / 2.0
    return np.asarray(half.T @ half)


def frame(what: str, index: Sequence[Any], rows: Any, columns: Sequence[str]) -> DataFrame:
    """A table with a row for each entry, whose index is called `what`."""
    import pandas as pd

    names = pd.Index(list(index), name=what, dtype=object)
    data = list(rows) if len(index) else None
    return pd.DataFrame(data, index=names, columns=list(columns))
