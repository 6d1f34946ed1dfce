"""Frames folded on the drive's phase: a fixed linear map from frames to a few observables.

As the map is linear and the same for measured and simulated frames, nothing that it blurs can bias
a comparison: both are blurred alike.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from stickslip._util.arrays import Array, Indices, Mask
from stickslip._util.root_mean_square import root_mean_square
from stickslip.diagnosis.data.autoregression import (
    FEWEST_FREE,
    ErrorCorrelation,
    Runs,
    averaged,
    likeliest,
)
from stickslip.diagnosis.data.trial_noise import column_basis
from stickslip.scenario.scenario import Scenario

Kind = Literal["level", "place", "drift"]

PHASES = 24
"""Bins of a period; they hold about one rocking of 421 Hz each at 17 Hz."""

SAME_PHASE = 2e-3
"""Frames whose phases differ by less see the same, in periods. Chosen: a rocking of 421 Hz turns by
a twentieth of its period in it, at 17 Hz."""

_RAMP, _FIRST = 6, 4
"""Bins of the ramp, and of each pulse before the steady walk. Chosen: they resolve the first tilt,
and give the transient less weight than the walk."""

_PROGRAM = 24
"""Bins of a program of voltages. Chosen: as many as of a period."""

_BENT = 5.0
"""Mean square of a bin over the median bin's beyond which it is curvature of the motion and no
noise. Chosen: three frames of noise alone exceed it once in 500 bins."""

_WORTH = 4.0
"""Gain of twice the log-likelihood that a scatter of periods has to bring. Chosen: p = 0.02 for a
variance at the edge of its range."""

_RATIOS = np.geomspace(1e-4, 1e4, 161)
"""Squared scatters of periods over that of frames that are tried. Chosen: 12 % apart."""


@dataclass(frozen=True, eq=False)
class Fold:
    """Which bin each frame falls into.

    Bins before the steady walk are intervals of time: the ramp, which shows the first tilt, and the
    first pulses, which show the transient. Later bins are intervals of the drive's phase.

    All arrays have shape (n,). `bin` is numbered from 0 without gaps, the steady walk last, which
    begins after the third pulse. `phase` of the drive, 0 to 1, and `cycle`, periods since it began
    as a real number, are 0 before. `period` is in s.
    """

    bin: Indices
    steady: Mask
    phase: Array
    cycle: Array
    period: float

    @property
    def first_steady(self) -> int:
        """Number of the first bin of the steady walk."""
        steady = self.bin[self.steady]
        return int(steady.min()) if len(steady) else int(self.bin.max()) + 1

    @property
    def cycles(self) -> Indices:
        """Whole periods since the steady walk began."""
        return np.floor(self.cycle + 1e-9).astype(np.int64)

    def distinct(self) -> int:
        """How many different phases of the steady walk are seen."""
        phase = np.sort(self.phase[self.steady])
        return int(np.sum(np.diff(phase) > SAME_PHASE)) + 1 if len(phase) else 0


def fold(times: Array, scenario: Scenario) -> Fold:
    """Fold frame times, s, on the drive of their scenario.

    A program of voltages has no phase: all of it is bins of time.
    """
    start, end = scenario.window
    drive = scenario.drive
    if drive.mode == "program":
        edges = np.linspace(start, end, _PROGRAM + 1)[1:-1]
        label = np.searchsorted(edges, times, side="right")
        none = np.zeros(len(times))
        return Fold(_numbered(label), none > 0.0, none, none, np.inf)
    period = 1.0 / drive.frequency
    # A frame at the very start is steady, however the sum of the pulses was rounded.
    steady = times > start - 1e-9
    cycle = np.where(steady, (times - start) / period, 0.0)
    phase = np.where(steady, np.mod(cycle + 1e-9, 1.0), 0.0)
    ramp = np.linspace(0.0, drive.ramp, _RAMP + 1)[1:]
    edges = np.concatenate([ramp, np.arange(drive.ramp, start, period / _FIRST)[1:]])
    label = np.searchsorted(edges, times, side="right")
    label = np.where(steady, len(edges) + 1 + np.floor(phase * PHASES), label)
    return Fold(_numbered(label), steady, phase, cycle, period)


def _numbered(label: NDArray[Any]) -> Indices:
    """Labels numbered from 0 without gaps, in their order."""
    return np.unique(label, return_inverse=True)[1].astype(np.int64)


def reduce(
    folded: Fold,
    kind: Kind,
    sd: float,
    cycle_sd: float = 0.0,
    independent: FrameErrors | None = None,
) -> tuple[Array, Array]:
    """Matrix that maps frames to observables, shape (k, n), and the observables' covariance.

    By generalised least squares with the correlation of the errors.

    The observables of a ``"level"`` are means in every bin. The origin of a ``"place"`` is not
    known, so its bins count from the mean of the steady ones (of all, if there are none). A
    ``"drift"`` advances from period to period as well; the advance comes first, if two periods show
    it, and the bins are what is left.

    `sd` is the noise of one frame. `cycle_sd` is common to all frames of a period: of a "drift" the
    scatter of its advance, whose sum is a random walk; else an independent shift of each period.
    `independent` takes errors that follow each other to independent ones.
    """
    independent = independent or FrameErrors(np.arange(len(folded.bin)))
    design = independent.of(_design(folded, kind))
    shared = independent.of(_shared(folded, kind) * cycle_sd)
    # Woodbury: the inverse of sd^2 + Z Z^T without a matrix of frames by frames.
    inner = np.eye(shared.shape[1]) * sd**2 + shared.T @ shared
    weighted = design - shared @ np.linalg.solve(inner, shared.T @ design)
    normal = design.T @ weighted
    wanted = _contrasts(folded, kind)
    matrix = wanted @ independent.transposed(
        np.asarray(np.linalg.solve(normal, weighted.T), dtype=float)
    )
    if not independent.points.size:
        return matrix, wanted @ (sd**2 * np.linalg.inv(normal)) @ wanted.T
    common = matrix @ _shared(folded, kind) * cycle_sd
    return matrix, sd**2 * independent.covariance(matrix) + common @ common.T


@dataclass(frozen=True, eq=False)
class FrameErrors:
    """First-order correlation of the errors of the frames of a film.

    `place`, shape (n,), is the number of each frame in the film, so that a lost one is a gap.
    `points` are equally probable correlations, from 0 to 1; none where errors are independent.
    """

    place: Indices
    correlation: float = 0.0
    points: Array = field(default_factory=lambda: np.zeros(0))

    def covariance(self, matrix: Array) -> Array:
        """Covariance of what a matrix, shape (k, n), makes of unit errors, see `averaged`."""
        found = []
        gap = np.diff(self.place).astype(float)
        for each in self.points.tolist():
            # From the last frame back, what each innovation adds to it and to all later ones.
            link = each**gap
            parts = np.array(matrix)
            for k in range(len(gap) - 1, -1, -1):
                parts[:, k] += link[k] * parts[:, k + 1]
            parts *= np.concatenate([[1.0], np.sqrt(1.0 - link**2)])
            found.append(parts @ parts.T)
        return averaged(np.array(found))

    def of(self, columns: Array) -> Array:
        """Columns, shape (n, k), in which the errors are independent."""
        runs = Runs(np.zeros(len(self.place), dtype=np.int64), self.place.astype(float))
        return runs.whitened(columns, self.correlation)

    def transposed(self, rows: Array) -> Array:
        """Rows, shape (k, n), for such columns, as those for the frames themselves."""
        link = self.correlation ** np.diff(self.place).astype(float)
        size = np.concatenate([[1.0], np.sqrt(1.0 - link**2)])
        scaled = rows / size
        scaled[:, :-1] -= link * scaled[:, 1:]
        return np.asarray(scaled)


def correlation_of_frames(
    folded: Fold, residual: Array, kind: Kind, place: Indices
) -> ErrorCorrelation | None:
    """Correlation of the errors of frames that follow each other; None of too few frames.

    `residual` is as for `frame_noise`. Free are a level for each phase and a shift or an advance of
    each period: what repeats with the drive is the motion, and a camera's error does not. Of
    programs of voltages, which repeat nothing, it is not known.
    """
    steady = folded.steady
    if not steady.any():
        return None
    walk = _finer(folded)
    design = np.hstack([_design(walk, kind), _shared(walk, kind)])[steady]
    basis = column_basis(design[:, np.any(design != 0.0, axis=0)])
    if int(steady.sum()) - basis.shape[1] < FEWEST_FREE:
        return None
    runs = Runs(np.zeros(int(steady.sum()), dtype=np.int64), place[steady].astype(float))
    return likeliest(residual[steady], basis, runs, "repeats")


def _design(folded: Fold, kind: Kind) -> Array:
    bins = np.eye(int(folded.bin.max()) + 1)[folded.bin]
    if kind == "drift" and _advances(folded):
        # Whole periods: within a period the bins hold everything, so the two are independent.
        return np.hstack([folded.cycles[:, None].astype(float), bins])
    return bins


def _advances(folded: Fold) -> bool:
    """Whether some phase is seen in two periods, without which there is no advance to measure."""
    seen = np.unique(np.stack([folded.bin, folded.cycles])[:, folded.steady], axis=1)
    return bool(np.any(np.bincount(seen[0]) > 1)) if seen.size else False


def _contrasts(folded: Fold, kind: Kind) -> Array:
    count, first = int(folded.bin.max()) + 1, folded.first_steady
    if kind == "level":
        return np.eye(count)
    origin = np.zeros(count)
    kept = np.arange(count) != count - 1
    origin[first if first < count else 0 :] = 1.0
    contrast = (np.eye(count) - origin / origin.sum())[kept]
    if kind == "drift" and _advances(folded):
        rows = np.zeros((count, count + 1))
        rows[0, 0] = 1.0
        rows[1:, 1:] = contrast
        return rows
    return np.asarray(contrast)


def _shared(folded: Fold, kind: Kind) -> Array:
    """What the frames of a period have in common, a column for each period."""
    if not folded.steady.any():
        return np.zeros((len(folded.bin), 1))
    cycle = folded.cycles
    numbers = np.arange(int(cycle.max()) + 1)
    if kind == "drift":
        return ((cycle[:, None] >= numbers[1:]) & folded.steady[:, None]).astype(float)
    return np.asarray(((cycle[:, None] == numbers) & folded.steady[:, None]).astype(float))


def undrifted(folded: Fold, residual: Array) -> Array:
    """Residuals without a steady change from period to period.

    It is estimated from frames of the same phase, so that what depends on the phase is kept.
    """
    finer = _finer(folded)
    bins, cycle = finer.bin[folded.steady], folded.cycles[folded.steady].astype(float)
    if not len(bins):
        return residual
    bins = bins - bins.min()
    count = np.maximum(np.bincount(bins), 1)
    within = cycle - (np.bincount(bins, cycle) / count)[bins]
    power = float(within @ within)
    slope = float(within @ residual[folded.steady]) / power if power > 0.0 else 0.0
    return np.asarray(residual - slope * np.where(folded.steady, folded.cycles, 0.0))


def frame_noise(folded: Fold, residual: Array) -> tuple[float, float]:
    """Standard deviation of one frame from repeats of a phase, and its degrees of freedom.

    `residual`, shape (n,), are frames minus a prediction, whose errors may only depend on the
    phase. Commensurate rates show the same few phases again and again, and their scatter is the
    noise. Else each frame is compared with the line between its neighbours in phase; bins whose
    scatter is far above the others' are left out, as the motion is curved between neighbours there.
    """
    phase = folded.phase[folded.steady]
    if len(phase) < 6:
        return float("nan"), 0.0
    values = undrifted(folded, residual)[folded.steady]
    order = np.argsort(phase, kind="stable")
    phase, values = phase[order], values[order]
    group = np.concatenate([[0], np.cumsum(np.diff(phase) > SAME_PHASE)])
    count = np.bincount(group)
    widths = np.bincount(group, phase**2) / count - (np.bincount(group, phase) / count) ** 2
    free = float(len(values) - len(count))
    # Chosen: two frames at each phase leave half of them free, and some are lost.
    if free >= 0.4 * len(values) and np.max(widths) < (2 * SAME_PHASE) ** 2:
        mean = np.bincount(group, values) / count
        return float(np.sqrt(np.sum((values - mean[group]) ** 2) / free)), free - 1.0
    gap = np.maximum(np.diff(phase), 1e-12)
    left = gap[1:] / (gap[1:] + gap[:-1])
    bend = values[1:-1] - left * values[:-2] - (1.0 - left) * values[2:]
    bend /= np.sqrt(1.0 + left**2 + (1.0 - left) ** 2)
    place = np.floor(phase[1:-1] * PHASES).astype(np.int64)
    each = [bend[place == k] for k in np.unique(place) if np.sum(place == k) >= 2]
    if not each:
        return root_mean_square(bend), len(bend) / 2.0
    spread = np.array([np.mean(part**2) for part in each])
    quiet = spread <= _BENT * np.median(spread)
    size = np.array([len(part) for part in each])[quiet]
    return float(np.sqrt(np.average(spread[quiet], weights=size))), float(size.sum()) / 2.0


def _finer(folded: Fold) -> Fold:
    """With phase bins that hold about three frames each.

    In wider bins periods would differ by which phases they show, if the prediction is wrong.
    """
    count = max(int(folded.steady.sum()) // 3, PHASES)
    walk = len(folded.bin) + np.round(folded.phase * count) % count
    return replace(folded, bin=_numbered(np.where(folded.steady, walk, folded.bin)))


def cycle_scatter(
    folded: Fold, residual: Array, kind: Kind, sd: float, independent: FrameErrors | None = None
) -> float:
    """Standard deviation of the error that a period's frames share, beside their own noise `sd`.

    By restricted maximum likelihood; 0 where the gain in likelihood is below ``_WORTH``.
    """
    finer = _finer(folded)
    if not _advances(finer):
        return 0.0
    independent = independent or FrameErrors(np.arange(len(folded.bin)))
    design = independent.of(_design(finer, kind))
    shared = independent.of(_shared(folded, kind))
    residual = independent.of(residual[:, None])[:, 0]
    basis = np.linalg.qr(design)[0]
    clean = shared - basis @ (basis.T @ shared)
    left, singular, _ = np.linalg.svd(clean, full_matrices=False)
    seen = singular > 1e-6 * max(float(singular.max(initial=0.0)), 1e-300)
    power, score = singular[seen] ** 2, (left[:, seen].T @ residual) ** 2
    if not len(power):
        return 0.0

    def loss(ratio: float) -> float:
        variance = sd**2 * (1.0 + ratio * power)
        return float(np.sum(np.log(variance) + score / variance))

    losses = [loss(ratio) for ratio in _RATIOS]
    best = int(np.argmin(losses))
    return sd * float(np.sqrt(_RATIOS[best])) if loss(0.0) - losses[best] > _WORTH else 0.0
