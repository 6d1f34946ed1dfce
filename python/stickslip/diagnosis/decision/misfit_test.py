"""Is anything beyond the recalibrated model?

The lack of fit sees any departure, the largest score over the causes one that looks like a known
cause. Draws of pure noise through the same projection give the law of both together: they see the
same noise, so that twice the smaller p-value would be too cautious.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.problem import Problem, lack_of_fit
from stickslip.diagnosis.fitting.responses import Response

ALPHA = 0.05
"""Rate of false alarms: the usual choice."""

GOF_LEVEL = 0.01
"""A model explains the data whose lack of fit has at least this p-value: 1 % of true models are
refused. Chosen."""

# Draws of pure noise: a p-value of 0.05 is then known to 0.003; of so many readings, or numbers of
# all directions, to 0.007. Numbers that are drawn at a time, 2 MiB. Signal below which a response
# is not seen. Chosen.
_DRAWS, _MANY, _LARGE, _FEWER, _AT_ONCE, _UNSEEN = 4000, 2000, 150_000, 1000, 1 << 18, 1e-3


@dataclass(frozen=True)
class MisfitTest:
    """p-values of the lack of fit, of the largest score, and of both together."""

    p_value: float
    lack_of_fit: float
    score: float

    @property
    def misfit(self) -> bool:
        """Whether something is left."""
        return self.p_value < ALPHA


def goodness_of_fit(problem: Problem, fit: Fit) -> float:
    """p-value of the lack of fit of a model with the errors as they are stated.

    The prior of the constants belongs to the misfit. That of an effect's size does not: it says
    nothing of whether the effect explains the data.
    """
    count = len(problem.constants)
    tight = np.array([fit.precision[k, k] >= 1.0 for k in range(count)], dtype=bool)
    stated = float(np.sum(fit.x[:count][tight] ** 2))
    free = len(problem.y) - (len(fit.free) - int(tight.sum()))
    return lack_of_fit(problem, fit.chi2 + stated, free)


def tested(problem: Problem, null: Fit, responses: list[Response], seed: int) -> MisfitTest:
    """Test the recalibrated model, with responses of causes about it.

    All that was tried of a cause counts, such as every place of a scan, and not only where the data
    looked best: noise has to find the best of as much.
    """
    p, one_each = len(null.free), list({each.cause.name: each for each in responses}.values())
    lower, rows, spare = np.linalg.cholesky(null.precision), problem.rows, [0] * len(problem.rows)
    parts = [null.slopes, *(each.tried.T for each in one_each), null.residual[:, None]]
    if not problem.is_long or any(errors.covariance is not None for errors in problem.errors):
        whitened = np.hstack([problem.whitened(part) for part in parts])
    else:
        roots = [_root(problem, parts, of) for of in rows]
        whitened, ends = np.vstack(roots), np.cumsum([0, *map(len, roots)]).tolist()
        spare = [of.stop - of.start - len(root) for of, root in zip(rows, roots, strict=True)]
        rows = [slice(*pair) for pair in itertools.pairwise(ends)]
    n, basis = len(whitened), np.linalg.qr(np.vstack([whitened[:, :p], lower.T]))[0]
    residual = np.concatenate([whitened[:, -1], -lower.T @ null.x[null.free]])
    # Effects of causes on the rows, and of relaxed constants on their prior.
    relaxed = [n + problem.at(each.cause) for each in one_each if each.cause.is_constant]
    directions = np.zeros((whitened.shape[1] - p - 1 + len(relaxed), n + p))
    directions[: len(directions) - len(relaxed), :n] = whitened[:, p:-1].T
    directions[len(directions) - len(relaxed) + np.arange(len(relaxed)), relaxed] = 1.0
    sides = [*(each.either for each in one_each), np.ones(len(relaxed), dtype=bool)]
    either = np.concatenate(sides)  # whether the opposite counts, too
    directions -= (directions @ basis) @ basis.T
    size = np.linalg.norm(directions, axis=1)
    seen = size > _UNSEEN
    directions, either = directions[seen], either[seen]
    directions /= size[seen, None]  # in place, as of a long log they are large

    def largest(rows: Array) -> Array:
        found = rows @ directions.T
        return np.asarray(np.max(np.abs(found, out=found, where=either), axis=1, initial=-np.inf))

    random = np.random.default_rng([seed, 11])
    count = _DRAWS if n < _MANY and directions.size < _LARGE else _FEWER
    observed = float(residual @ residual)
    misfits, scores = np.empty(count), np.empty(count)
    size = max(_AT_ONCE // (n + p), 1)
    for start in range(0, count, size):
        part = slice(start, min(start + size, count))
        noise = random.standard_normal((part.stop - start, n + p))
        beside = np.zeros(len(noise))
        for of, dof, more in zip(rows, problem.dof, spare, strict=True):
            square = np.ones((len(noise), 1))
            if math.isfinite(dof):
                square = random.chisquare(dof, (len(noise), 1)) / dof
                noise[:, of] /= np.sqrt(square)
            beside += random.chisquare(more, len(noise)) / square[:, 0] if more else 0.0
        # Directions are at right angles to what the model undoes.
        misfits[part] = np.sum(noise**2, axis=1) - np.sum((noise @ basis) ** 2, axis=1) + beside
        scores[part] = largest(noise)
    exact = lack_of_fit(problem, observed, len(problem.y))
    fits, fit_p = _shares(misfits, observed)
    if not len(directions):
        return MisfitTest(exact, exact, 1.0)
    scores, score_p = _shares(scores, float(largest(residual[None, :])[0]))
    smaller = np.minimum(fits, scores)
    both = (1.0 + float(np.sum(smaller <= min(fit_p, score_p)))) / (count + 1.0)
    # Beyond what draws can tell, the law of the misfit is known.
    return MisfitTest(min(both, 2.0 * min(exact, score_p)), exact, score_p)


def _root(problem: Problem, parts: Sequence[Array], rows: slice) -> Array:
    """R of the whitened columns of all parts, (n, k) each, over `rows`: R'R is their Gram matrix.

    It has as many rows as columns, or as readings where these are fewer.
    """
    count = sum(part.shape[1] for part in parts)
    gram, step = np.zeros((count, count)), max(_AT_ONCE // count, 1)
    for begin in range(rows.start, rows.stop, step):
        of = slice(begin, min(begin + step, rows.stop))
        some = np.hstack([part[of] for part in parts]) / problem.sd[of, None]
        gram += some.T @ some
    size = np.sqrt(np.diag(gram)) + (np.diag(gram) == 0.0)
    values, axes = np.linalg.eigh(gram / np.outer(size, size))
    root = (axes * np.sqrt(np.maximum(values, 0.0))).T * size
    return np.asarray(root[-min(count, rows.stop - rows.start) :])  # the largest come last


def _shares(values: Array, observed: float) -> tuple[Array, float]:
    """Share of the draws that are at least as large, of each draw and of what was observed."""
    rank = np.searchsorted(np.sort(values), [*values, observed], side="left")
    share = (1.0 + len(values) - rank) / (len(values) + 1.0)
    return np.asarray(share[:-1]), float(share[-1])
