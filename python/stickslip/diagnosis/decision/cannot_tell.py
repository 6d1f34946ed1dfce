"""Limits of the data: causes that act alike, constants that trade, causes too small to see.

All of it is of the linear model about a fit, from what was computed for the verdict: the slopes and
the covariance of the fit, the effects of the causes beside it, and the inner product of its errors.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import qr
from scipy.sparse.csgraph import connected_components
from scipy.stats import t as t_law

from stickslip._util.arrays import Array, Indices
from stickslip._util.text import OneLine
from stickslip.diagnosis.decision.candidate import Candidate
from stickslip.diagnosis.decision.posterior import SURE
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.problem import RELAXED, Problem
from stickslip.diagnosis.fitting.responses import Response
from stickslip.diagnosis.fitting.search import Models
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.diagnosis.terms.words import of_side

BOUND = 0.95
"""Confidence of an upper limit."""

ALIKE = 0.9
"""Cosine of the projected effects of two causes above which they act alike. Chosen."""

PARTS = 2.0 * math.log(SURE / (1.0 - SURE))
"""Chi-square that tells two causes alike apart: one is to reach 95 % of both."""

_MOST = 1e3
"""Multiple of the data beyond which no number of them is said to help. Chosen."""

# A response is trusted up to this multiple of its size and down to its inverse; one with a smaller
# signal than the other, in errors, or than that part of itself without the constants, says nothing.
# Chosen.
_TRUSTED, _UNSEEN, _ROUNDING = 3.0, 1e-3, 1e-10
# Constants are named that do so much of the largest part in undoing an effect. Chosen.
_TAKES_PART = 0.3

# Idle are directions of which the data say less than the priors: their share of a prior's variance
# is larger than this, as is their share of the variance of a parameter in them. Parameters belong
# together whose projections on these directions have such a cosine, and a combination of them is
# known whose error falls by such a factor. Chosen.
_IDLE, _TOGETHER, _KNOWN = 0.5, 0.05, 1.0 / 3.0
# Powers are rounded to whole ones up to a largest, after multiplying by up to three, where they are
# that near, or not so far and rounding widens the error by less than this. Chosen: slopes of a
# simulation have errors of a tenth.
_POWER, _NEAR, _FAR, _WIDER = 6, 0.02, 0.15, 1.5


class Limit(NamedTuple):
    """An upper limit, in the unit of its amplitude, and whether these data show it.

    Else it is the end of the range that was searched.
    """

    value: float
    seen: bool


class Alike(NamedTuple):
    """Two causes with a similar effect beyond what the constants can undo.

    `lead` is the chi-square by which the data tell them apart, at the size that was found or else
    the usual size of the first; `more` how many times these readings would, inf if none would;
    `row` the reading at which they differ most, by `apart` of its errors.
    """

    cause: str
    other: str
    cosine: float
    lead: float
    more: float
    row: int
    apart: float

    @property
    def parted(self) -> bool:
        """Whether the data tell them apart."""
        return self.lead > PARTS


class Combination(NamedTuple):
    """A combination of parameters that the data determine, with its value and error.

    ``product`` of powers or else a sum with factors, which `weights` are by name.
    """

    weights: dict[str, float]
    product: bool
    value: float
    sd: float


class Group(NamedTuple):
    """Parameters of which the data determine no more than some combinations."""

    names: tuple[str, ...]
    known: tuple[Combination, ...]


@dataclass(frozen=True, repr=False, eq=False)
class CannotTell(OneLine):
    """Limits of the data beside a model.

    `alike` is of the causes of the model with others; then of others that are not told apart.
    `hidden` are causes whose usual size some constants undo within their priors, and these
    constants. `silent` are parameters that may be causes, of which the data say less than their
    priors. `limits` are of the amplitudes of all causes that are not in the model. `causes` were
    compared, the one of the largest gain first; `cosines` has the shape (causes, causes).
    """

    alike: list[Alike]
    hidden: dict[str, tuple[str, ...]]
    groups: list[Group]
    silent: list[str]
    limits: dict[str, Limit]
    causes: list[str]
    cosines: Array


def cannot_tell(
    subject: Candidate, null: Candidate, responses: Sequence[Response], fits: Sequence[Fit]
) -> CannotTell:
    """Limits of the data beside the model that is told, the subject.

    Where its causes take little, that is beside the recalibrated model, `null`. `responses` are
    those of the causes about the recalibrated model, that of the largest gain first; `fits` are the
    best ones of each set of causes.
    """
    models = subject.models
    candidate = subject if _lead(models, subject.fit, null.fit) > PARTS else null
    groups, silent = combinations(candidate)
    beside = _Beside(models, candidate.fit, responses)
    (causes, cosines), hidden = beside.cosines(), beside.hidden()
    alike = _exchanged(models, candidate.fit, fits)
    alike += beside.alike([name for name in causes if name not in hidden])

    def in_group(*names: str) -> bool:
        """Whether a group says as much of constants that are other than stated."""
        return any(set(names) <= set(group.names) for group in groups)

    alike = [pair for pair in alike if not in_group(pair.cause, pair.other)]
    hidden = {name: others for name, others in hidden.items() if not in_group(name, *others)}
    return CannotTell(alike, hidden, groups, silent, beside.limits(), causes, cosines)


# ------------------------------------------------------------------------------- causes that differ
def _exchanged(models: Models, fit: Fit, fits: Sequence[Fit]) -> list[Alike]:
    """Causes of a fit beside those that act alike in their place, each refitted."""
    problem, form, pairs = models.problem, models.forms[fit.form], []
    for rival in fits:
        other = models.get(rival.names, fit.form) or rival
        cosine = abs(_cosine_of_swap(models, fit, other)) if fit.swaps(other) else 0.0
        if cosine <= ALIKE:
            continue
        gap = fit.residual - other.residual
        apart = float(form.gram(form.prepared(gap[:, None]), fit.h)[0, 0])
        (cause,), (twin,) = fit.names - other.names, other.names - fit.names
        pairs.append(_alike(problem, (cause, twin), cosine, _lead(models, fit, other), apart, gap))
    return pairs


def _cosine_of_swap(models: Models, one: Fit, other: Fit) -> float:
    """Cosine of the effects of the causes that two models do not share.

    Effects are beyond the model of what they share, in the stated errors, without what its
    parameters can undo.
    """
    base, problem = models.get(one.names & other.names) or models.null, models.problem
    lower = np.linalg.cholesky(base.precision)
    basis = np.linalg.qr(np.vstack([problem.whitened(base.slopes), lower.T]))[0]
    rows = np.zeros((2, len(basis)))
    changes = [base.residual - fit.residual for fit in (one, other)]
    rows[:, : len(base.residual)] = problem.whitened(np.stack(changes, axis=1)).T
    rows -= (rows @ basis) @ basis.T
    size = np.linalg.norm(rows, axis=1)
    return float(rows[0] @ rows[1] / max(size[0] * size[1], 1e-300))


def _lead(models: Models, fit: Fit, other: Fit) -> float:
    """Chi-square by which a fit is better than another, in its inner product.

    What was stated of the constants is a datum too; the usual size of a cause is none.
    """
    known = slice(0, len(models.problem.constants))
    costs = models.forms[fit.form].cost(np.stack([fit.residual, other.residual]), fit.h)
    pulls = [one.x[known] @ one.precision[known, known] @ one.x[known] for one in (fit, other)]
    return float(costs[1] - costs[0] + pulls[1] - pulls[0])


def _alike(
    problem: Problem, names: tuple[str, str], cosine: float, lead: float, apart: float, gap: Array
) -> Alike:
    more = math.ceil(PARTS / apart) if apart > PARTS / _MOST else math.inf
    errors = np.abs(gap) / problem.sd
    row = int(np.argmax(errors))
    return Alike(*names, cosine, lead, more, row, float(errors[row]))


class _Effect(NamedTuple):
    """Change of the predictions by an amplitude at the coordinate `u`; -1 is a relaxed constant.

    `usual` is the factor to its usual size.
    """

    cause: str
    amplitude: int
    u: float
    shape: tuple[float, ...]
    response: int
    usual: float
    gap: Array


class _Beside:
    """Effects of causes beside a fit, in its inner product, beyond what its parameters undo."""

    def __init__(self, models: Models, fit: Fit, responses: Sequence[Response]) -> None:
        self.models, self.fit, problem = models, fit, models.problem
        self.effects = [effect for number, response in enumerate(responses)
                        if response.cause.curve is None and response.cause.name not in fit.names
                        for effect in _effects(problem, fit, response, number)]  # fmt: skip
        p, gaps = len(fit.free), [effect.gap for effect in self.effects]
        gram = models.forms[fit.form].gram_of([*fit.slopes.T, *gaps], fit.residual, fit.h)
        self.constants = gram[:p, :p]
        curvature, across = self.constants + fit.precision, gram[:p, p:-1]
        self.undo = np.linalg.solve(curvature, across)  # shape (free, effects)
        self.raw = np.diag(gram)[p:-1]
        self.gram = gram[p:-1, p:-1] - across.T @ self.undo
        downhill = gram[:p, -1] - fit.precision @ fit.x[fit.free]
        self.along = gram[p:-1, -1] - self.undo.T @ downhill
        size2 = np.diag(self.gram)
        self.seen = (size2 > _UNSEEN**2) & (size2 > _ROUNDING * self.raw)
        # Of each cause the effects that are seen, a list for each response.
        self.rows: dict[str, list[list[int]]] = {}
        for _, same in itertools.groupby(enumerate(self.effects), lambda item: item[1].response):
            rows = [k for k, _ in same]
            lists = self.rows.setdefault(self.effects[rows[0]].cause, [])
            lists.append([k for k in rows if self.seen[k]])

    def limits(self) -> dict[str, Limit]:
        """95 % upper limit of the magnitude of every amplitude by name.

        That of one that acts as it falls, such as a limit of an amplifier, is the lowest value that
        it could have. Of the responses of a sign and a shape the one counts whose size is nearest
        to its limit, as if it grew with the amplitude; of signs and shapes the one that is seen
        least. An amplitude that these data cannot see is bounded by its range.
        """
        problem = self.models.problem
        sds = float(t_law.ppf(0.5 + 0.5 * BOUND, min(problem.freedom, 1e6)))
        # By amplitude, sign and shape: how far the limit is from the response's size, and it.
        nearest: dict[tuple[int, float, tuple[float, ...]], tuple[float, float]] = {}
        for k, effect in enumerate(self.effects):
            if effect.amplitude < 0:
                continue
            multiple = math.inf
            if self.seen[k]:
                size2 = float(self.gram[k, k])
                multiple = max(float(self.along[k]) / size2, 0.0) + sds / math.sqrt(size2)
            reach = math.inf
            if multiple < _TRUSTED:
                size = _distance(problem.parameters[effect.amplitude], effect.u)
                # Another value of a constant changes the predictions evenly, however little.
                changed = of_side(effect.cause)[0] in problem.rivals.shared
                reach = size * max(multiple, 0.0 if changed else 1.0 / _TRUSTED)
            key = effect.amplitude, math.copysign(1.0, effect.u), effect.shape
            old = nearest.get(key, (math.inf, math.inf))
            nearest[key] = min(old, (abs(math.log(multiple)), reach))
        limits: dict[str, Limit] = {}
        for (k, sign, _), (_, reach) in nearest.items():
            name, end = problem.parameters[k].name, problem.limits[int(sign > 0.0), k]
            end = _distance(problem.parameters[k], end)
            limit = Limit(min(reach, end), reach < end)
            limits[name] = max(limits.get(name, limit), limit)
        falling = {p.name: p.high for p in problem.parameters if p.falls}
        return {name: Limit(falling[name] - limit.value, limit.seen) if name in falling else limit
                for name, limit in limits.items()}  # fmt: skip

    def cosines(self) -> tuple[list[str], Array]:
        """Causes, and how alike the first response of each is to the likest of every other."""
        names = list(self.rows)
        squares = np.eye(len(names))
        for a, one in enumerate(names):
            for b, other in enumerate(names):
                if a != b and self.rows[one][0]:
                    squares[a, b] = min(self._likest(k, other)[0] for k in self.rows[one][0])
        return names, np.sqrt(np.maximum(squares, squares.T))

    def hidden(self) -> dict[str, tuple[str, ...]]:
        """Causes that would be seen but for constants that undo them, and these constants."""
        undone_by, problem = {}, self.models.problem
        size2 = np.array([effect.usual**2 for effect in self.effects])
        left, raw = np.diag(self.gram) * size2, self.raw * size2
        undone = (left < PARTS) & (raw > PARTS) & (left < (1.0 - ALIKE**2) * raw)
        for name in self.rows:
            rows = [k for k, effect in enumerate(self.effects) if effect.cause == name]
            if not np.all(undone[rows]):
                continue
            part = np.abs(self.undo[:, rows[0]]) * np.sqrt(np.diag(self.constants))
            moved = np.flatnonzero(part > _TAKES_PART * part.max())
            undone_by[name] = tuple(
                problem.parameters[self.fit.free[k]].name for k in moved[np.argsort(-part[moved])]
            )
        return undone_by

    def alike(self, names: Sequence[str]) -> list[Alike]:
        """Pairs of causes that these data would not tell apart at the usual size of the first."""
        pairs: dict[frozenset[str], Alike] = {}
        for one, other in itertools.permutations(names, 2):
            # Of a cause with several amplitudes there is no usual effect.
            if len(self.rows[one][0]) != 1 or frozenset((one, other)) in pairs:
                continue
            (k,) = self.rows[one][0]
            like, columns = self._likest(k, other)
            size2 = float(self.gram[k, k]) * self.effects[k].usual ** 2
            lead = size2 * (1.0 - like)
            if like > ALIKE**2 and size2 > PARTS > lead:
                gap = self._left(k, columns) * self.effects[k].usual
                pair, problem = (one, other), self.models.problem
                pairs[frozenset(pair)] = _alike(problem, pair, math.sqrt(like), lead, lead, gap)
        return list(pairs.values())

    def _likest(self, k: int, other: str) -> tuple[float, list[int]]:
        """Share of an effect that one response of a cause can have, and the columns of that."""
        best: tuple[float, list[int]] = 0.0, []
        for rows in filter(None, self.rows[other]):  # some have no effect that is seen
            across = self.gram[rows, k]
            if len(rows) == 1:
                part = float(across[0] ** 2 / self.gram[rows[0], rows[0]])
            else:
                part = float(across @ np.linalg.solve(self.gram[np.ix_(rows, rows)], across))
            best = max(best, (min(part / float(self.gram[k, k]), 1.0), rows))
        return best

    def _left(self, k: int, columns: list[int]) -> Array:
        """The part of an effect, (n,), that other effects and the constants cannot have."""
        factors = np.linalg.solve(self.gram[np.ix_(columns, columns)], self.gram[columns, k])
        gaps = np.stack([self.effects[i].gap for i in columns], axis=1)
        moved = self.undo[:, k] - self.undo[:, columns] @ factors
        return np.asarray(self.effects[k].gap - gaps @ factors - self.fit.slopes @ moved)


def _effects(problem: Problem, fit: Fit, response: Response, number: int) -> list[_Effect]:
    cause = response.cause
    if cause.is_constant:
        # A relaxed constant is moved by its wider prior.
        gap = RELAXED[0] * fit.slopes[:, problem.at(cause)]
        return [_Effect(cause.name, -1, RELAXED[0], (), number, 1.0, gap)]
    columns = problem.columns([cause]).tolist()
    amplitudes = [k for k in columns if problem.parameters[k].is_amplitude]
    shape = tuple(response.x[[k for k in columns if k not in amplitudes]].tolist())
    effects = []
    for k, gap, value in zip(amplitudes, response.gaps, response.values.tolist(), strict=True):
        u = value if gap.any() else 0.0
        parameter = problem.parameters[k]
        usual = _distance(parameter, math.copysign(1.0, u)) / (_distance(parameter, u) or 1.0)
        effects.append(_Effect(cause.name, k, u, shape, number, usual, gap))
    return effects


def _distance(parameter: Parameter, u: float) -> float:
    """Distance of an amplitude at a coordinate from where it does nothing, in its unit."""
    start = parameter.high if parameter.falls else parameter.absent
    return abs(float(parameter.smooth_value(np.array([u]))[0]) - start)


# ------------------------------------------------------------------- parameters that are determined
def combinations(candidate: Candidate) -> tuple[list[Group], list[str]]:
    """Groups of parameters of which only combinations are determined, and those that are not.

    Directions are idle of which the data say less than the priors (likelihood-informed subspaces:
    Cui et al., Inverse Problems 30, 114015, 2014).
    """
    fit, problem = candidate.fit, candidate.models.problem
    curves = problem.columns([cause for cause in fit.causes if cause.has_knots])
    inner = np.flatnonzero((np.diag(fit.covariance) > 0.0) & ~np.isin(fit.free, curves))
    if not len(inner):
        return [], []
    width = 1.0 / np.sqrt(np.diag(fit.precision)[inner])
    scaled = fit.covariance[np.ix_(inner, inner)] / np.outer(width, width)
    share, vectors = np.linalg.eigh(scaled)
    idle = share > _IDLE
    left = (vectors[:, idle] ** 2) @ share[idle]
    open_ = np.flatnonzero(left > _IDLE * np.diag(scaled))
    project = (vectors[:, idle] @ vectors[:, idle].T)[np.ix_(open_, open_)]
    size = np.sqrt(np.diag(project))
    count, label = connected_components(np.abs(project) > _TOGETHER * np.outer(size, size))
    groups, silent = [], []
    for number in range(count):
        at = np.flatnonzero(label == number)
        known = _known(candidate, inner[open_[at]], width[open_[at]], project[np.ix_(at, at)])
        parameters = [problem.parameters[k] for k in fit.free[inner[open_[at]]]]
        if known:
            groups.append(Group(tuple(parameter.name for parameter in parameters), tuple(known)))
        else:
            silent += [parameter.name for parameter in parameters if parameter.cause]
    return groups, silent


def _known(
    candidate: Candidate, places: Indices, width: Array, project: Array
) -> list[Combination]:
    """The combinations of some parameters that the data determine.

    `places` are among the free ones, `width` those of their priors, `project` their projection on
    the idle directions.
    """
    _, axes = np.linalg.eigh(project)
    idle = round(float(np.trace(project)))
    if not 0 < idle < len(places):
        return []
    fit, parameters = candidate.fit, candidate.models.problem.parameters
    members = [parameters[k] for k in fit.free[places]]
    value = np.array([
        parameter.smooth_value(fit.x[k : k + 1])[0]
        for parameter, k in zip(members, fit.free[places], strict=True)
    ])  # fmt: skip
    rates, names = candidate.rates[places], [parameter.name for parameter in members]
    covariance = candidate.covariance.to_numpy()[np.ix_(places, places)]
    moves, prior = (rates * width)[:, None] * axes[:, -idle:], np.abs(rates * width)

    def combined(product: bool) -> tuple[list[Combination], bool]:
        """Combinations that are known, and whether all their weights are whole."""
        scale = 1.0 / value if product else np.ones(len(value))
        spread, result, whole = covariance * np.outer(scale, scale), [], True
        for row in _determined(scale[:, None] * moves, np.abs(scale) * prior):
            weights, factor, is_whole = _rounded(row, spread, product)
            whole &= is_whole
            sd = factor * math.sqrt(max(float(row @ spread @ row), 0.0))
            if sd > _KNOWN * factor * float(np.linalg.norm(row * scale * prior)):
                continue
            level = float(np.prod(value**weights) if product else weights @ value)
            by_name = {n: float(w) for n, w in zip(names, weights, strict=True) if w}
            result.append(Combination(by_name, product, level, sd * (level if product else 1.0)))
        return result, whole

    as_sum, whole_sum = combined(False)
    if any(float(parameter.smooth_value(np.array([-1.0]))[0]) <= 0.0 for parameter in members):
        return as_sum
    as_product, whole_product = combined(True)
    # Of quantities of one named unit a sum is likelier meant than a product.
    units = {parameter.unit for parameter in members}
    added = whole_sum and all(set(combination.weights.values()) == {1.0} for combination in as_sum)
    if added and len(units) == 1 and units != {"-"}:
        return as_sum
    # What is known by its order of magnitude is a factor.
    factors = all(one.prior is not None and one.prior.is_logarithmic for one in members)
    return as_product if whole_product or factors else as_sum


def _determined(moves: Array, width: Array) -> Array:
    """Weights of combinations, a row each, that idle moves, shape (parameters, idle), leave alone.

    Each has one parameter, of the weight 1, besides those that move most in the `width` of their
    priors, of which there are as many as idle moves.
    """
    count, idle = moves.shape
    order = qr((moves / width[:, None]).T, pivoting=True)[2]
    first, rest = order[:idle], order[idle:]
    rows = np.zeros((len(rest), count))
    rows[np.arange(len(rest)), rest] = 1.0
    rows[:, first] = -moves[rest] @ np.linalg.inv(moves[first])
    part = np.abs(rows * width)
    rows[part < _NEAR * np.max(part, axis=1, keepdims=True)] = 0.0
    return rows


def _rounded(row: Array, spread: Array, product: bool) -> tuple[Array, float, bool]:
    """Weights as whole numbers where they are, as near as their spread tells; else to 3 digits.

    The first is positive, and of a sum 1. And the factor between them and the row, and whether they
    are whole.
    """
    sd, used = math.sqrt(max(float(row @ spread @ row), 0.0)), row[row != 0.0]
    first = math.copysign(float(np.min(np.abs(used))), used[0]) if product else float(used[0])
    for multiple in (1.0, 2.0, 3.0) if product else (1.0,):
        factor = multiple / first
        whole = np.round(factor * row)
        off = float(np.max(np.abs(whole - factor * row)))
        wider = math.sqrt(max(float(whole @ spread @ whole), 0.0)) / max(abs(factor) * sd, 1e-300)
        near = off < _NEAR or (off < _FAR and wider < _WIDER)
        if near and np.max(np.abs(whole)) <= _POWER and np.all((whole != 0.0) == (row != 0.0)):
            return whole, abs(factor), True
    return np.array([float(f"{value / first:.3g}") for value in row]), abs(1.0 / first), False
