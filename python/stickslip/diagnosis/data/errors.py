"""The errors of readings: of the means of conditions, from repeats, a free fit, or as stated.

A reading i of the condition k in the block q is

    y_i = level_k + s_k (shift_q + sign(level_k) gain_q + e_i),  s_k^2 = s0^2 + (rho level_k)^2,

with errors e of which those of neighbours in a run are correlated: see `noise`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
from scipy.optimize import nnls
from scipy.signal import correlate
from scipy.sparse import csr_array
from scipy.special import ndtr
from scipy.stats import chi2 as chi2_law

from stickslip._util.arrays import Array, Indices, Mask, root_mean_square
from stickslip._util.note import Note
from stickslip._util.text import OneLine, counted
from stickslip._util.units import with_unit
from stickslip.diagnosis.data.noise import Draws, Noise, along, averaged, satterthwaite

FEWEST = 4
"""Degrees of freedom from which on a scatter tells the error. Chosen: they tell it to 35 %."""

_ALIKE = 1e-9
"""Part of the usual level by which readings differ that differ by rounding alone. Chosen: between
the rounding of a double, 1e-16, and that of any table."""

_FEWEST_STEPS, _PARTS, _OFF_STEP = 5, 4, 1e-3
"""Different readings that show a step, parts of the least difference that are tried as one, and how
far a reading may lie off it, in steps. Chosen: by chance one table in 1e10 looks stepped."""

_NEAR_ZERO = 0.1
"""Part of the usual error that a stated relative error leaves near the level zero. Chosen."""

_APART = 1e-3
"""p-value below which records of one unit do not share an error. Chosen: one in 1000 meters."""


@dataclass(frozen=True, repr=False, eq=False)
class Errors(OneLine):
    """Errors of the mean of each condition.

    Attributes
    ----------
    sd : ndarray, shape (m,)
        Standard deviation of each mean.
    covariance : ndarray, shape (m, m), or None
        Of the means; None where they are independent.
    dof : float
        Degrees of freedom of their size: infinity where it was stated, 0 where nothing is known.
    sizes : dict
        What is reported of them: ``s0`` in the unit of the readings, ``rho``, ``phi``, and
        ``shift`` and ``gain`` in errors of a reading.
    notes : tuple of Note
    of_fit : bool
        Whether they are what the fit of all causes leaves.
    """

    sd: Array
    covariance: Array | None = None
    dof: float = math.inf
    sizes: dict[str, float] = field(default_factory=dict)
    notes: tuple[Note, ...] = ()
    _of_level: Callable[[Array], Array] | None = field(default=None, repr=False)
    of_fit: bool = False

    @staticmethod
    def alike(
        sd: float, readings: Array | Indices, dof: float, *notes: Note, of_fit: bool = False
    ) -> Errors:
        """Errors of means of so many readings each, shape (m,), with one standard deviation."""
        sizes = {"s0": sd, "rho": 0.0}
        return Errors(sd / np.sqrt(readings), None, dof, sizes, notes, of_fit=of_fit)

    @property
    def known(self) -> bool:
        """Whether anything is known of them."""
        return self.dof > 0.0

    def at(self, level: Array) -> Errors:
        """The same where errors that conditions share follow another level, shape (m,).

        They must not follow what was measured: conditions that came out low would weigh more, and
        a fit would end below them all. Errors of a condition's own stay as they are.
        """
        if self._of_level is None:
            return self
        covariance = self._of_level(level)
        return replace(self, sd=np.sqrt(np.diag(covariance)), covariance=covariance)

    def of_reading(self, level: Array) -> Array:
        """Standard deviation of one reading at levels, shape (k,)."""
        s0 = self.sizes.get("s0", float(np.median(self.sd)))
        return np.asarray(np.hypot(s0, self.sizes.get("rho", 0.0) * level), dtype=float)


def estimate(
    y: Array, condition: Indices, *, sd: Array | None = None, relative: float = math.nan,
    run: Indices | None = None, place: Array | None = None, block: Indices | None = None,
    seed: int = 0,
) -> tuple[Array, Errors]:  # fmt: skip
    """Means of the conditions, shape (m,), and their errors.

    All arrays have the shape (n,), a value for each reading of `y`. Conditions are 0 to m - 1, none
    missing. Where `sd` is stated, repeats tell only what readings of a run or of a block share. The
    stated `relative` standard deviation of a reading is used where repeats are too few. `run` and
    `block` are -1 where they are not known; a reading without a block has one of its own. Blocks
    are used where conditions were repeated in another one. `place` is that in the run, counted in
    the usual step; the order of the rows, if not given. `seed` is that of the draws.
    """
    count = np.bincount(condition).astype(float)
    mean = np.bincount(condition, y) / count
    # Readings that are all zero, below the resolution of a meter, have no scatter. Their error is
    # that of the level zero.
    moves = np.bincount(condition, y != 0.0) > 0
    moves = moves if moves.any() else ~moves
    size = root_mean_square(mean[moves]) or 1.0
    away = y - mean[condition]
    free = int(np.sum(moves[condition])) - int(np.sum(moves))
    notes: list[Note] = []
    copies = sd is None and are_copies(away, size, len(count), notes)
    if copies or not np.any(np.abs(away) > _ALIKE * size):
        free = 0
    block = _crossed(condition, block, moves[condition], notes)
    order, gap = along_runs(run, place, moves[condition], (count > 1.0)[condition])
    shared = block is not None or bool(np.any(np.isfinite(gap)))
    if free < FEWEST or (sd is not None and not shared):
        sizes, dof = _stated(sd, relative, free, size, mean[condition], notes)
        one = np.hypot(sizes["s0"], sizes["rho"] * mean[condition]) if sd is None else sd
        sds = np.sqrt(np.bincount(condition, one**2)) / (np.sqrt(count) if copies else count)
        return mean, Errors(sds, None, dof, sizes, tuple(notes))
    pooled = math.sqrt(float(np.sum(away**2)) / free)
    scatter = _Scatter(condition, mean, moves, size, away, sd, pooled, block, order, gap)
    return mean, scatter.errors(seed, notes)


def no_finer_than_the_meter(y: Array, condition: Indices, errors: Errors, unit: str) -> Errors:
    """The errors, or those of rounding where repeats scatter by less than the meter's step tells.

    Readings that repeats round to the same number look exact. Their rounding is the same each time,
    so that a mean of them is no better.
    """
    repeats, least = len(y) - len(errors.sd), meter_step(y) / math.sqrt(12.0)
    scatter = float(errors.of_reading(np.zeros(1))[0])
    if least == 0.0 or repeats < FEWEST or (errors.dof > 0.0 and scatter >= least):
        return errors
    size = with_unit(least, unit)
    text = f"Repeats scatter by less than the meter's step; {size}, the step / sqrt(12), is taken "
    note = Note("meter-step", f"{text}for the error of each condition.", least)
    known = errors.notes if errors.dof > 0.0 else ()
    sizes = {**errors.sizes, "s0": least, "rho": 0.0}
    return Errors(np.maximum(errors.sd, least), None, math.inf, sizes, (*known, note))


def of_one_meter(
    unit: Sequence[str], sd: Array, readings: Array, dof: Array
) -> tuple[list[float], list[float]]:
    """Errors of a reading of records, shape (k,), and how many readings tell each.

    Records of one unit share the mean square over their `readings`, unless Bartlett's test (Proc.
    R. Soc. A 160, 268, 1937) tells them apart, by their degrees of freedom `dof`.
    """
    sd, readings = sd.copy(), readings.copy()
    for one in set(unit):
        of = np.array([other == one for other in unit])
        free, own, others = np.maximum(dof[of], 1.0), sd[of] ** 2, int(np.sum(of)) - 1
        with np.errstate(divide="ignore"):
            rise = float(free @ (math.log(free @ own / np.sum(free)) - np.log(own)))
        rise /= 1.0 + (np.sum(1.0 / free) - 1.0 / np.sum(free)) / (3.0 * max(others, 1))
        if others and chi2_law.sf(rise, others) > _APART:
            sd[of] = math.sqrt(np.average(own, weights=readings[of]))
            readings[of] = np.sum(readings[of])
    return sd.tolist(), readings.tolist()


def freedom(away: Array) -> float:
    """Degrees of freedom of the mean square of errors in their order, shape (n,), maybe correlated.

    Its variance is that of independent ones times the sum of squared correlations.
    """
    count = len(away)
    lags = correlate(away, away, method="fft")[count - 1 :]
    alike = lags[: max(count // 4, 1)] / max(float(lags[0]), 1e-300)
    return count / max(2.0 * float(np.sum(alike**2)) - 1.0, 1.0)


def meter_step(y: Array) -> float:
    """The step that all readings are multiples of, apart from a common offset; 0 for none."""
    values = np.unique(y)
    if len(values) < _FEWEST_STEPS:
        return 0.0
    apart = values - values[0]
    least = float(np.min(np.diff(values)))
    for part in range(1, _PARTS + 1):
        steps = apart / (least / part)
        if np.all(np.abs(steps - np.round(steps)) < _OFF_STEP):
            return least / part
    return 0.0


def are_copies(away: Array, size: float, conditions: int, notes: list[Note]) -> bool:
    """Whether all repeats are exactly alike and so tell no error: copies, or rounded to a step.

    `away`, shape (n,), are readings less the mean of their condition; `size` is the usual level.
    """
    again = len(away) - conditions
    if not again or np.any(np.abs(away) > _ALIKE * size):
        return False
    text = f"All repeats are exactly alike, like copies: {counted(again, 'reading')} not counted."
    notes.append(Note("copies", text, again))
    return True


def _stated(
    sd: Array | None, relative: float, free: int, size: float, level: Array, notes: list[Note]
) -> tuple[dict[str, float], float]:
    """s0 and rho of a reading whose error is stated or unknown, and its degrees of freedom."""
    if sd is not None:
        s0, rho = np.sqrt(nnls(np.column_stack([level**0, (level / size) ** 2]), sd**2)[0])
        return {"s0": float(s0), "rho": float(rho) / size}, math.inf
    few = f"of the {FEWEST} degrees of freedom that are needed, repeats have {free}"
    if math.isfinite(relative):
        text = f"The stated relative error of {relative:.3g} is used, as {few}."
        notes.append(Note("noise-stated", text, relative))
        return {"s0": _NEAR_ZERO * relative * size, "rho": relative}, math.inf
    notes.append(Note("noise-unknown", f"The error of a reading is not known: {few}.", free))
    return {"s0": size, "rho": 0.0}, 0.0


def _crossed(
    condition: Indices, block: Indices | None, known: Mask, notes: list[Note]
) -> Indices | None:
    """Blocks, numbered from 0, if their errors can be told from the levels of conditions."""
    if block is None or np.all(block < 0):
        return None
    lost = block < 0
    numbers = np.where(lost, np.max(block) + np.cumsum(lost), block)
    block = np.unique(numbers, return_inverse=True)[1].astype(np.int64)
    most = max(len(np.unique(condition[known])), len(np.unique(block[known])) + 1)
    if np.max(block) == 0:
        text = "All readings are of one block: what they share is not known."
        notes.append(Note("one-block", text))
        return None
    if len(np.unique(condition[known] * len(block) + block[known])) <= most:
        text = "No condition was repeated in another block: what readings of one share is unknown."
        notes.append(Note("blocks-not-crossed", text))
        return None
    return block


def along_runs(
    run: Indices | None, place: Array | None, known: Mask, repeated: Mask
) -> tuple[Indices, Array]:
    """The known readings, run by run, and the distance of each from the one before it.

    It is infinite for the first of a run, and for all where no neighbours were repeated: only there
    do errors show how they are correlated.
    """
    if run is None:
        rows = np.flatnonzero(known)
        return rows, np.full(len(rows), math.inf)
    at = np.arange(len(run), dtype=float) if place is None else place
    order = np.lexsort((at, run))
    same = (np.diff(run[order], prepend=-2) == 0) & (run[order] >= 0)
    step = np.diff(at[order], prepend=0.0)
    if place is None:
        step = np.ones(len(run))
    elif np.any(same & (step > 0.0)):
        step = np.maximum(step / np.median(step[same & (step > 0.0)]), 1.0)
    number = np.cumsum(np.where(same, step, 0.0))[known[order]]
    order = order[known[order]]
    same = (np.diff(run[order], prepend=-2) == 0) & (run[order] >= 0)
    gap = np.where(same, np.diff(number, prepend=0.0), math.inf)
    shown = repeated[order]
    if not np.any(same[1:] & shown[1:] & shown[:-1]):
        gap[:] = math.inf
    return order, gap


def _covariance_at(
    parts: Array, sizes: Mapping[str, float], mean: Array, linked: bool, stated: bool, level: Array
) -> Array:
    """Covariance of the means where what they share follows a level, shape (m,).

    `parts` are the covariances of the readings' own errors, of shifts and of gains.
    """
    alone, shift, gain = parts
    there, here = np.hypot(sizes["s0"], sizes["rho"] * np.array([level, mean]))
    ratio = np.ones(len(mean)) if stated else there / here
    signs = np.where(level == 0.0, np.sign(mean), np.sign(level))
    both = np.outer(ratio, ratio)
    readings = both * alone if linked else alone
    return np.asarray(readings + both * (shift + np.outer(signs, signs) * gain))


@dataclass(frozen=True, repr=False, eq=False)
class _Scatter(OneLine):
    """Readings that tell their errors.

    `away` is their distance from the mean of their condition, `pooled` its standard deviation, and
    `order` and `gap` are those of `along_runs`; the others are as in `estimate`.
    """

    condition: Indices
    mean: Array
    moves: Mask
    size: float
    away: Array
    sd: Array | None
    pooled: float
    block: Indices | None
    order: Indices
    gap: Array

    @cached_property
    def unit(self) -> Array:
        """In which the errors of readings are counted, shape (n,)."""
        if self.sd is None:
            return np.full(len(self.away), self.pooled)
        return self.sd * self.pooled / root_mean_square(self.sd)

    @cached_property
    def shares(self) -> Array:
        """Block of each reading as columns of 0 and 1, shape (n, blocks)."""
        if self.block is None:
            return np.zeros((len(self.away), 0))
        return np.eye(int(self.block.max()) + 1)[self.block]

    @cached_property
    def noise(self) -> Noise:
        """The noise of the readings of conditions that move."""
        rows, c, m = self.order, self.condition[self.order], len(self.mean)
        levels = csr_array(
            (self.pooled / self.unit[rows], (np.arange(len(rows)), c)), (len(rows), m)
        )
        signs, own = np.sign(self.mean), np.eye(self.shares.shape[1])
        shared = {}
        if self.block is not None:
            shared["shift"] = csr_array(self.shares[rows]), own
            if len(set(signs[self.moves].tolist())) > 1:  # else a shift and a gain are the same
                shared["gain"] = csr_array(self.shares[rows] * signs[c, None]), own
        level = self.mean / self.size if self.sd is None else None
        spare = np.bincount(c, minlength=m) - 1.0 * self.moves
        return Noise(self.away[rows] / self.unit[rows], levels, c, spare, self.gap, level, shared)

    def errors(self, seed: int, notes: list[Note]) -> Errors:
        """Errors of the means, over draws of the hyperparameters."""
        p, weight = self.noise.draws(seed)
        size, shared = self.noise.sizes(p), self.noise.joint
        usual = weight @ size**2
        if shared:
            parts, factor, dof = self._covariances(p, weight, size)
        else:
            factor, dof = satterthwaite(np.mean(size**2 / usual, axis=1), weight)
        if self.sd is None:
            # What tells how errors depend on the level and on each other does not tell their size.
            free = float(np.sum(np.bincount(self.condition)[self.moves] - 1.0))
            dof = min(dof, free - len({"rho", "phi"}.intersection(p)))
            square = factor * self.pooled**2
            sizes = {"s0": math.sqrt(square * (weight @ np.exp(2.0 * p["s0"])))}
            sizes["rho"] = math.sqrt(square * (weight @ np.exp(2.0 * p["rho"]))) / self.size
        else:
            sizes, _ = _stated(self.sd, math.nan, 0, self.size, self.mean[self.condition], notes)
        if not shared:
            of_means = np.bincount(self.condition, self.unit**2) / np.bincount(self.condition) ** 2
            return Errors(np.sqrt(factor * of_means * usual), None, dof, sizes, tuple(notes))
        sizes |= {name: math.sqrt(weight @ np.exp(2.0 * p[name])) for name in self.noise.shared}
        if "shift" in p:
            notes.append(Note("blocks", (
                f"Blocks differ by a shift of {sizes['shift']:.2g} and a gain of "
                f"{sizes.get('gain', 0.0):.2g} errors of a reading."
            ), sizes["shift"]))  # fmt: skip
        if "phi" in p:
            phi = ndtr(p["phi"])
            order = np.argsort(phi)
            low, high = np.interp((0.025, 0.975), np.cumsum(weight[order]), phi[order])
            sizes["phi"] = float(weight @ phi)
            notes.append(Note("errors-correlated", (
                f"Errors of readings that follow each other have a correlation of "
                f"{sizes['phi']:.2f} ({low:.2f} to {high:.2f})."
            ), sizes["phi"]))  # fmt: skip
        known = self.mean, "phi" in p, self.sd is not None
        of_level = partial(_covariance_at, factor * parts, sizes, *known)
        covariance = of_level(self.mean)
        sd = np.sqrt(np.diag(covariance))
        return Errors(sd, covariance, dof, sizes, tuple(notes), of_level)

    def _covariances(self, p: Draws, weight: Array, size: Array) -> tuple[Array, float, float]:
        """Mean covariances of the means, shape (3, m, m), the factor of their size and its degrees.

        By errors of readings, by shifts, and by gains as they are for levels of one sign.
        """
        m, still = len(self.mean), np.setdiff1d(np.arange(len(self.away)), self.order)
        rows = np.append(self.order, still)
        mixed, c = np.zeros((m, len(rows))), self.condition[rows]
        mixed[c, np.arange(len(rows))] = self.unit[rows] / np.bincount(self.condition)[c]
        one = size
        if self.sd is not None:
            # How large a stated error is counts as known, whatever readings scatter by.
            one = np.full(size.shape, root_mean_square(self.sd) / self.pooled)
        phi = ndtr(p["phi"]) if "phi" in p else np.zeros(len(weight))
        gap = np.append(self.gap, np.full(len(still), math.inf))
        parts = along(mixed, gap, phi, weight, one)
        shares, signs = mixed @ self.shares[rows], np.where(self.mean < 0.0, -1.0, 1.0)
        for name, part in (("shift", shares), ("gain", signs[:, None] * shares)):
            share = np.exp(2.0 * p[name]) if name in p else np.zeros(len(weight))
            parts.append((part @ part.T, share, size))
        means, factor, dof = averaged(parts, weight)
        readings = np.sum(means[:-2], axis=0)
        return np.array([readings, means[-2], means[-1] * np.outer(signs, signs)]), factor, dof
