"""Signal to noise of what is hidden, after all that the constants could undo of it.

Everything here is by the reference simulator: no file of the package has a say in what a data set
is. The strength S is the size of what is left of an effect, in units of the errors, once the
constants have moved to where they hide it best, at the price of their priors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from blind.catalogue import Value, entry
from blind.readings import Readings, readings
from blind.settings import (
    ANGLE_SD,
    FIELD_SD,
    FILM_SD,
    FLOOR,
    LIMITS,
    SCATTER,
    TRIALS,
    Drive,
    priors,
)
from blind.truth import Hidden, Truth

Array = NDArray[np.float64]

# s, of the runs behind a strength: an eighth of the cost of the data's.
_STEP = 8e-6
_CONSTANT, _AMOUNT = 0.5, 0.25  # differences: standard deviations of a prior, usual sizes
_TURNED, _TRIGGER = float(np.radians(1.0)), 3e-4  # rad, s: what a camera's set-up leaves open
_RAMP = 0.05  # s, before which a film shows no walk
_STEPS = 25  # of a descent
_OFF = 2.0  # standard deviations of a constant where a descent begins, too
_SETTLED = 0.02  # share of the sum of squares that a further step has to promise
_FAR = 1e3  # standard deviations or usual sizes that nothing reaches


class Draft:
    """Readings of truths in units of their errors, (readings,); each truth is simulated once."""

    def __init__(self, plain: Truth, drives: Sequence[Drive], tables: tuple[str, ...]) -> None:
        self.plain, self.drives, self.tables = plain, list(drives), tables
        self._level = readings(plain, self.drives, tables, _STEP)
        speed = self._level.velocity
        self._velocity_sd = np.hypot(SCATTER * speed, FLOOR) / np.sqrt(TRIALS)
        self._known: dict[str, Array] = {}

    def __call__(self, truth: Truth) -> Array:
        """The readings of a truth."""
        name = repr((truth.constants, truth.hidden))
        if name not in self._known:
            self._known[name] = self._scaled(readings(truth, self.drives, self.tables, _STEP))
        return self._known[name]

    def _scaled(self, level: Readings) -> Array:
        parts = [
            level.velocity / self._velocity_sd, level.angle / ANGLE_SD,
            level.field.ravel() / FIELD_SD,
        ]  # fmt: skip
        for own, seen in zip(self._level.films, level.films, strict=True):
            for key, frames in _frames(own).items():
                at = own["t"][frames]
                parts.append(np.interp(at, seen["t"], seen[key]) / FILM_SD[key])
        return np.concatenate(parts)

    def film_columns(self) -> tuple[Array, Array]:
        """Columns of each film's free constants, (readings, columns), and their priors' weights.

        They are the origin of x, the angle of the camera, and when it began.
        """
        sizes = [int(frames.sum()) for own in self._level.films for frames in _frames(own).values()]
        before = len(self(self.plain)) - sum(sizes)
        ends = before + np.cumsum([0, *sizes])
        late, early = (
            (
                self(replace(self.plain, hidden={"film_delay": Hidden(half, {"time": _TRIGGER})}))
                for half in (0.5, -0.5)
            )
            if sizes
            else (np.zeros(0), np.zeros(0))
        )
        columns, weights = [], []
        for film in range(len(self._level.films)):
            x, theta = (slice(*ends[2 * film + k : 2 * film + k + 2]) for k in (0, 1))
            for rows, values, weight in (
                (x, 1.0, 0.0),
                (theta, _TURNED / FILM_SD["theta"], 1.0),
                (slice(x.start, theta.stop), (late - early)[x.start : theta.stop], 1.0),
            ):
                column = np.zeros(len(late))
                column[rows] = values
                columns.append(column)
                weights.append(weight)
        shape = (len(self(self.plain)), len(columns))
        return np.array(columns).T.reshape(shape), np.array(weights)


def _frames(film: Mapping[str, Array]) -> dict[str, NDArray[np.bool_]]:
    """Frames of x and of the angle that count: of x those of the walk."""
    return {"x": film["t"] >= _RAMP, "theta": np.ones(len(film["t"]), dtype=bool)}


class Absorber:
    """Linear model of what the constants, and one rival of free size, can undo about a truth.

    A rival is a cause, or a constant without its prior. `base` has what is hidden besides; a rival
    that is among it begins at its size there.
    """

    def __init__(self, draft: Draft, base: Truth, freed: str | None = None) -> None:
        self._draft, self._base, self._freed = draft, base, freed
        self._priors = priors(draft.tables)
        self._rival = _rival(freed, base)
        own = [0.0 if name == freed else 1.0 for name in self._priors]
        beside, weights = draft.film_columns()
        self._weights = np.array([*own, *np.zeros(len(self._rival)), *weights])
        self._beside = beside
        self._begin = draft(base)
        moving = len(own) + len(self._rival)
        ends = [self._ends(at) for at in range(moving)]
        self._low = np.array([*(low for low, _ in ends), *np.full(len(weights), -_FAR)])
        self._high = np.array([*(high for _, high in ends), *np.full(len(weights), _FAR)])
        self._slopes = self._slopes_at(np.zeros(len(self._weights)))

    def rest(self, seen: Array) -> Array:
        """Residuals of readings by the linear model, and of the priors."""
        return self._left(seen - self._begin, self._slopes, np.zeros(len(self._weights)))[1]

    def strength(self, seen: Array) -> float:
        """S of readings without noise, by the linear model."""
        return float(np.linalg.norm(self.rest(seen)))

    def searched(self, seen: Array) -> float:
        """The same by the least sum of squares that a search finds, since effects are not linear.

        It begins at the truth, and where one constant that is off explains most.
        """
        starts = np.zeros((1 + 2 * len(self._priors), len(self._weights)))
        for k in range(len(self._priors)):
            starts[1 + 2 * k : 3 + 2 * k, k] = _OFF, -_OFF
        starts = np.clip(starts, self._low, self._high)
        costs = [self._cost(seen - self._readings(start), start) for start in starts]
        best = int(np.argmin(costs))
        return min(self._descent(seen, start) for start in starts[sorted({0, best})])

    def _cost(self, gap: Array, at: Array) -> float:
        return float(np.sum(gap**2) + np.sum((self._weights * at) ** 2))

    def _descent(self, seen: Array, at: Array) -> float:
        """S by a descent from coordinates on.

        Slopes follow what each step shows of them (Broyden 1965): a step takes one simulation.
        """
        fresh = not at.any()
        slopes, gap = self._slopes, seen - self._readings(at)
        least, damping = self._cost(gap, at), 0.0
        for _ in range(_STEPS):
            aim, left = self._left(gap, slopes, at, damping)
            if least - float(np.sum(left**2)) < _SETTLED * least:
                if fresh:
                    break
                slopes, damping, fresh = self._slopes_at(at, both=False), 0.0, True
                continue
            step = aim - at
            other = seen - self._readings(aim)
            slopes = slopes + np.outer(gap - other - slopes @ step, step) / float(step @ step)
            cost, fresh = self._cost(other, aim), False
            if cost < least:
                at, gap, least, damping = aim, other, cost, damping / 4.0
            else:
                damping = max(4.0 * damping, 1.0)
        return float(np.sqrt(least))

    def cosines(self, seen: Array, others: Sequence[str]) -> dict[str, float]:
        """How alike what is left of readings and of each constant and each other are, 0 to 1.

        A cause of which several sizes are free is as alike as its best mixture; that of a constant
        is by itself without its prior.
        """
        mine = self.rest(seen)
        found = {
            name: _cosine(mine, self.rest(self._begin + self._slopes[:, at])[:, None])
            for at, name in enumerate(self._priors)
        }
        for name in others:
            usual = self._effects(name, 1.0)
            one_sided = entry(name).least >= 0.0
            found[name] = _cosine(mine, usual, one_sided)
            if found[name] > 0.5:
                # Once more at about the size that would be found: effects are not linear.
                size = np.linalg.lstsq(usual, mine, rcond=None)[0]
                again = _cosine(mine, self._effects(name, size), one_sided)
                found[name] = max(found[name], again)
        return found

    def _effects(self, name: str, amount: float | Array) -> Array:
        """Residuals of the effect of each size of a cause, (rows, sizes)."""
        own = entry(name)
        amounts = np.clip(np.broadcast_to(amount, len(own.sizes)), own.least, own.most)
        columns = []
        for size, each in zip(own.sizes, amounts, strict=True):
            base = {**own.fixed, **_middle(name), **size}
            hidden = {**self._base.hidden, name: Hidden(float(each), base)}
            columns.append(self.rest(self._draft(replace(self._base, hidden=hidden))))
        return np.array(columns).T

    def _left(
        self, gap: Array, slopes: Array, at: Array, damping: float = 0.0
    ) -> tuple[Array, Array]:
        """Where the linear model about `at` leaves least, and what it leaves.

        Damping holds a step back, in standard deviations of the priors and usual sizes.
        """
        rows = np.vstack([slopes, np.diag(self._weights)])
        aim = np.concatenate([gap + slopes @ at, np.zeros(len(at))])
        held = np.vstack([rows, damping * np.eye(len(at))])
        wanted = np.concatenate([aim, damping * at])
        # A free column that has no effect has no solution of its own.
        there = np.linalg.lstsq(held, wanted, rcond=1e-10)[0]
        if ((there < self._low) | (there > self._high)).any():
            there = lsq_linear(held, wanted, (self._low, self._high)).x
        return there, aim - rows @ there

    def _ends(self, at: int) -> tuple[float, float]:
        """Range of a coordinate from its beginning on."""
        if at < len(self._priors):
            name = list(self._priors)[at]
            begin = self._priors[name].coordinate(self._base.constants[name])
            low, high = LIMITS.get(name, (-np.inf, np.inf))
            of = self._priors[name].coordinate
            return (
                of(low) - begin if np.isfinite(low) else -_FAR,
                of(high) - begin if np.isfinite(high) else _FAR,
            )
        _, size, begin = self._rival[at - len(self._priors)]
        own = entry(str(self._freed))
        return own.least - begin / size, own.most - begin / size

    def _readings(self, at: Array) -> Array:
        """Readings at coordinates, all of them 0 at the beginning."""
        count = len(self._priors)
        constants = {
            name: prior.value(prior.coordinate(self._base.constants[name]) + at[k])
            for k, (name, prior) in enumerate(self._priors.items())
        }
        hidden = dict(self._base.hidden)
        if self._rival:
            amounts = {
                key: begin + at[count + k] * size
                for k, (key, size, begin) in enumerate(self._rival)
            }
            name = str(self._freed)
            there = hidden[name].base if name in hidden else {}
            base: dict[str, Value] = {**entry(name).fixed, **_middle(name), **there, **amounts}
            hidden[name] = Hidden(1.0, base)
        moved = replace(self._base, constants=constants, hidden=hidden)
        return self._draft(moved) + self._beside @ at[count + len(self._rival) :]

    def _slopes_at(self, at: Array, both: bool = True) -> Array:
        """Derivatives of the readings, (readings, coordinates): by both sides, or forwards."""
        moving = len(self._priors) + len(self._rival)
        columns = []
        for k in range(moving):
            half = _CONSTANT if k < len(self._priors) else _AMOUNT
            ends = np.clip([at[k] - half * both, at[k] + half], self._low[k], self._high[k])
            if ends[1] - ends[0] < 0.5 * half:
                ends = np.array([at[k] - half, at[k]])
            below, above = (self._readings(np.where(np.arange(len(at)) == k, end, at))
                            for end in ends)  # fmt: skip
            columns.append((above - below) / (ends[1] - ends[0]))
        return np.column_stack([*columns, self._beside])


def _rival(name: str | None, base: Truth) -> list[tuple[str, float, float]]:
    """Each free size of a cause: its key, usual size and beginning; none of a constant."""
    if name is None or "." in name:
        return []
    return [
        (key, size, base.amount(name, key)) for each in entry(name).sizes
        for key, size in each.items()
    ]  # fmt: skip


def _middle(name: str) -> dict[str, float]:
    """The middle of what is drawn of a cause."""
    return {key: float(np.sqrt(low * high)) for key, (low, high) in entry(name).drawn.items()}


def _cosine(one: Array, others: Array, one_sided: bool = False) -> float:
    """Cosine between a vector and the nearest of the span of others, (rows, columns).

    Of a single one that is `one_sided` the opposite does not count.
    """
    sizes = np.linalg.lstsq(others, one, rcond=1e-10)[0]
    near = others @ (np.maximum(sizes, 0.0) if one_sided else sizes)
    size = np.linalg.norm(near) * np.linalg.norm(one)
    return float(one @ near / size) if size > 0.0 else 0.0
