"""Frames folded on the drive's phase: a fixed linear map from frames to a few observables.

As the map is linear and the same for measured and simulated frames, nothing that it blurs can bias
a comparison: both are blurred alike.

The errors of frames have one model,

    y = X b + s (e + Z u),

where X is what repeats with the drive, e has variance 1 and the correlation phi of neighbouring
frames, and Z u is shared by the frames of a period. Restricted likelihood, linear in the number of
frames, tells s, phi and the size of u, as `errors` has it for other tables. Few periods tell the
size of u badly, and the error of the advance with it: the degrees of freedom are a mean over all
observables.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.linalg import block_diag, cholesky, solve_banded, solve_triangular
from scipy.sparse import csr_array, dia_array, hstack
from scipy.special import ndtr
from scipy.stats import chi2 as chi2_law

from stickslip._util.arrays import Array, Indices, Mask
from stickslip.diagnosis.data.errors import FEWEST, sample, satterthwaite
from stickslip.scenario.scenario import Scenario

Kind = Literal["level", "place", "drift"]

PHASES = 24
"""Bins of a period; they hold about one rocking of 421 Hz each at 17 Hz."""

_RAMP, _FIRST, _PROGRAM = 6, 4, 24
"""Bins of the ramp, of each pulse before the steady walk, and of a program of voltages. Chosen:
they resolve the first rise, give the transient less weight than the walk, and are as many as of a
period."""

_KNOTS, _MOST_KNOTS = 4.0, 400
"""Knots of what repeats with the drive, in a period of the fastest rocking. Chosen: a cubic spline
errs by a tenth of its amplitude there, and by a hundredth at half of that frequency."""

_MOST_PERIODS = 40
"""Periods that tell the errors. Chosen: they tell what periods share to 11 %, and more would only
cost time."""

_UNLIKELY = 1e-3
"""p-value below which a stated noise is not believed. Chosen: of ten films that state it rightly
one in 100 is rejected by chance."""

_NODES, _NEGLIGIBLE = 9, 1e-4
"""Correlations at which covariances are computed, and the weight of draws, in the largest, that do
not count for their range. Chosen: variances err by less than a hundredth."""

_LONGEST, _LARGEST = 0.999, 1e3
"""Correlation of neighbours beyond which a film is one error, and size of what periods share, in
errors of a frame, beyond which nothing else is known. Chosen."""


@dataclass(frozen=True, eq=False)
class Fold:
    """Which bin each frame falls into.

    Bins before the steady walk, which begins after the third pulse, are intervals of time: the
    ramp, which shows the first rise, and the first pulses, which show the transient. Later bins are
    intervals of the drive's phase.

    All arrays have shape (n,). `bin` is numbered from 0 without gaps, the steady walk last. `phase`
    of the drive, 0 to 1, and `cycle`, whole periods since the walk began, are 0 before.
    """

    bin: Indices
    steady: Mask
    phase: Array
    cycle: Indices

    @property
    def by_phase(self) -> Indices:
        """Steady frames in the order of their phase."""
        steady = np.flatnonzero(self.steady)
        return steady[np.argsort(self.phase[steady], kind="stable")]

    @property
    def advances(self) -> bool:
        """Whether some bin is seen in two periods, without which there is no advance to measure."""
        seen = np.unique(np.stack([self.bin, self.cycle])[:, self.steady], axis=1)[0]
        return bool(seen.size and np.max(np.bincount(seen)) > 1)


def fold(times: Array, scenario: Scenario) -> Fold:
    """Fold frame times, s, on the drive of their scenario.

    A program of voltages has no phase: all of it is bins of time.
    """
    start, end = scenario.window
    drive = scenario.drive
    if drive.kind == "program":
        edges = np.linspace(start, end, _PROGRAM + 1)[1:-1]
        none = np.zeros(len(times))
        return Fold(_numbered(np.searchsorted(edges, times, side="right")), none > 0.0, none,
                    none.astype(np.int64))  # fmt: skip
    # A frame at the very start is steady, however the sum of the pulses was rounded.
    steady = times > start - 1e-9
    periods = np.where(steady, (times - start) * scenario.pulse_rate + 1e-9, 0.0)
    cycle = np.floor(periods).astype(np.int64)
    begin = drive.latency + drive.ramp
    ramp = np.linspace(drive.latency, begin, _RAMP + 1)[1:]
    step = 1.0 / (_FIRST * scenario.pulse_rate)
    edges = np.concatenate([ramp, np.arange(begin, start, step)[1:]])
    label = np.searchsorted(edges, times, side="right")
    label = np.where(steady, len(edges) + 1 + np.floor((periods - cycle) * PHASES), label)
    return Fold(_numbered(label), steady, periods - cycle, cycle)


def _numbered(label: Array | Indices) -> Indices:
    """Labels numbered from 0 without gaps, in their order."""
    return np.unique(label, return_inverse=True)[1].astype(np.int64)


def undrifted(folded: Fold, residual: Array) -> Array:
    """Residuals, shape (n,), without their advance from period to period.

    It is the median of neighbours in phase: so what depends on the phase is kept, and a few wild
    frames change nothing.
    """
    order = folded.by_phase
    periods = np.diff(folded.cycle[order])
    some = periods != 0
    if not some.any():
        return residual
    advance = float(np.median(np.diff(residual[order])[some] / periods[some]))
    return np.asarray(residual - advance * folded.cycle)


def frame_errors(
    folded: Fold, residual: Array, place: Indices, kind: Kind, rocking: float, stated: float | None
) -> tuple[dict[str, Array], float, float] | None:
    """Draws of the errors' hyperparameters, the degrees of freedom of their size, and what is seen.

    Draws have the shape (draws,): ``s2``, the variance of a frame, ``phi``, ``shared2``, the
    variance of what a period shares, and their ``weight``. The degrees of freedom are infinite
    where the noise is as stated. What is seen is the standard deviation of a frame that the frames
    show. None where the frames leave fewer than four degrees of freedom.

    `residual`, shape (n,), is frames minus a prediction; its errors depend on the phase and the
    advance alone. `place`, shape (n,), is the number of each frame in the film: a lost one is a
    gap. `kind` is as for `reduce`; `rocking` is the frequency of the fastest rocking over that of
    the drive. The `stated` standard deviation of a frame is used, unless the frames clearly
    scatter more.
    """
    steady = folded.steady & (folded.cycle < _MOST_PERIODS)
    folded = Fold(folded.bin, steady, folded.phase, np.where(steady, folded.cycle, 0))
    count, size = int(np.sum(steady)), float(np.max(np.abs(residual[steady]), initial=0.0))
    if count < FEWEST or size == 0.0:
        return None
    knots = int(np.clip(_KNOTS * rocking, PHASES, _MOST_KNOTS))
    free = hstack([_splines(folded.phase[steady], knots), folded.cycle[steady, None] / count])
    free = free if kind == "drift" else free[:, :-1]
    # The columns are orthogonal, and as many as their rank: few phases leave knots without frames.
    values, axes = np.linalg.eigh((free.T @ free).toarray())
    axes = axes[:, values > 1e-9 * values[-1]]
    left = count - axes.shape[1]
    if left < FEWEST:
        return None
    shared, parts = _shared(folded, kind)
    target = csr_array(residual[steady, None] / size)
    grams = _grams(hstack([free, shared[steady], target], format="csr"), place[steady],
                   block_diag(axes, parts, 1.0))  # fmt: skip
    usual = math.sqrt(shared.shape[1] / count)

    def ratio(p: dict[str, Array]) -> Array:
        if "period" not in p:
            return np.zeros(len(p["phi"]))
        return np.minimum(usual * np.exp(p["period"]), _LARGEST)

    def likelihood(p: dict[str, Array]) -> Array:
        """ln of the determinants, and the sum of squares, shape (2, draws)."""
        pairs = zip(ndtr(p["phi"]), ratio(p), strict=True)
        return np.array([_solved(grams, *pair, axes.shape[1]) for pair in pairs]).T

    def loss(p: dict[str, Array]) -> Array:
        determinants, squares = likelihood(p)
        return np.asarray(determinants + left * np.log(squares))

    p, weight = sample(loss, ["phi", "period"] if parts.shape[1] else ["phi"], 0)
    s2, dof = likelihood(p)[1] * size**2 / left, float(left)
    seen, shared2 = float(weight @ s2), s2 * ratio(p) ** 2
    if stated is not None and chi2_law.sf(left * seen / stated**2, left) > _UNLIKELY:
        s2, dof = np.full(len(s2), stated**2), math.inf
    draws = {"s2": s2, "phi": ndtr(p["phi"]), "shared2": shared2, "weight": weight}
    return draws, dof, math.sqrt(seen)


def _splines(phase: Array, knots: int) -> csr_array:
    """Periodic cubic B-splines, shape (n, knots)."""
    left = np.floor(phase * knots)
    u = phase * knots - left
    values = np.stack([(1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, 3 * (u + u**2 - u**3) + 1, u**3])
    columns = (left + np.arange(4)[:, None]).astype(np.int64) % knots
    rows = np.tile(np.arange(len(phase)), 4)
    return csr_array((values.ravel() / 6, (rows, columns.ravel())), (len(phase), knots))


def _shared(folded: Fold, kind: Kind) -> tuple[csr_array, Array]:
    """Period of each frame, shape (n, periods), and what periods share as their combinations.

    Each shares a shift; of a drift, each adds to the advance of all later ones. One period alone
    shares nothing that its own bins do not hold.
    """
    periods = int(folded.cycle.max(initial=0)) + 1
    rows = np.flatnonzero(folded.steady)
    shape = (len(folded.bin), periods)
    of = csr_array((np.ones(len(rows)), (rows, folded.cycle[rows])), shape)
    if not folded.advances:
        return of, np.zeros((periods, 0))
    return of, np.tri(periods)[:, 1:] if kind == "drift" else np.eye(periods)


def _grams(columns: csr_array, place: Indices, combined: Array) -> list[tuple[float, int, Array]]:
    """Products of combined columns among frames a distance apart, with it and their number.

    The frames' own, those with the ones before, and those of the latter: shape (3, k, k).
    """

    def products(one: csr_array, before: csr_array) -> Array:
        across = (one.T @ before).toarray()
        grams = [(one.T @ one).toarray(), across + across.T, (before.T @ before).toarray()]
        return np.array([combined.T @ gram @ combined for gram in grams])

    gap = np.diff(place)
    result = [(math.inf, 1, products(columns[:1], 0.0 * columns[:1]))]
    for distance in np.unique(gap).tolist():
        at = np.flatnonzero(gap == distance)
        result.append((float(distance), len(at), products(columns[at + 1], columns[at])))
    return result


def _solved(
    grams: list[tuple[float, int, Array]], phi: float, ratio: float, free: int
) -> tuple[float, float]:
    """By Henderson's mixed-model equations, ln of the determinants and the sum of squares."""
    determinant, normal = 0.0, np.zeros(grams[0][2].shape[1:])
    for gap, count, (alone, across, before) in grams:
        link = min(phi, _LONGEST) ** gap
        determinant += count * math.log(1.0 - link**2)
        normal += (alone - link * across + link**2 * before) / (1.0 - link**2)
    scale = np.ones(len(normal))
    scale[free:-1] = ratio
    normal *= np.outer(scale, scale)
    normal[range(free, len(normal) - 1), range(free, len(normal) - 1)] += 1.0
    factor = cholesky(normal[:-1, :-1], lower=True, check_finite=False)
    fitted = solve_triangular(factor, normal[:-1, -1], lower=True, check_finite=False)
    # Frames without noise leave what rounding makes of the difference, of either sign.
    rounding = len(normal) * np.finfo(float).eps * normal[-1, -1]
    left = max(float(normal[-1, -1] - fitted @ fitted), rounding)
    return determinant + 2.0 * float(np.sum(np.log(np.diag(factor)))), left


