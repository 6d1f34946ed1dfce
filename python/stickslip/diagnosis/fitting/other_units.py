"""A column or constant whose numbers are in another unit than its model takes.

Nothing is asked of a column whose unit the data state, or where the stated model is like the
readings as they stand. Each other unit is a model without a cause: its constants are fitted within
their priors, and it competes with the stated units and with each single constant that is off.
Where that finds none, a column's unit and one cause compete with one cause in the stated units.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.note import Note
from stickslip._util.prior import Prior
from stickslip._util.units import MISTAKES, factor_text, other_units
from stickslip.diagnosis.data.errors import FEWEST
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.fitting.descent import finished
from stickslip.diagnosis.fitting.forms import Exact
from stickslip.diagnosis.fitting.models import minimise
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.errors import ScenarioError

# Points of the priors at which a unit is looked at, units that are fitted, and such with causes.
# Chosen: with fewer points an oscillation is out of phase at all of them.
_DRAWS, _FITTED, _BESIDE = 12, 4, 2
# Factor, either way, up to which one constant may be a part that was mistaken. Chosen: a wrong gear
# or winding is tenfold; what is farther off is a unit.
_WRONG_PART = 30.0
_SCANNED = 97  # values at which one constant is looked at; chosen: beyond 7 % a period is lost
# A model is like the readings if it leaves less than this part of their variance. The stated units
# are wrong only if they leave so many times more than others, or move a constant by more stated
# errors. Chosen: causes of the usual size change less.
_LIKE, _MISSED, _FAR = 0.05, 4.0, 4.0
_SMALL = 0.02  # errors not known, in the scatter of the readings; chosen: few sensors are worse
_SAME = 0.1  # logarithm of the ratio of two factors that need not differ: 180 / pi and 60; chosen
# Cost by which a unit is ahead of one constant that is off, and up to which two units are alike.
# Chosen: a chance of 1 in 400.
_LEAD = 12.0


@dataclass(frozen=True)
class _Try:
    """A model in other units, where its fit begins, what is left there, and what it is called.

    `name` is the column or constant that is in it; the constant of the column `relaxed` has no
    penalty.
    """

    problem: Problem
    x: Array
    left: float
    name: str = ""
    factor: float = 1.0
    words: str = ""
    relaxed: int | None = None
    causes: tuple[Cause, ...] = ()


@dataclass(frozen=True)
class _End:
    """A fit: its chi-square and penalty, and how far it moves a stated constant, in its errors."""

    chi2: float
    penalty: float
    moved: float
    x: Array
    of: _Try

    def cost(self, scale: float) -> float:
        return self.chi2 / scale + self.penalty


def unit_fault(
    problem: Problem, of: Callable[[Sequence[Table]], Problem],
    known: Mapping[str, tuple[str, Sequence[str]]], seed: int,
) -> Note | None:  # fmt: skip
    """A note where readings are the stated model's in a unit that nobody stated; else None.

    `of` makes the problem of other tables; `known` has what columns are called, and their SI units.
    """
    if len(problem.y) < len(problem.constants) + FEWEST:
        return None
    # Small errors where none are known: only their ratios count here.
    problem = problem.with_tables(
        table if errors.dof else table.having(errors=replace(errors, sd=_SMALL * errors.sd))
        for table, errors in zip(problem.tables, problem.errors, strict=True)
    )
    about = problem.y - np.average(problem.y, weights=problem.sd**-2.0)
    variance = float(np.sum((about / problem.sd) ** 2))
    if variance < 2.0 * len(problem.y):  # Readings that do not change are like many models.
        return None
    null = next(iter(_fits([_looked_at(problem, seed)])), None)
    if null is None or (_is_like(null, problem, variance / _MISSED) and null.moved < _FAR):
        return None
    # What is neither like the data nor nearer than the stated units is never told.
    bound = max(2.0 * len(problem.y), _LIKE * variance, null.cost(1.0))
    units = _fits(_in_units(problem, of, known, seed), _FITTED, bound)
    units.sort(key=lambda end: end.cost(1.0))
    meant, rivals = [*units, *_fits(_beyond(problem, seed), _FITTED, bound)], [null]

    def best_of_all() -> _End | None:
        """The best in other units, if it is like the data and no likely rival comes near."""
        best = min(meant, key=lambda end: end.cost(1.0), default=null)
        missed = all(end.chi2 > _MISSED * best.chi2 for end in rivals if end.moved <= _FAR)
        # With a cause that is free many models leave only a small part of the readings.
        like = best.moved <= _FAR and _is_like(best, problem, 0.0 if best.of.causes else variance)
        return best if missed and like else None

    best = best_of_all()
    if best is None:  # Something may be wrong besides: a unit and one cause, against one cause.
        meant = _fits(_beside([end for end in units if end.cost(1.0) < null.cost(1.0)][:_BESIDE]))
        meant = [end for end in meant if end.moved <= _FAR]
        rivals += _fits(_beside(rivals)) if meant else []
        best = best_of_all()
    if best is None:
        return None
    rivals += _fits(_off(problem))
    # Errors that are stated wrongly, or not at all, are those that the best model leaves.
    least = min(end.chi2 for end in (*meant, *rivals))
    scale = max(least / len(problem.y), 1e-9 * variance / len(problem.y))
    first = best.cost(scale) + _LEAD
    if min(end.cost(scale) for end in rivals) < first:
        return None
    constants = {constant.name for constant in problem.constants}
    alike = [end for end in meant if end.cost(scale) < first and end.moved < _FAR]
    # Where two factors of one unit do as well, nothing moves in either, as nothing did.
    factors = [(end.of.name, abs(math.log(end.of.factor))) for end in alike]
    if any(abs(one - other) > _SAME for (name, one), (also, other)
           in itertools.combinations(factors, 2) if name == also):  # fmt: skip
        return None
    alike.sort(key=lambda end: (end.of.name in constants, end.cost(scale)))
    told = {end.of.name if end.of.name in constants else end.of.words: end.of.words
            for end in reversed(alike)}  # fmt: skip
    text = " or ".join(reversed(told.values()))
    beside = " with one cause" * any(end.of.causes for end in alike)
    return Note("other-unit", f"The stated model{beside} would be like the data if {text}.")


def _is_like(end: _End, problem: Problem, variance: float) -> bool:
    """Whether a fit leaves hardly more than errors, or than a small part of the readings."""
    return end.chi2 < max(2.0 * len(problem.y), _LIKE * variance)


def _in_units(
    problem: Problem, of: Callable[[Sequence[Table]], Problem],
    known: Mapping[str, tuple[str, Sequence[str]]], seed: int,
) -> Iterator[_Try]:  # fmt: skip
    """Each other unit of each column that states none."""
    tables = problem.tables
    for column in dict.fromkeys(name for table in tables for name in table.unstated):
        if any(column in table.quantities and column not in table.unstated for table in tables):
            continue
        name, units = known.get(column, (column, ()))
        for unit, per, zero in other_units(units):
            changed = [one.converted(column, per, zero) if column in one.quantities else one
                       for one in tables]  # fmt: skip
            text = f'{name} were in {unit}: write "{name} ({unit})"'
            if not unit:
                text = f"{name} were {factor_text(1.0 / per)} times as large: look at its unit"
            # A model's problem in a unit that is far off may be none.
            with contextlib.suppress(ScenarioError):
                yield _looked_at(of(changed), seed, column, per, text)


def _beside(ends: Iterable[_End]) -> Iterator[_Try]:
    """Fits begun at these ends, with each cause by itself at its usual size."""
    for end in ends:
        low, high = end.of.problem.limits
        for cause in end.of.problem.causes:
            x, columns = end.x.copy(), end.of.problem.columns([cause])
            x[columns] = np.clip(1.0, low[columns], high[columns])
            yield replace(end.of, x=x, causes=(cause,))


def _off(problem: Problem) -> Iterator[_Try]:
    """Fits with one constant that is off, up to `_WRONG_PART`."""
    grid = np.geomspace(1.0 / _WRONG_PART, _WRONG_PART, _SCANNED)
    for k, constant in enumerate(problem.constants):
        if not constant.may_be_off:
            continue
        middle = constant.middle
        assert constant.prior is not None
        # A constant that may be zero is off by so many of its errors.
        tried = middle * grid if middle else np.outer((-1.0, 1.0), constant.prior.second * grid)
        values = np.repeat(problem.physical(np.zeros((1, problem.size))), tried.size, axis=0)
        values[:, k] = tried.ravel()
        left = _left(problem, values)
        wide = _other(problem, k, _wide(constant))
        for place in np.argsort(left)[:2].tolist():
            x = np.zeros(problem.size)
            x[k] = wide.constants[k].coordinate(values[place, k])
            yield _Try(wide, x, float(left[place]), relaxed=k)


def _beyond(problem: Problem, seed: int) -> Iterator[_Try]:
    """The same beyond it."""
    for k, constant in enumerate(problem.constants):
        if not constant.may_be_off or not constant.middle:
            continue
        for factor in (one for one in MISTAKES if max(one, 1.0 / one) > _WRONG_PART):
            moved = _other(problem, k, _times(constant, factor))
            text = (f"{constant.name} were {factor_text(factor)} times what is stated: "
                    "look at its unit")  # fmt: skip
            yield _looked_at(moved, seed, constant.name, factor, text)


def _looked_at(
    problem: Problem, seed: int, name: str = "", factor: float = 1.0, words: str = ""
) -> _Try:
    """The best of some points of the priors of the stated constants."""
    x = np.zeros((_DRAWS, problem.size))
    stated = [k for k, constant in enumerate(problem.constants) if constant.may_be_off]
    x[1:, stated] = np.random.default_rng([seed, 6]).standard_normal((_DRAWS - 1, len(stated)))
    left = _left(problem, problem.physical(x))
    best = int(np.argmin(left))
    return _Try(problem, x[best], float(left[best]), name, factor, words)


def _left(problem: Problem, values: Array) -> Array:
    """Chi-square of the readings at values, shape (vectors,)."""
    with np.errstate(all="ignore"):
        parts = np.split(values, range(problem.at_once, len(values), problem.at_once))
        missed = (((problem.y - problem.model(part)) / problem.sd) ** 2 for part in parts)
        left = np.concatenate([np.sum(squares, axis=1) for squares in missed])
    return np.where(np.isfinite(left), left, 1e300)


def _fits(tries: Iterable[_Try], most: int | None = None, bound: float = math.inf) -> list[_End]:
    """Ends of fits of the best tries; one that will not end below chi-square `bound` is cut."""
    ends = []
    for one in sorted(tries, key=lambda one: one.left)[:most]:
        with contextlib.suppress(np.linalg.LinAlgError, ScenarioError):
            problem, form, n = one.problem, Exact(one.problem), len(one.problem.y)
            cost = float(form.misfit(np.full((n, 1), math.sqrt(bound / n)), np.zeros(0))[0])
            cost += _FAR**2 * sum(c.may_be_off for c in problem.constants)  # so far they may move
            fit = finished(problem, minimise(problem, form, one.causes, one.x, cost_bound=cost))
            x, constants = np.abs(fit.x), problem.constants
            if one.relaxed is not None:
                x[one.relaxed] = 0.0
            stated = [k for k, c in enumerate(constants) if c.may_be_off]
            x[[k for k in stated for cause in one.causes if cause.frees == constants[k].name]] = 0.0
            moved = float(np.max(x[stated], initial=0.0))
            ends.append(_End(fit.chi2, float(x @ x), moved, fit.x, one))
    return ends


def _other(problem: Problem, k: int, constant: Parameter) -> Problem:
    """The problem with another constant in the place of one."""
    constants = (*problem.constants[:k], constant, *problem.constants[k + 1 :])
    return replace(problem, constants=constants, finer={})


def _times(constant: Parameter, factor: float) -> Parameter:
    """A constant that was stated in a unit `factor` times smaller."""
    assert constant.prior is not None
    first, second = factor * constant.prior.first, constant.prior.second
    second *= factor if constant.prior.kind == "normal" else 1.0
    low, high = factor * constant.low, factor * constant.high
    return replace(constant, prior=Prior(constant.prior.kind, first, second), low=low, high=high)


def _wide(constant: Parameter) -> Parameter:
    """A constant that may be another part."""
    assert constant.prior is not None
    middle = constant.middle
    far = _WRONG_PART * (abs(middle) or constant.prior.second)
    if middle > 0.0:
        prior = Prior("log-normal", middle, math.sqrt(_WRONG_PART))
        return replace(constant, prior=prior, low=middle / _WRONG_PART, high=far)
    high = middle / _WRONG_PART if middle else far
    return replace(constant, prior=Prior("normal", middle, far), low=-far, high=high)
