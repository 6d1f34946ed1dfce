"""Fits of all single causes, and how well a model explains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.detection import lack_of_fit_p
from stickslip.diagnosis.fitting import Fit, Rival, Start, fit_rivals, make_rival
from stickslip.diagnosis.model import Problem
from stickslip.diagnosis.signatures import (
    Signatures,
    screen,
    seen_from,
    starts,
)

Array = NDArray[np.float64]

ADEQUATE = 0.01
"""A model is adequate whose lack of fit has at least this p-value."""

COMFORTABLE = 0.3
"""With a single cause of at least this p-value, no pair is looked for."""

CAREFUL = 10
"""Steps of a careful fit."""

SOFT, SOFTEST = 3.0, 10.0
"""Factors by which errors are taken as too large, so that no walk is lost in a narrow valley."""

_QUICK = 5
_STARTS, _BEGINS, _CLOSE = 2, 6, 0.1
_SURVIVORS = 6
_WITHIN = 14.0
_HOPELESS, _SOFT_HOPELESS = 60.0, 12.0
_LEADING, _ROUNDS = 2, 3


@dataclass(frozen=True)
class Ranking:
    """Rivals, best first.

    Attributes
    ----------
    null : Fit
    singles, pairs : tuple of Fit
        By log-evidence, falling.
    """

    null: Fit
    singles: tuple[Fit, ...]
    pairs: tuple[Fit, ...]


def adequacy(problem: Problem, fit: Fit) -> float:
    """p-value of the lack of fit of a rival.

    How large an effect is says nothing of whether it explains: the prior row of an amplitude is the
    evidence's, not the misfit's.
    """
    base = problem.base_count
    extra = len(fit.rival.free) - base
    # The prior row of a freed constant is nearly void.
    extra += sum(cause.frees is not None for cause in fit.rival.causes)
    constants = fit.x[fit.rival.free[:base]] / fit.rival.width[:base]
    chi2 = fit.data_chi2 + float(constants @ constants)
    return lack_of_fit_p(chi2, len(problem.observed) - extra, problem.dof)


Views = Sequence[tuple[Fit, Signatures]]
"""Points at which the responses of all causes are known, the recalibrated model first."""


def fit_singles(
    problem: Problem, views: Views, basins: Sequence[Fit] = (), clouds: int = 0
) -> tuple[Fit, ...]:
    """Fit every cause quickly from its signatures, and those that survive with care.

    Parameters
    ----------
    problem : Problem
    views : sequence of tuple of Fit and Signatures
        Their rows are the starts.
    basins : sequence of Fit
        Other minima of the model without a cause, to begin from too.
    clouds : int
        As for `fit_rivals`; for the careful fits.
    """
    bases = [*(fit for fit, _ in views), *basins]
    found: dict[int, list[tuple[float, Start]]] = {k: [] for k in range(len(problem.causes))}
    for base in bases:
        for _, signatures in views:
            softer, seen_there = seen_from(problem, signatures, base, SOFTEST)
            screened = screen(seen_there, softer.residual)
            for index, points in found.items():
                points += starts(problem, softer, seen_there, screened, index, _STARTS)
    begins = {
        index: _promising(points)
        + [start for fit in bases for start in _far_off(problem, fit, index)]
        for index, points in found.items()
    }
    seen = [index for index in begins if begins[index]]
    rivals = [make_rival(problem, [problem.causes[index]]) for index in seen]
    ordered = best_first(problem, rivals, [begins[index] for index in seen])
    # Near the null a walk may settle for a little of the cause; one comes from its far side.
    bold = [_bold(problem, *views[-1], index) for index in seen]
    pairs = [(k, start) for k, points in enumerate(ordered) for start in (points[0], bold[k])
             if start is not None]  # fmt: skip
    quick = quick_fits(problem, [rivals[k] for k, _ in pairs], [[start] for _, start in pairs])
    ends: dict[int, list[Fit]] = {}
    for (k, _), fit in zip(pairs, quick, strict=True):
        ends.setdefault(k, []).append(fit)
    best, others = [], {}
    for k, fits in ends.items():
        fits.sort(key=lambda fit: fit.chi2)
        best.append(fits[0])
        others[fits[0].name] = [*(Start.of(fit) for fit in fits[1:]), *ordered[k][1:3]]
    return refine(problem, best, others, clouds)


def _bold(problem: Problem, base: Fit, signatures: Signatures, cause: int) -> Start | None:
    """A start with an amplitude of one standard deviation, of the sign that promises more."""
    rows = np.flatnonzero((signatures.cause == cause) & (np.abs(signatures.amplitude) > 1.0))
    rows = rows[signatures.at[rows] >= 0]
    if not len(rows):
        return None
    softer, seen_there = seen_from(problem, signatures, base, SOFTEST)
    row = int(rows[np.argmin(screen(seen_there, softer.residual).left[rows])])
    at = int(signatures.at[row])
    x = base.x.copy()
    x[problem.base_count :] = signatures.point[row, problem.base_count :]
    x[at] = np.sign(signatures.amplitude[row])
    columns = problem.columns([problem.causes[cause]])
    slope = np.zeros((len(problem.observed), len(columns)))
    slope[:, columns.index(at)] = signatures.gap[row] / signatures.amplitude[row]
    return Start(x, np.hstack([base.slope[:, : problem.base_count], slope]))


def quick_fits(
    problem: Problem, rivals: Sequence[Rival], begins: Sequence[Sequence[Start]]
) -> list[Fit]:
    """A few steps with errors taken as too large, then a few more."""
    fits: list[Fit] = []
    for factor, limit in ((SOFTEST, np.inf), (SOFT, _SOFT_HOPELESS), (1.0, _HOPELESS)):
        softer = problem.tempered(factor)
        fits = fit_rivals(softer, rivals, begins, _QUICK, limit, exact=False)
        begins = [[Start.of(fit)] for fit in fits]
    return fits


def _promising(points: list[tuple[float, Start]]) -> list[Start]:
    """The best starts that do not lie close together."""
    chosen: list[Start] = []
    for _, start in sorted(points, key=lambda each: each[0]):
        if all(np.linalg.norm(start.x - other.x) > _CLOSE for other in chosen):
            chosen.append(start)
        if len(chosen) == _BEGINS:
            break
    return chosen


def _far_off(problem: Problem, fit: Fit, cause: int) -> list[Start]:
    """Where a freed constant could be that no scan of the priors has looked at."""
    freed = problem.causes[cause].frees
    if freed is None:
        return []
    column = [each.name for each in problem.uncertain].index(freed)
    found = []
    for place in (-6.0, -3.0, 3.0, 6.0):
        x = fit.x.copy()
        x[column] = place
        found.append(Start(x, fit.slope))
    return found


def _moved(problem: Problem, start: Start, basin: Fit) -> Start:
    """The same amplitude with the constants, and their derivatives, of another minimum."""
    p = problem.base_count
    x = start.x.copy()
    x[:p] = basin.x[:p]
    assert start.slope is not None
    return Start(x, np.hstack([basin.slope[:, :p], start.slope[:, p:]]))


def settle_null(
    problem: Problem, null: Fit, singles: tuple[Fit, ...]
) -> tuple[Fit, tuple[Fit, ...]]:
    """The null again from the constants of the leading rivals, and these from one another's.

    A rival that found a better valley must not win for that alone.
    """
    p = problem.base_count
    leading = list(singles[:_SURVIVORS])
    if not leading:
        return null, singles
    begins = [Start.of(null)]
    for fit in leading:
        x = null.x.copy()
        x[:p] = fit.x[:p]
        begins.append(Start(x, fit.slope[:, :p]))
    rivals = [null.rival, *(fit.rival for fit in leading)]
    starts_of = [begins]
    for fit in leading:
        own = Start.of(fit)
        starts_of.append(
            [own, *(_moved(problem, own, other) for other in leading[:3] if other is not fit)]
        )
    ordered = best_first(problem, rivals, starts_of)
    again = fit_rivals(problem, rivals, [points[:2] for points in ordered], CAREFUL)
    kept = [
        new if new.chi2 < old.chi2 - 0.5 else old
        for old, new in zip([null, *leading], again, strict=True)
    ]
    rest = singles[_SURVIVORS:]
    return kept[0], tuple(sorted([*kept[1:], *rest], key=lambda fit: -fit.log_evidence))


def best_first(
    problem: Problem, rivals: Sequence[Rival], begins: Sequence[Sequence[Start]]
) -> list[list[Start]]:
    """Starts of each rival by their chi-square with large errors."""
    flat = [(k, start) for k, points in enumerate(begins) for start in points]
    if not flat:
        return []
    low, high = problem.limits()
    x = np.clip(np.stack([start.x for _, start in flat]), low, high)
    # Of narrow valleys a start is seldom at the bottom.
    chi2 = np.sum(problem.tempered(SOFTEST).residuals(x) ** 2, axis=1)
    for row, (k, _) in enumerate(flat):
        chi2[row] += np.sum((x[row, rivals[k].free] / rivals[k].width) ** 2)
    result: list[list[Start]] = [[] for _ in begins]
    for row in np.argsort(chi2, kind="stable"):
        result[flat[row][0]].append(flat[row][1])
    return result


def refine(
    problem: Problem,
    quick: Sequence[Fit],
    others: Mapping[str, Sequence[Start]],
    clouds: int = 0,
) -> tuple[Fit, ...]:
    """Refit the survivors with care and from further starts; the rest keep their quick fits."""
    order = sorted(range(len(quick)), key=lambda k: -quick[k].log_evidence)
    if not order:
        return ()
    best = quick[order[0]].log_evidence
    chosen = [k for k in order[:_SURVIVORS] if quick[k].log_evidence > best - _WITHIN]
    begins = [
        [Start.of(quick[k]), *others.get(quick[k].name, ()), _nearby(problem, quick[k])]
        for k in chosen
    ]
    careful = fit_rivals(problem, [quick[k].rival for k in chosen], begins, CAREFUL, clouds=clouds)
    result = list(quick)
    for k, fit in zip(chosen, careful, strict=True):
        result[k] = fit
    certify(problem, result, clouds)
    return tuple(sorted(result, key=lambda fit: -fit.log_evidence))


def _nearby(problem: Problem, fit: Fit) -> Start:
    """A start a posterior's width away, with derivatives to be taken there."""
    low, high = problem.limits()
    free = fit.rival.free
    x = fit.x.copy()
    signs = np.where(np.arange(len(free)) % 2 == 0, 1.0, -1.0)
    step = signs * np.minimum(np.sqrt(np.diag(fit.covariance)), 0.5)
    x[free] = np.clip(x[free] + step, low[free], high[free])
    return Start(x)


def certify(problem: Problem, fits: list[Fit], clouds: int) -> None:
    """More starts a posterior's width away for leaders whose starts do not agree."""
    order = sorted(range(len(fits)), key=lambda k: -fits[k].log_evidence)[:_LEADING]
    low, high = problem.limits()
    random = np.random.default_rng(7)
    for _ in range(_ROUNDS):
        doubtful = [k for k in order if not fits[k].certified]
        begins = []
        for k in doubtful:
            free = fits[k].rival.free
            spread = np.minimum(2.0 * np.sqrt(np.diag(fits[k].covariance)), 0.5)
            points = [Start.of(fits[k])]
            for _ in range(2):
                x = fits[k].x.copy()
                x[free] += spread * random.standard_normal(len(free))
                points.append(Start(np.clip(x, low, high)))
            begins.append(points)
        rivals = [fits[k].rival for k in doubtful]
        again = fit_rivals(problem, rivals, begins, CAREFUL, clouds=max(clouds, 1))
        for k, fit in zip(doubtful, again, strict=True):
            fits[k] = fit
