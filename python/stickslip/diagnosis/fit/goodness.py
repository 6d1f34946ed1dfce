"""How well a fitted model explains the data."""

from __future__ import annotations

import math

from scipy.stats import chi2 as chi2_law
from scipy.stats import f as f_law

from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.model.problem import Problem

ADEQUATE = 0.01
"""A model is adequate whose lack of fit has at least this p-value. Chosen: 1 % of true models are
refused."""

COMFORTABLE = 0.3
"""With a single cause of at least this p-value, no pair is looked for. Chosen, not derived: with a
smaller one a pair is missed whose best single cause just passes, with a larger one most right
single causes pay for the search of pairs."""


def lack_of_fit_p(chi2: float, free: int, dof: float) -> float:
    """Probability of a larger chi-square of `free` degrees of freedom, by pooled scatter."""
    if free <= 0:
        return 1.0
    if not math.isfinite(dof):
        return float(chi2_law.sf(chi2, free))
    return float(f_law.sf(chi2 / free, free, dof))


def adequacy(problem: Problem, fit: Fit) -> float:
    """p-value of the lack of fit of a candidate.

    The size of an effect says nothing of whether it explains: the prior row of an amplitude belongs
    to the evidence, not to the misfit.
    """
    base = problem.base_count
    extra = len(fit.candidate.free) - base
    # The prior row of a relaxed constant is nearly void.
    extra += sum(cause.relaxes_prior is not None for cause in fit.candidate.causes)
    constants = fit.x[fit.candidate.free[:base]] / fit.candidate.width[:base]
    chi2 = fit.data_chi2 + float(constants @ constants)
    return lack_of_fit_p(chi2, len(problem.observed) - extra, problem.dof)
