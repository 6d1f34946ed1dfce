"""Responses to each further cause about a fit, and where its own fit should begin."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array, Mask
from stickslip._util.text import OneLine
from stickslip.diagnosis.fitting.descent import End, batches, precision_of
from stickslip.diagnosis.fitting.forms import Form
from stickslip.diagnosis.fitting.options import SMOOTH
from stickslip.diagnosis.fitting.problem import FINE, LOST, Problem
from stickslip.diagnosis.terms.cause import Cause

USUAL = 0.6
"""Coordinate of an amplitude of the size that a cause usually has. Chosen."""

# A shape is tried at 1.5 standard deviations of its prior. A scan of a cause has at most so many
# places, of simulations fewer, and so many predictions. Chosen.
_SHAPES, _MOST_PLACES, _FEW_PLACES = (-1.5, 0.0, 1.5), 512, 64
# Multiple of a response up to which it is trusted, and largest move of a constant that makes up for
# one. Chosen: a response says little of amplitudes far beyond its own.
_MULTIPLE, _FAR = 1.8, 6.0
# Largest coordinate of an amplitude that does not surprise, and how far apart probes are. Chosen.
_UNSURPRISING, _STEP = 2.0, 3.0
# Responses to one cause that are returned. Chosen: only a scan has more.
_KEPT = 24


@dataclass(frozen=True, repr=False, eq=False)
class Response(OneLine):
    """A cause beside a fit, to first order.

    `x`, shape (size,), are the coordinates of its best amplitudes with the rest recalibrated, which
    lower the cost of misfit and prior by `gain`. `gaps`, shape (amplitudes, n), are changes of the
    predictions by one amplitude each, of sizes `values`. `base`, shape (n, fitted), are the slopes
    at the fit; with gaps they are the `columns` of the `free` ones with the cause. `tried`, shape
    (directions, n), are the changes by all that was tried of the cause, whatever the data; the
    opposite of those with `either` counts, too. `probe` is what this one tried.
    """

    cause: Cause
    x: Array
    gain: float
    gaps: Array
    values: Array
    base: Array
    columns: list[int]
    free: int
    tried: Array
    either: Mask
    probe: Probe

    @property
    def slopes(self) -> Array:
        """Slopes of the model with the cause, shape (n, free), to begin its fit with; made anew."""
        slopes = np.zeros((len(self.base), self.free), self.base.dtype)
        slopes[:, self.columns] = np.hstack([self.base, self.gaps.T / self.values])
        return slopes


@dataclass(frozen=True)
class Probe:
    """Amplitudes of a cause that are moved one at a time, to `values`, beside its shapes."""

    cause: Cause
    columns: list[int]
    values: list[float]
    shapes: dict[int, float]


def responses(
    problem: Problem, end: End, causes: Sequence[Cause], offered: Sequence[Cause], form: Form,
    h: Array, sizes: Sequence[float] = SMOOTH.amplitudes, cheap: bool = False,
    probes: Sequence[Probe] | None = None,
) -> list[Response]:  # fmt: skip
    """Responses of causes that are offered beside `causes`, which are fitted at `end`.

    By one batch of predictions, with `cheap` by the model of low fidelity. `form` and `h` are the
    inner product, `sizes` the coordinates at which amplitudes are tried, unless `probes` are given;
    those of the largest gain come first.
    """
    if probes is None:
        probes = [probe for cause in offered for probe in _probes(problem, cause, sizes)]
    groups = itertools.groupby(probes, key=lambda probe: probe.cause.name)
    every = [list(group) for _, group in groups]
    sizes_of = [len(group) * len(group[0].columns) for group in every]
    asked_cheap = cheap and problem.low_fidelity is not None and any(sizes_of)
    here = problem.residuals(end.x[None, :], True)[0] if asked_cheap else end.residual
    result = list[Response]()
    for some in batches(every, sizes_of, problem.at_once):
        gaps, first = _changes(problem, end.x, here, [p for group in some for p in group], cheap), 0
        for mine in some:
            effects = gaps[first : first + len(mine) * len(mine[0].columns)]
            first += len(effects)
            # Products of the slopes of what is fitted, the gaps, the residual; of gaps with each
            # other those of one probe alone.
            p, m = end.slopes.shape[1], max(len(mine[0].columns), 1)
            gram = np.zeros((p + len(effects) + 1,) * 2)
            for rows in _split(len(effects), m * max(problem.at_once // m, 1)):
                columns = np.column_stack([end.slopes, effects[rows].T, end.residual])
                at = np.r_[:p, p + np.arange(len(effects))[rows], -1]
                gram[np.ix_(at, at)] = form.weighted(form.prepared(columns), end.residual, h)
            result += _best(problem, end, causes, mine, gram, effects)
    return sorted(result, key=lambda response: -response.gain)


def _changes(
    problem: Problem, x: Array, here: Array, probes: Sequence[Probe], cheap: bool
) -> Array:
    """Changes of the predictions by one amplitude of each probe, shape (amplitudes, n)."""
    points = []
    for probe in probes:
        for column, value in zip(probe.columns, probe.values, strict=True):
            points.append(x.copy())
            points[-1][[*probe.shapes, column]] = [*probe.shapes.values(), value]
    if not points:
        return np.zeros((0, len(problem.y)))
    changes = np.empty((len(points), len(here)), problem.kept)
    for rows in _split(len(points), problem.at_once):
        moved = problem.residuals(np.array(points[rows]), cheap)
        lost = (moved == LOST * problem.sd) | (here == LOST * problem.sd)
        changes[rows] = np.where(lost, 0.0, np.subtract(here, moved, out=moved))
    return changes


def _split(count: int, most: int) -> list[slice]:
    return [slice(begin, begin + most) for begin in range(0, max(count, 1), most)]


def _probes(problem: Problem, cause: Cause, sizes: Sequence[float]) -> list[Probe]:
    low, high = problem.limits
    columns = problem.columns([cause]).tolist()
    shapes = [k for k in columns if not problem.parameters[k].is_amplitude and not cause.has_knots]
    moved = [k for k in columns if k not in shapes]
    signs = (1.0,) if all(0.0 in (low[k], high[k]) for k in moved) else (1.0, -1.0)
    fine = [k for k in columns if problem.fineness[k] <= FINE and (k in shapes or moved == [k])]
    usual = {k: np.unique(np.clip(_SHAPES, low[k], high[k])).tolist() for k in shapes}
    together: dict[str, list[int]] = {}  # starts in several records have one place
    for k in shapes:
        start, bracket, record = problem.names[k].rpartition("[")
        together.setdefault(start if bracket and record[-1] == "]" else record, []).append(k)
    grid = [_places(problem, fine, k) if k in fine else usual[k] for k, *_ in together.values()]
    if fine:
        sizes, signs = (USUAL,), (1.0,)
    if len(moved) > 1:
        sizes = [size for size in sizes if size <= _UNSURPRISING]
    amounts = [
        [within(sign * size, low[k], high[k]) for k in moved]
        for size, sign in itertools.product(sizes if moved else (0.0,), signs)
    ]
    if moved and moved[0] in fine:
        # An amplitude that turns its effect is looked through like a shape.
        amounts = [[place] for place in _places(problem, fine, moved[0]) if place != 0.0]
    return [Probe(cause, moved, amount, {k: place for ks, place in at for k in ks})
            for shape in itertools.product(*grid)
            for at in [[*zip(together.values(), shape, strict=True)]]
            for amount in amounts]  # fmt: skip


def within(size: float, low: float, high: float) -> float:
    """An amplitude of a size within its range, on the other side of zero if there is none here."""
    return float(np.clip(size, low, high) or np.clip(-size, low, high))


def _places(problem: Problem, fine: Sequence[int], k: int) -> tuple[float, ...]:
    """Places of a fine coordinate all over its range, as many as it and the other ones allow."""
    wanted = np.ptp(problem.scanned[:, fine], axis=0) / (2.0 * problem.fineness[fine])
    most = min(_MOST_PLACES if problem.oscillatory[fine].all() else _FEW_PLACES,
               4 * problem.at_once)  # fmt: skip
    thinner = max(float(np.prod(wanted)) / most, 1.0) ** (1.0 / len(fine))
    low, high = problem.scanned[:, k]
    count = max(math.ceil((high - low) / (2.0 * problem.fineness[k] * thinner)), 1)
    return tuple((low + (high - low) * (np.arange(count) + 0.5) / count).tolist())


def _best(
    problem: Problem, end: End, causes: Sequence[Cause], probes: Sequence[Probe], gram: Array,
    gaps: Array,
) -> list[Response]:  # fmt: skip
    """The amplitudes of the probes of a cause, within what is trusted, that lower the cost most.

    Of many probes, the best are returned.
    """
    cause, moved = probes[0].cause, probes[0].columns
    fitted, both = problem.free(causes), [*causes, cause]
    p, m, many = len(fitted), len(moved), len(probes)
    free = problem.free(both).tolist()
    values = np.array([probe.values for probe in probes]).reshape(many, m)
    places = np.array([list(probe.shapes.values()) for probe in probes]).reshape(many, -1)
    own = p + np.arange(many * m).reshape(many, m)
    used = np.hstack([np.tile(np.arange(p), (many, 1)), own])
    scale = np.hstack([np.ones((many, p)), 1.0 / values])
    inner = scale[:, :, None] * gram[used[:, :, None], used[:, None, :]] * scale[:, None, :]
    columns = [free.index(k) for k in (*fitted.tolist(), *moved)]
    precision = precision_of(problem, both)[np.ix_(columns, columns)]
    before, here = precision_of(problem, causes), end.x[fitted]
    curvature = inner + precision
    downhill = scale * gram[used, -1] - precision @ np.concatenate([here, np.zeros(m)])
    step = np.linalg.solve(curvature, downhill[..., None])[..., 0]
    least, most = _trusted(problem, probes[0], values)
    low, high = problem.limits[:, moved]
    least, most = np.minimum(least, most), np.maximum(least, most)
    amplitudes = np.clip(np.clip(step[:, p:], least, most), low, high)
    either = ((np.maximum(least, low) < 0.0) & (np.minimum(most, high) > 0.0)).reshape(-1)
    # The constants again for the amplitudes as they are.
    across = np.einsum("vij,vj->vi", curvature[:, :p, p:], amplitudes)
    rest = np.linalg.solve(curvature[:, :p, :p], (downhill[:, :p] - across)[..., None])[..., 0]
    rest = np.clip(rest, -_FAR, _FAR) if m else rest
    move = np.hstack([rest, amplitudes])
    relaxed = float(here @ (before - precision[:p, :p]) @ here)
    bent = np.einsum("vi,vij,vj->v", move, curvature, move)
    gain = 2.0 * np.sum(downhill * move, axis=1) - bent + relaxed - np.sum(places**2, axis=1)
    found = []
    for k in np.argsort(-gain, kind="stable")[:_KEPT].tolist():
        x, mine = end.x.copy(), gaps[k * m : (k + 1) * m]
        x[fitted] += rest[k]
        x[moved], x[[*probes[k].shapes]] = amplitudes[k], places[k]
        found.append(Response(cause, x, float(gain[k]), mine, values[k], end.slopes, columns,
                              len(free), gaps, either, probes[k]))  # fmt: skip
    return found


def _trusted(problem: Problem, probe: Probe, values: Array) -> tuple[Array, Array]:
    """Ends between which the response to amplitudes, (probes, amplitudes), tells that to others."""
    if len(probe.columns) == 1 and problem.fineness[probe.columns[0]] <= FINE:
        return values, values
    if np.any(problem.fineness[[*probe.shapes]] <= FINE):
        return -_MULTIPLE * values, _MULTIPLE * values  # no probe has the other sign
    # A single amplitude that surprises is looked for there; smaller ones have their own probes.
    alone = (np.abs(values) > _UNSURPRISING) & (values.shape[1] == 1)
    return np.where(alone, values / _STEP, 0.0), _MULTIPLE * values