def reduce(
    folded: Fold, place: Indices, kind: Kind, draws: dict[str, Array], dof: float
) -> tuple[Array, Array, float]:
    """Matrix that maps frames to observables, shape (k, n), their covariance and its degrees.

    By generalised least squares. The observables of a ``"level"`` are means in every bin. The
    origin of a ``"place"`` is not known, so its bins count from the mean of the steady ones (of
    all, if there are none). A ``"drift"`` advances from period to period as well; the advance comes
    first, if two periods show it, and the bins are what is left.

    `place`, `draws` and `dof` are those of `frame_errors`.
    """
    weight = draws["weight"]
    phi, share = float(weight @ draws["phi"]), weight @ draws["shared2"] / (weight @ draws["s2"])
    bins = np.eye(int(folded.bin.max()) + 1)[folded.bin]
    drifts = kind == "drift" and folded.advances
    # Whole periods: within a period the bins hold everything, so the two are independent.
    design = np.column_stack([folded.cycle, bins]) if drifts else bins
    of, parts = _shared(folded, kind)
    banded = _whitening(place, phi)
    white = dia_array((banded, [1, 0]), shape=(len(place),) * 2).T
    columns, groups = white @ design, white @ of
    # Woodbury: the inverse of the covariance without a matrix of frames by frames.
    inner = np.eye(parts.shape[1]) + share * parts.T @ (groups.T @ groups) @ parts
    across = parts @ np.linalg.solve(inner, share * parts.T @ (groups.T @ columns))
    weighted = columns - groups @ across
    solution = np.linalg.solve(columns.T @ weighted, weighted.T)
    matrix = _contrasts(folded, kind, drifts) @ (white.T @ solution.T).T
    common = matrix @ (of @ parts)
    both = common @ common.T
    # The covariance is smooth in phi, so that a few nodes tell it for all draws.
    likely = draws["phi"][weight > _NEGLIGIBLE * np.max(weight)]
    nodes = np.unique(np.linspace(np.min(likely), np.max(likely), _NODES))
    near = np.array([np.interp(draws["phi"], nodes, unit) for unit in np.eye(len(nodes))])
    halves = [solve_banded((0, 1), _whitening(place, node), matrix.T) for node in nodes.tolist()]
    blocks = np.array([half.T @ half for half in halves])
    mean = np.tensordot(near @ (weight * draws["s2"]), blocks, 1) + weight @ draws["shared2"] * both
    inverse = np.linalg.inv(mean) / len(mean)
    scale = draws["s2"] * (np.tensordot(blocks, inverse, 2) @ near)
    scale += draws["shared2"] * np.sum(inverse * both)
    factor, of_draws = satterthwaite(scale, weight)
    # What the draws leave of the size, and s itself.
    return matrix, factor * mean, 1.0 / (1.0 / of_draws + 1.0 / max(dof, 1e-9))


def _whitening(place: Indices, phi: float) -> Array:
    """Upper diagonal, and the diagonal, of the transpose of what makes errors independent."""
    link = min(phi, _LONGEST) ** np.diff(place).astype(float)
    size = np.concatenate([[1.0], np.sqrt(1.0 - link**2)])
    return np.stack([np.concatenate([[0.0], -link / size[1:]]), 1.0 / size])


def _contrasts(folded: Fold, kind: Kind, drifts: bool) -> Array:
    """Observables as combinations of the columns of a design."""
    count = int(folded.bin.max()) + 1
    if kind == "level":
        return np.eye(count)
    origin = np.zeros(count)
    steady = np.unique(folded.bin[folded.steady])
    origin[steady if len(steady) else slice(None)] = 1.0
    contrast = (np.eye(count) - origin / origin.sum())[:-1]
    return np.asarray(block_diag(1.0, contrast) if drifts else contrast)
