"""Probabilities of the models, their causes, and the sets that hold 95 % of them."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from scipy.special import logsumexp

from stickslip._util.text import OneLine
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.search import Models

_Key = TypeVar("_Key")

EXCHANGE = 5.9
"""Fall of chi-square by which a claim fits better than with another cause in its place: 19:1 by
likelihood alone, as `SURE` is by probability."""

_HARDLY = 3.0  # standard deviations of a chi-square; chosen

SURE = 0.95
"""Probability that a claim asks for, and that a set holds. The usual choice."""


@dataclass(frozen=True, repr=False, eq=False)
class Posterior(OneLine):
    """Probabilities, which sum to 1 over all models.

    `fits` has every set of causes once, with its best form, the most probable first. `models` has
    the probability of each set of causes, over all forms, by name; `causes` has the probability
    that a model has the cause.
    """

    fits: tuple[Fit, ...]
    models: Mapping[str, float]
    causes: Mapping[str, float]

    @property
    def none(self) -> float:
        """Probability of no cause."""
        return self.models.get("none", 0.0)

    @property
    def has_cause(self) -> bool:
        """Whether a cause is more probable than none."""
        return self.none < 0.5

    @property
    def sure(self) -> list[str]:
        """Causes with a probability of at least 95 %."""
        return [name for name, chance in self.causes.items() if chance >= SURE]

    def smallest_set(self) -> list[Fit]:
        """The most probable models that have 95 % together."""
        before = itertools.accumulate((self.models[fit.name] for fit in self.fits), initial=0.0)
        return [fit for fit, chance in zip(self.fits, before, strict=False) if chance < SURE]

    def among_small(self, fit: Fit) -> float:
        """Probability of a model among those with as many causes at most."""
        small = (self.models[one.name] for one in self.fits if len(one.causes) <= len(fit.causes))
        return self.models[fit.name] / max(math.fsum(small), 1e-300)


def _ordered(chances: Mapping[_Key, float]) -> list[_Key]:
    """The likeliest first; what no reading tells apart as it is given, whatever the rounding."""
    return sorted(chances, key=lambda key: -float(f"{chances[key]:.9g}"))


def posterior(models: Models) -> Posterior:
    """Probabilities of all fitted models and forms."""
    weights = {key: models.log_posterior(fit) for key, fit in models.best.items()}
    total = float(logsumexp(list(weights.values())))
    by_set = defaultdict[frozenset[str], float](float)
    for (names, _), weight in sorted(weights.items(), key=lambda item: sorted(item[0][0])):
        by_set[names] += math.exp(weight - total)
    best: dict[frozenset[str], Fit] = {}
    for key in sorted(weights, key=weights.__getitem__, reverse=True):
        best.setdefault(key[0], models.best[key])
    fits = tuple(best[names] for names in _ordered(by_set))
    causes = {cause.name: 0.0 for cause in models.offered}
    for names, chance in by_set.items():
        for name in names:
            causes[name] = min(1.0, causes[name] + chance)  # rounding may pass 1
    causes = {name: causes[name] for name in _ordered(causes)}
    return Posterior(fits, {fit.name: by_set[fit.names] for fit in fits}, causes)


def share(models: Models, fit: Fit) -> float:
    """Part that a fit takes of the squares that no cause leaves beyond the errors, by plain fits.

    NaN where that is hardly more than the errors leave by themselves.
    """
    plain, null, n = models.get(fit.names) or fit, models.null, len(models.problem.y)
    whole, left = (one.chi2 - (n - len(one.free)) for one in (null, plain))
    if whole < _HARDLY * math.sqrt(2.0 * n):
        return math.nan
    return min(max(1.0 - left / whole, 0.0), 1.0)


def as_likely(models: Models, fit: Fit) -> list[Fit]:
    """Models with one other cause that fit nearly as well: 19:1 by likelihood tells them apart.

    Those with more free parameters fit better in any case, and are judged by their evidence.
    """
    least = likelihood(models, fit) - 0.5 * EXCHANGE
    return [one for one in models.leaders(form=fit.form) if one.swaps(fit)
            and len(one.free) <= len(fit.free) and likelihood(models, one) > least]  # fmt: skip


def likelihood(models: Models, fit: Fit) -> float:
    """Largest log-likelihood by the linear model about a fit.

    Without the prior of the causes' sizes: what is stated of the constants counts as readings, but
    for one that a cause frees.
    """
    form, problem, x = models.forms[fit.form], models.problem, fit.x[fit.free]
    freed = {problem.at(cause) for cause in fit.causes if cause.frees is not None}
    stated = np.array([float(k < len(problem.constants) and k not in freed) for k in fit.free])
    columns = form.prepared(np.column_stack([fit.slopes, fit.residual]))
    gram = form.weighted(columns, fit.residual, fit.h)
    cost = float(form.cost(fit.residual[None], fit.h)[0]) + float(stated @ x**2)
    down = gram[:-1, -1] - stated * x
    fall = float(down @ np.linalg.lstsq(gram[:-1, :-1] + np.diag(stated), down, rcond=1e-10)[0])
    return -0.5 * (cost - max(fall, 0.0) + float(form.log_det(fit.h)))
