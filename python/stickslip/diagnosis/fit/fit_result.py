"""A candidate model, the start of a fit of it, and the fit itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.model.problem import (
    PRIOR_INFLATION,
    Array,
    Cause,
    CauseParameter,
    Indices,
    Problem,
    Uncertain,
)

PAIR_PRICE = 6.7
"""Log-evidence of a pair above the best single cause: half the 99 % point of the largest of 378
chi-squares of one degree of freedom, 8.8, for all pairs of 28 causes, less the price of an
amplitude of signal to noise 8, which the evidence has taken already: ln(1 + 64) / 2 = 2.1."""


@dataclass(frozen=True, repr=False, eq=False)
class Candidate(OneLine):
    """A candidate model: the recalibrated baseline and some causes.

    Attributes
    ----------
    causes : tuple of Cause
    free : ndarray of int
        Coordinates that are fitted.
    width : ndarray
        Standard deviation of the prior of each.
    """

    causes: tuple[Cause, ...]
    free: Indices
    width: Array

    @property
    def name(self) -> str:
        """Names of the causes, or ``none``."""
        return " + ".join(each.name for each in self.causes) or "none"


@dataclass(frozen=True, repr=False, eq=False)
class Fit(OneLine):
    """A fitted candidate.

    Attributes
    ----------
    candidate : Candidate
    x : ndarray, shape (size,)
        All coordinates.
    chi2 : float
        Chi-square of data and prior rows.
    data_chi2 : float
    residual : ndarray, shape (m + free,)
        Whitened, with prior rows.
    jacobian : ndarray, shape (m + free, free)
        Derivatives of the model's whitened prediction, with the prior's rows.
    slope : ndarray, shape (m, free)
        Derivatives of the model's prediction, in the observable's unit.
    log_evidence : float
        Laplace's, up to a constant that is common to all candidates.
    converged : bool
        Two starts ended within one unit of chi-square.
    starts : tuple of float
        Value of the problem's loss at the end of each start, best first.
    """

    candidate: Candidate
    x: Array
    chi2: float
    data_chi2: float
    residual: Array
    jacobian: Array
    slope: Array
    log_evidence: float
    converged: bool
    starts: tuple[float, ...]

    @property
    def covariance(self) -> Array:
        """Covariance of the free coordinates."""
        # Without the product of the Jacobian with itself, whose inverse rounding can make no
        # covariance any more: an eigenvalue falls below zero.
        root = np.linalg.inv(np.linalg.qr(self.jacobian, mode="r"))
        return np.asarray(root @ root.T)

    @property
    def agreement(self) -> str:
        """Whether fits from several starts agree: yes, no, or not checked where none were tried."""
        if self.converged:
            return "yes"
        return "no" if len(self.starts) > 1 else "not checked"

    @property
    def priced_evidence(self) -> float:
        """`log_evidence` less ``PAIR_PRICE`` for a second cause: how a verdict weighs it."""
        return self.log_evidence - (PAIR_PRICE if len(self.candidate.causes) > 1 else 0.0)

    @property
    def name(self) -> str:
        """Names of the causes, or ``none``."""
        return self.candidate.name


@dataclass(frozen=True, repr=False, eq=False)
class Start(OneLine):
    """Where a fit begins: all coordinates, and derivatives (m, free) that were found near by."""

    x: Array
    slope: Array | None = None

    @staticmethod
    def of(fit: Fit, rows: Indices | slice = slice(None)) -> Start:
        """The end of another fit, with the derivatives of some of its conditions."""
        return Start(fit.x, fit.slope[rows])


def make_candidate(problem: Problem, causes: Sequence[Cause] = ()) -> Candidate:
    """The model with these causes."""
    width = np.ones(problem.base_count)
    names = [each.name for each in problem.uncertain]
    for cause in causes:
        if cause.relaxes_prior is not None:
            width[names.index(cause.relaxes_prior)] = PRIOR_INFLATION
    extra = problem.columns(causes)
    free = np.array([*range(problem.base_count), *extra], dtype=np.int64)
    return Candidate(tuple(causes), free, np.concatenate([width, np.ones(len(extra))]))


@dataclass(frozen=True)
class Fitted:
    """A parameter that a fit has free.

    `position` is its place among the fit's free coordinates, `column` among all coordinates.
    """

    of: Uncertain | CauseParameter
    position: int
    column: int

    @property
    def name(self) -> str:
        return self.of.name

    @property
    def unit(self) -> str:
        return self.of.unit

    @property
    def shape(self) -> bool:
        """Whether it says how the cause looks and not how strong it is."""
        return isinstance(self.of, CauseParameter) and self.of.shape

    def value(self, u: Array) -> Array:
        """Values in the unit at coordinates."""
        law = self.of if isinstance(self.of, CauseParameter) else self.of.prior
        return np.asarray(law.value(u))

    def continuous(self, u: Array) -> Array:
        """`value` without the jump where a parameter that acts as it falls begins to act."""
        return self.of.continuous(u) if isinstance(self.of, CauseParameter) else self.value(u)

    def slope(self, fit: Fit) -> float:
        """Derivative of the value by the coordinate, over a step that does not see small jumps."""
        low, high = self.of.limits if isinstance(self.of, CauseParameter) else (-np.inf, np.inf)
        ends = np.clip(fit.x[self.column] + np.array([-0.01, 0.01]), low, high)
        below, above = self.value(ends)
        return float((above - below) / (ends[1] - ends[0]))


def free_parameters(problem: Problem, fit: Fit) -> list[Fitted]:
    """The constants of a fit, and then the parameters of its causes."""
    every = [*problem.uncertain, *problem.parameters]
    free = fit.candidate.free.tolist()
    return [Fitted(every[column], position, column) for position, column in enumerate(free)]


def physical_covariance(fit: Fit, parameters: Sequence[Fitted]) -> Array:
    """Covariance of some free parameters of a fit, in products of their units."""
    slope = np.array([each.slope(fit) for each in parameters])
    at = [each.position for each in parameters]
    return np.asarray(slope[:, None] * fit.covariance[np.ix_(at, at)] * slope)


def fitted_parameters(problem: Problem, fit: Fit) -> list[Fitted]:
    """Parameters of the causes of a fit, and the constants whose prior they relax."""
    relaxed = {cause.relaxes_prior for cause in fit.candidate.causes}
    return [
        each
        for each in free_parameters(problem, fit)
        if each.column >= problem.base_count or each.name in relaxed
    ]


def ranked(fits: Sequence[Fit], priced: bool = False) -> tuple[Fit, ...]:
    """Fits by their log-evidence, best first.

    `priced` takes off the price of a second cause, which a verdict asks where single causes and
    pairs are compared.
    """

    def evidence(fit: Fit) -> float:
        return fit.priced_evidence if priced else fit.log_evidence

    return tuple(sorted(fits, key=evidence, reverse=True))


@dataclass(frozen=True, repr=False)
class Ranking(OneLine):
    """Candidates, best first.

    Attributes
    ----------
    null : Fit
    singles, pairs : tuple of Fit
        By log-evidence, falling.
    """

    null: Fit
    singles: tuple[Fit, ...]
    pairs: tuple[Fit, ...]

    @staticmethod
    def of(null: Fit, fits: Sequence[Fit]) -> Ranking:
        """Fits of one cause and of two, each by their log-evidence."""
        singles, pairs = (
            ranked([fit for fit in fits if len(fit.candidate.causes) == count]) for count in (1, 2)
        )
        return Ranking(null, singles, pairs)
