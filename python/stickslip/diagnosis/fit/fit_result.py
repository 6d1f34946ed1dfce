"""A model that competes, where a fit of it begins, and what the fit is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.model.problem import PRIOR_INFLATION, Cause, Problem

Array = NDArray[np.float64]


PAIR_PRICE = 6.7
"""Log-evidence of a pair above the best single cause: half the 99 % point of the largest of 378
chi-squares of one degree of freedom, 8.8, for all pairs of 28 causes, less the price of an
amplitude of signal to noise 8, which the evidence has taken already: ln(1 + 64) / 2 = 2.1."""


@dataclass(frozen=True)
class Candidate:
    """A model that competes: the recalibrated baseline and some causes.

    Attributes
    ----------
    causes : tuple of Cause
    free : ndarray of int
        Coordinates that are fitted.
    width : ndarray
        Standard deviation of the prior of each.
    """

    causes: tuple[Cause, ...]
    free: NDArray[np.int64]
    width: Array

    @property
    def name(self) -> str:
        """Names of the causes, or ``none``."""
        return " + ".join(each.name for each in self.causes) or "none"


@dataclass(frozen=True)
class Fit:
    """A fitted candidate.

    Attributes
    ----------
    candidate : Candidate
    x : ndarray, shape (size,)
        All coordinates.
    chi2 : float
        Of data and prior rows.
    data_chi2 : float
    residual : ndarray, shape (m + free,)
        Whitened, with prior rows.
    jacobian : ndarray, shape (m + free, free)
        Of the model's whitened prediction, with the prior's rows.
    slope : ndarray, shape (m, free)
        Of the model's prediction, in the observable's unit.
    log_evidence : float
        Laplace's, up to a constant that is common to all candidates.
    converged : bool
        Two starts ended within one unit of chi-square.
    starts : tuple of float
        What the problem's loss makes of the end of each start, best first.
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
        """Of the free coordinates."""
        return np.asarray(np.linalg.inv(self.jacobian.T @ self.jacobian))

    @property
    def priced_evidence(self) -> float:
        """`log_evidence` less ``PAIR_PRICE`` for a second cause: how a verdict weighs it."""
        return self.log_evidence - (PAIR_PRICE if len(self.candidate.causes) > 1 else 0.0)

    @property
    def name(self) -> str:
        """Names of the causes, or ``none``."""
        return self.candidate.name


@dataclass(frozen=True)
class Start:
    """Where a fit begins.

    Attributes
    ----------
    x : ndarray, shape (size,)
    slope : ndarray, shape (m, free), optional
        Derivatives that were found near by.
    """

    x: Array
    slope: Array | None = None

    @staticmethod
    def of(fit: Fit, rows: NDArray[np.int64] | slice = slice(None)) -> Start:
        """The end of another fit, of some of its conditions."""
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
    """A parameter of a fit's causes, or a constant that one of them frees.

    Attributes
    ----------
    name, unit : str
    position : int
        Among the fit's free coordinates.
    column : int
        Among all coordinates.
    value, continuous : callable
        From coordinates to the unit; `continuous` has no jump where a falling one begins to act.
    shape : bool
        Whether it says how the cause looks and not how strong it is.
    """

    name: str
    unit: str
    position: int
    column: int
    value: Callable[[Array], Array]
    continuous: Callable[[Array], Array]
    shape: bool


def fitted_parameters(problem: Problem, fit: Fit) -> list[Fitted]:
    """Parameters of the causes of a fit, and the constants that they free."""
    relaxed = {cause.relaxes_prior for cause in fit.candidate.causes}
    result = []
    for position, column in enumerate(fit.candidate.free.tolist()):
        if column >= problem.base_count:
            extra = problem.parameters[column - problem.base_count]
            ways = extra.value, extra.continuous
            result.append(Fitted(extra.name, extra.unit, position, column, *ways, extra.shape))
            continue
        constant = problem.uncertain[column]
        if constant.name in relaxed:
            ways = constant.prior.value, constant.prior.value
            result.append(Fitted(constant.name, constant.unit, position, column, *ways, False))
    return result


@dataclass(frozen=True)
class Ranking:
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

    def replaced(self, old: Fit, new: Fit) -> Ranking:
        """The same with a better fit of one candidate."""

        def ordered(fits: tuple[Fit, ...]) -> tuple[Fit, ...]:
            fits = tuple(new if fit is old else fit for fit in fits)
            return tuple(sorted(fits, key=lambda fit: -fit.log_evidence))

        return Ranking(self.null, ordered(self.singles), ordered(self.pairs))
