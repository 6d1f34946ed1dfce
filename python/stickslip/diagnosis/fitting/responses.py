"""What each further cause would do about a fit, and where its own fit should begin."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.text import OneLine
from stickslip.diagnosis.fitting.descent import End, precision_of
from stickslip.diagnosis.fitting.forms import Form
from stickslip.diagnosis.fitting.problem import LOST, Problem
from stickslip.diagnosis.terms.cause import Cause

USUAL = 0.6
AMPLITUDES = (0.15, USUAL, 2.0, 6.0)
"""Coordinates of amplitudes at which responses are taken, as piecewise smooth models have causes
without a slope at zero, and the way to a limit that binds may lead uphill. Chosen: a factor of
three to four apart, up to a size that surprises."""

FINE = 0.2
"""Part of its unit over which predictions change with a shape that is fine, such as the time of an
event. Chosen."""

# Of a shape: 1.5 standard deviations of its prior; chosen. Of a fine one a scan of so many places
# at most.
_SHAPES, _SCANNED = (-1.5, 0.0, 1.5), 64
# Multiple of a response up to which it is trusted, and largest move of a constant that makes up for
# one. Chosen: a response says little of amplitudes far beyond its own.
_MULTIPLE, _FAR = 1.8, 6.0
# Largest coordinate of an amplitude that does not surprise, and how far apart probes are. Chosen.
_UNSURPRISING, _STEP = 2.0, 3.0


@dataclass(frozen=True, repr=False, eq=False)
class Response(OneLine):
    """A cause beside a fit, to first order.

    `x`, shape (size,), are the coordinates of its best amplitudes with the rest recalibrated, which
    lower the cost of misfit and prior by `gain`. `gaps`, shape (amplitudes, n), are changes of the
    predictions by one amplitude each. `slopes`, shape (n, free), are those of the model with the
    cause, to begin its fit with.
    """

    cause: Cause
    x: Array
    gain: float
    gaps: Array
    slopes: Array


@dataclass(frozen=True)
class _Probe:
    """Amplitudes of a cause that are moved one at a time, to `values`, beside its shapes."""

    cause: Cause
    columns: list[int]
    values: list[float]
    shapes: dict[int, float]


def responses(
    problem: Problem,
    end: End,
    causes: Sequence[Cause],
    offered: Sequence[Cause],
    form: Form,
    h: Array,
    sizes: Sequence[float] = AMPLITUDES,
    draft: bool = False,
) -> list[Response]:
    """Responses of causes that are offered beside `causes`, which are fitted at `end`.

    By one batch of predictions, with `draft` of the problem's draft. `form` and `h` are the inner
    product, `sizes` the coordinates at which amplitudes are tried; those of the largest gain come
    first.
    """
    probes = [probe for cause in offered for probe in _probes(problem, cause, sizes)]
    points = []
    for probe in probes:
        for column, value in zip(probe.columns, probe.values, strict=True):
            points.append(end.x.copy())
            points[-1][[*probe.shapes, column]] = [*probe.shapes.values(), value]
    gaps = np.zeros((0, len(problem.y)))
    if points:
        drafted = draft and problem.draft is not None
        here = problem.residuals(end.x[None, :], True)[0] if drafted else end.residual
        moved = problem.residuals(np.array(points), draft)
        lost = (moved == LOST * problem.sd) | (here == LOST * problem.sd)
        gaps = np.where(lost, 0.0, here - moved)
    # One product for all: the slopes of what is fitted, the gaps, the residual.
    prepared = form.prepared(np.column_stack([end.slopes, gaps.T, end.residual]))
    gram = form.weighted(prepared, end.residual, h)
    result, at = [], end.slopes.shape[1]
    for probe in probes:
        rows = range(at, at + len(probe.columns))
        at += len(probe.columns)
        effects = gaps[rows.start - end.slopes.shape[1] : rows.stop - end.slopes.shape[1]]
        result.append(_best(problem, end, causes, probe, gram, rows, effects))
    return sorted(result, key=lambda response: -response.gain)


def _probes(problem: Problem, cause: Cause, sizes: Sequence[float]) -> list[_Probe]:
    low, high = problem.limits
    columns = problem.columns([cause]).tolist()
    shapes = [k for k in columns if not problem.parameters[k].is_amplitude and not cause.has_knots]
    moved = [k for k in columns if k not in shapes]
    signs = (1.0,) if all(0.0 in (low[k], high[k]) for k in moved) else (1.0, -1.0)
    places = [_SHAPES if problem.fineness[k] > FINE else _scanned(problem, k) for k in shapes]
    if any(shapes is not _SHAPES for shapes in places):
        sizes = (USUAL,)
    if len(moved) > 1:
        sizes = [size for size in sizes if size <= _UNSURPRISING]
    return [
        _Probe(
            cause,
            moved,
            [_within(sign * size, low[k], high[k]) for k in moved],
            dict(zip(shapes, shape, strict=True)),
        )
        for shape in itertools.product(*places)
        for size, sign in itertools.product(sizes if moved else (0.0,), signs)
    ]


def _within(size: float, low: float, high: float) -> float:
    """An amplitude of a size within its range, on the other side of zero if there is none here."""
    return float(np.clip(size, low, high) or np.clip(-size, low, high))


def _scanned(problem: Problem, k: int) -> tuple[float, ...]:
    """Places of a shape all over its range."""
    low, high = np.clip(problem.limits[:, k], -3.0, 3.0)
    count = min(math.ceil((high - low) / (2.0 * problem.fineness[k])), _SCANNED)
    return tuple((low + (high - low) * (np.arange(count) + 0.5) / count).tolist())


def _best(
    problem: Problem,
    end: End,
    causes: Sequence[Cause],
    probe: _Probe,
    gram: Array,
    rows: range,
    gaps: Array,
) -> Response:
    """The amplitudes of a probe, within what is trusted, that lower the cost most."""
    fitted, both = problem.free(causes), [*causes, probe.cause]
    p, values = len(fitted), np.array(probe.values)
    free = problem.free(both).tolist()
    used = [*range(p), *rows]
    scale = np.concatenate([np.ones(p), 1.0 / values])
    inner = scale[:, None] * gram[np.ix_(used, used)] * scale
    along = scale * gram[used, -1]
    columns = [free.index(k) for k in (*fitted.tolist(), *probe.columns)]
    precision = precision_of(problem, both)[np.ix_(columns, columns)]
    before = precision_of(problem, causes)
    here = end.x[fitted]
    curvature = inner + precision
    downhill = along - precision @ np.concatenate([here, np.zeros(len(rows))])
    step = np.linalg.solve(curvature, downhill)
    low, high = problem.limits[:, probe.columns]
    # A single amplitude that surprises is looked for there; smaller ones have their own probes.
    least = values / _STEP if len(rows) == 1 and abs(values[0]) > _UNSURPRISING else 0.0 * values
    ends = np.sort(np.stack([least, _MULTIPLE * values]), axis=0)
    amplitudes = np.clip(np.clip(step[p:], *ends), low, high)
    # The constants again for the amplitudes as they are.
    rest = np.linalg.solve(curvature[:p, :p], downhill[:p] - curvature[:p, p:] @ amplitudes)
    rest = np.clip(rest, -_FAR, _FAR) if probe.columns else rest
    move = np.concatenate([rest, amplitudes])
    freed = float(here @ (before - precision[:p, :p]) @ here)
    price = float(sum(value**2 for value in probe.shapes.values()))
    gain = float(2.0 * downhill @ move - move @ curvature @ move) + freed - price
    x = end.x.copy()
    x[fitted] += rest
    x[probe.columns] = amplitudes
    x[list(probe.shapes)] = list(probe.shapes.values())
    slopes = np.zeros((len(end.residual), len(free)))
    slopes[:, columns] = np.hstack([end.slopes, gaps.T / values])
    return Response(probe.cause, x, gain, gaps, slopes)
