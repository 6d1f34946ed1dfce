"""Frames folded on the drive's phase: a fixed linear map from frames to a few observables.

As the map is linear and the same for measured and simulated frames, nothing that it blurs can bias
a comparison: both are blurred alike.

The noise of frames is that of other readings, see `noise`: free is what repeats with the drive, and
the frames of a period share an error. Few periods tell its size badly, and the error of the advance
with it: the degrees of freedom are a mean over all observables.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.linalg import block_diag, lstsq
from scipy.sparse import csr_array, hstack
from scipy.special import ndtr
from scipy.stats import chi2 as chi2_law

from stickslip._util.arrays import Array, Indices, Mask
from stickslip.diagnosis.data.errors import FEWEST
from stickslip.diagnosis.data.noise import Draws, Noise, along, averaged, whitener
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
) -> tuple[Draws, bool, float] | None:
    """Draws of the noise of frames, whether it is as stated, and what is seen.

    Draws have the shape (draws,): ``s2``, the variance of a frame, ``phi``, ``shared2``, the
    variance of what a period shares, and their ``weight``. What is seen is the standard deviation
    of a frame that the frames show. None where they leave fewer than four degrees of freedom.

    `residual`, shape (n,), is frames minus a prediction; its errors depend on the phase and the
    advance alone. `place`, shape (n,), is the number of each frame in the film: a lost one is a
    gap. `kind` is as for `reduce`; `rocking` is the frequency of the fastest rocking over that of
    the drive. The `stated` standard deviation of a frame is used, unless the frames clearly
    scatter more.
    """
    steady = folded.steady & (folded.cycle < _MOST_PERIODS)
    folded = Fold(folded.bin, steady, folded.phase, np.where(steady, folded.cycle, 0))
    y, count = residual[steady], int(np.sum(steady))
    size = float(np.max(np.abs(y), initial=0.0))
    if count < FEWEST or size == 0.0:
        return None
    knots = int(np.clip(_KNOTS * rocking, PHASES, _MOST_KNOTS))
    free = hstack([_splines(folded.phase[steady], knots), folded.cycle[steady, None] / count])
    free = csr_array(free if kind == "drift" else free.tocsr()[:, :-1])
    # Few phases leave knots without frames.
    fitted, _, rank, _ = lstsq((free.T @ free).toarray(), free.T @ y, cond=1e-9)
    left = count - int(rank)
    if left < FEWEST:
        return None
    away = y - free @ fitted
    unit = max(float(np.linalg.norm(away)) / math.sqrt(left), np.finfo(float).eps * size)
    of, covariance = _shared(folded, kind)
    usual = of.shape[1] / count
    shared = {"period": (of[steady], usual * covariance)} if len(covariance) else {}
    gap = np.diff(place[steady], prepend=-math.inf)
    one = np.zeros(count, dtype=np.int64)
    p, weight = Noise(away / unit, free, one, np.array([left]), gap, None, shared).draws(0)
    s2 = unit**2 * np.exp(2.0 * p["s0"])
    shared2 = s2 * usual * np.exp(2.0 * p["period"]) if shared else 0.0 * s2
    seen = float(weight @ s2)
    believed = stated is not None and chi2_law.sf(left * seen / stated**2, left) > _UNLIKELY
    if stated is not None and believed:
        s2 = np.full(len(s2), stated**2)
    draws = {"s2": s2, "phi": ndtr(p["phi"]), "shared2": shared2, "weight": weight}
    return draws, believed, math.sqrt(seen)


def _splines(phase: Array, knots: int) -> csr_array:
    """Periodic cubic B-splines, shape (n, knots)."""
    left = np.floor(phase * knots)
    u = phase * knots - left
    values = np.stack([(1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, 3 * (u + u**2 - u**3) + 1, u**3])
    columns = (left + np.arange(4)[:, None]).astype(np.int64) % knots
    rows = np.tile(np.arange(len(phase)), 4)
    return csr_array((values.ravel() / 6, (rows, columns.ravel())), (len(phase), knots))


def _shared(folded: Fold, kind: Kind) -> tuple[csr_array, Array]:
    """Period of each frame, shape (n, periods), and the covariance of what periods share.

    Each shares a shift; of a drift, each adds to the advance of all later ones. One period alone
    shares nothing that its own bins do not hold.
    """
    periods = int(folded.cycle.max(initial=0)) + 1
    rows = np.flatnonzero(folded.steady)
    shape = (len(folded.bin), periods)
    of = csr_array((np.ones(len(rows)), (rows, folded.cycle[rows])), shape)
    if not folded.advances:
        return of[:, :0], np.zeros((0, 0))
    if kind != "drift":
        return of, np.eye(periods)
    return of[:, 1:], np.tri(periods - 1) @ np.tri(periods - 1).T


def reduce(folded: Fold, place: Indices, kind: Kind, draws: Draws) -> tuple[Array, Array, float]:
    """Matrix that maps frames to observables, shape (k, n), their covariance and its degrees.

    By generalised least squares. The observables of a ``"level"`` are means in every bin. The
    origin of a ``"place"`` is not known, so its bins count from the mean of the steady ones (of
    all, if there are none). A ``"drift"`` advances from period to period as well; the advance comes
    first, if two periods show it, and the bins are what is left.

    `place` and `draws` are those of `frame_errors`.
    """
    weight = draws["weight"]
    phi, share = float(weight @ draws["phi"]), weight @ draws["shared2"] / (weight @ draws["s2"])
    bins = np.eye(int(folded.bin.max()) + 1)[folded.bin]
    drifts = kind == "drift" and folded.advances
    # Whole periods: within a period the bins hold everything, so the two are independent.
    design = np.column_stack([folded.cycle, bins]) if drifts else bins
    of, covariance = _shared(folded, kind)
    gap = np.diff(place, prepend=-math.inf)
    white = whitener(gap, phi).T
    columns, groups = white @ design, white @ of
    # Woodbury: the inverse of the covariance without a matrix of frames by frames.
    inner = np.eye(len(covariance)) + share * covariance @ (groups.T @ groups)
    weighted = columns - groups @ np.linalg.solve(inner, share * covariance @ (groups.T @ columns))
    solution = np.linalg.solve(columns.T @ weighted, weighted.T)
    matrix = _contrasts(folded, kind, drifts) @ (white.T @ solution.T).T
    common, ones = matrix @ of, np.ones((len(weight), len(matrix)))
    parts = along(matrix, gap, draws["phi"], weight, np.sqrt(draws["s2"])[:, None] * ones)
    parts.append((common @ covariance @ common.T, draws["shared2"], ones))
    means, factor, dof = averaged(parts, weight)
    return matrix, factor * np.sum(means, axis=0), dof


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
