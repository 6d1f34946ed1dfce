"""What differs between two states of a machine, `before` and `after`: one problem of both.

A cause is one difference: a constant that has another value after, or an effect, an instrument or
an event that is there on one side only. What both sides share cancels. Where each table has one of
the same settings on the other side, or of the same times and inputs, their differences are what is
fitted, so that errors of the model that both have cancel too. Elsewhere both are fitted as they
are, and where no difference explains them, causes that both may have are tried as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from pandas import DataFrame

from stickslip._util.arrays import Array, Indices
from stickslip._util.messages import check_whole
from stickslip._util.note import Note
from stickslip._util.prior import Prior
from stickslip._util.text import OneLine, brief
from stickslip.diagnosis.data.errors import Errors
from stickslip.diagnosis.data.series import LOST_SENSOR, Series
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.entry import diagnosed, fault_of, one_blas_thread, stated_terms, units_of
from stickslip.diagnosis.fitting import problem as problems
from stickslip.diagnosis.fitting.other_units import unit_fault
from stickslip.diagnosis.fitting.rivals import Rivals
from stickslip.diagnosis.fitting.scatter import with_scatter
from stickslip.diagnosis.fitting.search import Progress, recalibrated
from stickslip.diagnosis.model import (
    Predict,
    Values,
    bare_problem,
    computed_tables,
    of_record,
    overflows,
    posed,
    without_effect,
)  # fmt: skip
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter, either_way
from stickslip.diagnosis.terms.words import Vocabulary
from stickslip.errors import ScenarioError

SIDES = BEFORE, AFTER = "before", "after"
_WHERE = {BEFORE: "only before", AFTER: "only after", "both": "before and after"}
"""Words behind the name of a cause, and what they mean."""

Models = Callable[[Sequence[Table]], tuple[Predict, Predict | None]]
"""The forward model of some tables, and a cheaper one."""

_T = TypeVar("_T", bound=Table)
_RELAXED = 5.0
"""Times the stated error of a constant within which it is likely: what both sides share need not be
as stated. Chosen: twenty errors off cost eight nats, which all models pay."""

_USUAL = 0.1
"""A usual difference, as a part of a constant. Chosen, as for the effects of `models`."""

_WIDER = 3.0
"""Of the error of a fit, where a cause of the earlier side may have bent it. Chosen."""

_SAME, _LEAST = 1e-6, 1e-9  # parts of a size within which settings are equal, or errors are none


def diagnose_change(
    predict: Predict,
    before: Table | Sequence[Table],
    after: Table | Sequence[Table],
    uncertain: Sequence[Parameter] | None = None,
    causes: Sequence[Cause] = (),
    *,
    seed: int = 0,
    progress: Progress | None = None,
) -> Diagnosis:
    """Diagnose what changed between two logs, or sets of logs, of one machine.

    Constants are shared by both sides. Each that may be a cause may have changed (``<name>
    change``), and each effect and instrument may be there on one side only (``<name> before``,
    ``<name> after``); where both sides have what no difference explains, in both (``<name> both``).
    In `Diagnosis.extended` are the parameters of each side.

    Parameters
    ----------
    predict, uncertain, causes, seed, progress
        As for `diagnose_model`. A law of a free shape is no cause here.
    before, after : Table, Series, or sequence of them
        Where each has a counterpart with equal settings, or with equal times and inputs, errors of
        the model that are the same in both do not count.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ScenarioError
        If something is given that is not allowed.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Parameter, Prior, Table, diagnose_change
    >>> x = np.linspace(1.0, 3.0, 12)
    >>> def line(table, p):
    ...     return p["slope"] * table["x"]
    >>> slope = Parameter("slope", Prior("normal", 1.0, 0.1))
    >>> logs = [Table({"x": x}, k * x + np.sin(9 * x), sd=0.1) for k in (1.0, 1.3)]
    >>> result = diagnose_change(line, *logs, [slope])
    >>> result.verdict.kind, result.verdict.causes
    ('named', ('slope change',))
    """
    check_whole("seed", seed)
    tables = [*_of_side(before, BEFORE), *_of_side(after, AFTER)]
    stated = stated_terms(predict, uncertain, causes, tables)
    with one_blas_thread():
        absent = TwoSides.of(predict, stated[0], _differences(*stated))
        whole = posed(tables, absent, stated[0], ())
        tables = list(computed_tables(whole, int(seed)))
        lost = (note for table in tables for note in table.own_notes)
        fault = next((note for note in lost if note.code == LOST_SENSOR), None) or unit_fault(
            whole, lambda others: bare_problem(others, absent, stated[0], ()),
            units_of(predict), int(seed),
        )  # fmt: skip
        problem = posed_change(tables, lambda _: (predict, None), *stated, seed=int(seed))
        fault = fault or absolute_fault(whole)
        problem = problem if fault else with_scatter(problem, int(seed))
        notes = [*overflows(problem), *without_effect(problem)]
        return diagnosed(problem, int(seed), progress, notes, fault=fault)


def _of_side(given: Any, side: str) -> list[Table]:
    tables = [given] if isinstance(given, Table) else given
    each = isinstance(tables, Sequence) and all(isinstance(one, Table) for one in tables)
    if not each or not tables:
        what = "a Table or a Series, or a list of them"
        raise ScenarioError(f"{side} = {brief(given)}: allowed is {what}")
    several = len(tables) > 1
    return [(one.having(name=f"{k}") if several and not one.name else one).of_side(side)
            for k, one in enumerate(tables, start=1)]  # fmt: skip


def absolute_fault(whole: problems.Problem) -> Note | None:
    """What is wrong with the data of a side; how large their errors are is asked later."""
    tables = [one if one.errors.known else one.having(errors=replace(one.errors, dof=math.inf))
              for one in whole.tables]  # fmt: skip
    return fault_of(replace(whole, tables=tuple(tables), errors=()))


def posed_change(
    tables: Sequence[Table], models: Models, constants: Sequence[Parameter],
    causes: Sequence[Cause], *, seed: int, alike: bool = True, words: Vocabulary | None = None,
    sides: Callable[[TwoSides], Sides] | None = None,
) -> problems.Problem:  # fmt: skip
    """The problem of two sides, whose tables say of which they are.

    They are `alike` where nothing but their settings tells what a table was measured with.
    """
    paired, words = _paired(tables) if alike else [], words or Vocabulary()
    every = list(_differences(constants, causes, [table.name for table in tables], words))
    listed = [one for one in every if one.side and not (paired and _undone(one))]
    # Constants have half of the prior probability that something changed. Chosen: a machine that
    # wears or is loaded has another constant, and seldom a new effect.
    changes = sum(cause.changes is not None for cause in listed)
    odds = max((len(listed) - changes) / max(changes, 1), 1.0)
    listed = [replace(one, odds=odds if one.changes else one.odds) for one in listed]
    fitted = [_relaxed(constant) for constant in constants]
    if paired:
        before = [table for table in tables if table.side == BEFORE]
        absent, draft = (TwoSides.of(each, constants, every) for each in models(before))
        low = None if draft.predict is None else draft
        first = bare_problem(before, absent, constants, (), low)
        fitted, paired = _as_before(first, constants, paired, seed)
    model, cheap = (TwoSides.of(each, constants, every) for each in models(paired or tables))
    made = posed(
        paired or tables, model, fitted, listed,
        low_fidelity=None if cheap.predict is None else cheap,
        rivals=(sides or Sides)(model), words=_words(words, every),
        laws=None if paired else lambda *_: [cause for cause in every if not cause.side],
    )  # fmt: skip
    return replace(made, forward=None)


@dataclass(frozen=True, repr=False, eq=False)
class TwoSides(OneLine):
    """A forward model of tables of both sides, with all differences but of instruments."""

    predict: Predict | None
    differences: tuple[Cause, ...]
    constants: tuple[Parameter, ...]

    @staticmethod
    def of(
        predict: Predict | None, constants: Sequence[Parameter], causes: Iterable[Cause]
    ) -> TwoSides:
        """What a function makes of both sides; it is not called if it is None."""
        physics = tuple(cause for cause in causes if not cause.is_instrument)
        return TwoSides(predict, physics, tuple(constants))

    def __call__(self, table: Table, p: Mapping[str, Array], *curves: Any) -> Array:
        vectors, own = max(map(len, p.values()), default=1), self.values(table.side, p)
        rows = {name: np.broadcast_to(value, (vectors, 1)) for name, value in own.items()}
        assert self.predict is not None
        return self.predict(table, Values(rows), *curves)

    def values(self, side: str, p: Mapping[str, Any]) -> dict[str, Any]:
        """Parameters of the model on a side, where absent differences are not in `p`."""
        known = {one.name for cause in self.differences for one in cause.parameters}
        own = {name: value for name, value in p.items() if name not in known}
        for cause in self.differences:
            first, there = cause.parameters[0], cause.side in ("", side)
            acts = p.get(first.name, first.middle) != first.middle
            for one in cause.parameters:
                name = cause.changes or old_name(one.name)
                before = own.setdefault(name, one.middle)
                if there and one is first and not one.falls:
                    own[name] = before + p.get(one.name, one.middle) - one.middle
                elif there:  # the last that acts has its shape
                    own[name] = np.where(acts, p.get(one.name, one.middle), before)
        for constant in self.constants:
            if constant.name in own:
                own[constant.name] = np.clip(own[constant.name], constant.low, constant.high)
        return own


class Sides(Rivals):
    """Both sides of the extended model; of a model of one's own the values of its parameters."""

    def __init__(self, model: TwoSides) -> None:
        self.model = model

    def sides(self, values: Mapping[str, Any]) -> dict[str, dict[str, float]]:
        told = {*values, *(old_name(name) for name in values)}
        return {side: {name: float(value) for name, value in self.model.values(side, values).items()
                       if name in told} for side in SIDES}  # fmt: skip

    def extended(self, values: Mapping[str, Any], covariance: DataFrame | None) -> Any:
        return self.sides(values)


def _differences(
    constants: Sequence[Parameter], causes: Sequence[Cause], tables: Sequence[str] = (),
    words: Vocabulary | None = None,
) -> Iterator[Cause]:  # fmt: skip
    for constant in constants:
        if constant.cause and not constant.each_record:
            middle, far = constant.value(np.array([0.0, 1.0])).tolist()
            size = max(abs(far - middle), _USUAL * abs(middle))
            change = either_way(f"{constant.name} change", constant.unit, size)
            known = words.constants if words else {}
            title = known.get(constant.name, {}).get("name", constant.name)
            yield Cause(change.name, (change,), f"a change of {title}", side=AFTER,
                        changes=constant.name)  # fmt: skip
    for cause in causes:
        if cause.curve is not None or cause.frees is not None:
            raise ScenarioError(f"cause {cause.name}: allowed is no law of a free shape here")
        for word in _WHERE:
            table = None if cause.table is None else f"{word} {cause.table}"
            if table is None or table in tables:
                yield _copy(cause, word, table)


def _copy(cause: Cause, word: str, table: str | None) -> Cause:
    """A cause that acts where a word says, with parameters of its own."""
    parts = [replace(one, name=_named(one.name, word)) for one in cause.parameters]
    what = cause.meaning.strip().rstrip(".") or f"“{cause.name}”"

    def own(p: Mapping[str, Array]) -> dict[str, Array]:
        return {old_name(one.name): p[one.name] for one in parts}

    read, acts = cause.read, cause.acts
    return replace(
        cause, name=f"{cause.name} {word}", parameters=tuple(parts), table=table,
        meaning=f"{what} {_WHERE[word]}", side=word if word in SIDES else "",
        read=read and (lambda readings, predicted, p, of: read(readings, predicted, own(p), of)),
        acts=acts and (lambda signal, p: acts(signal, own(p))),
    )  # fmt: skip


def _named(name: str, word: str) -> str:
    head, dot, last = name.rpartition(".")
    return f"{head} {word}.{last}" if dot else f"{name} {word}"


def old_name(name: str) -> str:
    """The name in the model of a parameter of a difference."""
    for word in (*_WHERE, "change"):
        head, dot, last = name.rpartition(f" {word}")
        if dot and (not last or last.startswith(".")):
            return head + last
    return name


def _undone(cause: Cause) -> bool:
    """Whether a cause of the earlier side is one of the later side with the other sign."""
    first = cause.parameters[0]
    either = first.is_amplitude and not first.one_sided and not first.falls
    return cause.side == BEFORE and either


def _words(words: Vocabulary, causes: Sequence[Cause]) -> Vocabulary:
    """The words of a model, with those of differences."""
    rows, constants = dict(words.causes), dict(words.constants)
    for cause in causes:
        name, _, word = cause.name.rpartition(" ")
        row = words.causes.get(name) or words.constants.get(name)
        if row is not None and cause.changes is not None:
            constants[cause.name] = {**row, "name": cause.meaning.removeprefix("a ")}
            rows[cause.name] = {**row, "name": cause.meaning, "finding": "", "remedy": "",
                                "sizes": {}}  # fmt: skip
        elif row is not None:
            where = _WHERE[word]
            rows[cause.name] = {**row, "name": f"{row['name']} {where}",
                                "finding": f"{where.capitalize()}: {row['finding']}"}  # fmt: skip
            olds = {one.name: old_name(one.name) for one in cause.parameters}
            constants |= {new: words.constants[old] for new, old in olds.items()
                          if old in words.constants}  # fmt: skip
    return replace(words, causes=rows, constants=constants)


def _relaxed(constant: Parameter) -> Parameter:
    """A constant that need not be as stated, and is no cause by itself."""
    prior = constant.prior
    if prior is None or constant.each_record:
        return constant
    wider = {"normal": _RELAXED * prior.second, "log-normal": prior.second**_RELAXED}
    second = wider.get(prior.kind, prior.second)
    return replace(constant, prior=Prior(prior.kind, prior.first, second), cause=False)


def _as_before(
    problem: problems.Problem, constants: Sequence[Parameter], paired: Sequence[Table], seed: int
) -> tuple[list[Parameter], list[Table]]:
    """The constants as the earlier side has them, as well known as they are stated.

    Those of which a range is stated, and those of the earlier records, to which pairs of tables
    refer, are as well known as their fit, with what it misses.
    """
    fit = recalibrated(problem, seed)[0]
    scatter = math.sqrt(fit.chi2 / max(len(problem.y) - len(fit.free), 1))
    if all(errors.known for errors in problem.errors):
        scatter = max(scatter, 1.0)
    away = np.minimum(_WIDER * scatter * np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)), 1.0)
    known, stated = {}, {one.name for one in constants if one.is_stated}
    for constant, x, reach in zip(problem.constants, fit.x.tolist(), away.tolist(), strict=False):
        reach = 1.0 if constant.name in stated else reach or 1.0
        low, value, high = constant.value(x + reach * np.array([-1.0, 0.0, 1.0])).tolist()
        prior = Prior("normal", value, max(0.5 * (high - low), _LEAST * abs(value), 1e-300))
        if constant.prior is not None and constant.prior.kind != "normal":
            prior = Prior("log-normal", value, max(math.sqrt(high / low), 1.0 + _LEAST))
        known[constant.name] = prior
    fitted = [one if one.each_record else replace(one, prior=known[one.name], cause=False)
              for one in constants]  # fmt: skip
    own = [one for one in constants if one.each_record]
    tables = []
    for table in paired:
        assert table.less is not None
        other, order = table.less
        is_record = isinstance(other, Series)
        starts = {one.name: known[of_record(one, other)] for one in own if is_record}
        tables.append(table.having(less=(other.having(starts=starts), order)))
    return fitted, tables


def _paired(tables: Sequence[Table]) -> list[Table]:
    """A table of differences for each of the later side; none unless every table has its like."""
    rest, made = [table for table in tables if table.side == BEFORE], []
    for table in tables:
        if table.side == AFTER:
            orders = ((other, _order(other, table)) for other in rest)
            like = next(((other, order) for other, order in orders if order is not None), None)
            if like is None:
                return []
            rest.remove(like[0])
            made.append(_less(table, *like))
    return [] if rest else made


def _order(before: Table, after: Table) -> Indices | None:
    """Conditions of one table in the order of another with the same settings; None of others."""
    if type(before) is not type(after) or len(before.mean) != len(after.mean):
        return None
    if isinstance(before, Series) and isinstance(after, Series):
        columns = [(before.t - before.t[0], after.t - after.t[0], after.step)]
        if before.inputs.keys() != after.inputs.keys():
            return None
        columns += [(one, after.inputs[name], float(np.max(np.abs(one))))
                    for name, one in before.inputs.items()]  # fmt: skip
        same = all(np.all(np.abs(one - other) <= _SAME * size) for one, other, size in columns)
        return np.arange(len(before.mean)) if same else None
    places, keys = ({key: k for k, key in enumerate(_keys(one))} for one in (before, after))
    same = len(places) == len(before.mean) and places.keys() == keys.keys()
    return np.array([places[key] for key in keys]) if same else None


def _keys(table: Table) -> list[tuple[str, ...]]:
    columns = [values for values, _ in table.named_settings.values()]
    texts = [[one if isinstance(one, str) else f"{float(one) + 0.0:.6g}" for one in column]
             for column in columns]  # fmt: skip
    return list(zip(*texts, strict=True)) if texts else [()] * len(table.mean)


def _less(after: _T, before: Table, order: Indices) -> _T:
    """Readings of one table less those of the conditions of another."""
    off, one, other = before.mean[order], after.errors, before.errors
    covariance, dof = None, 0.0
    if one.covariance is not None or other.covariance is not None:
        parts = [np.diag(each.sd**2) if each.covariance is None else each.covariance
                 for each in (one, other)]  # fmt: skip
        covariance = parts[0] + parts[1][np.ix_(order, order)]
    if one.known and other.known:  # as Satterthwaite has it
        means = [float(np.mean(each.sd**2)) for each in (one, other)]
        spread = means[0] ** 2 / one.dof + means[1] ** 2 / other.dof
        dof = sum(means) ** 2 / spread if spread else math.inf
    sizes = {"s0": math.hypot(*(each.sizes.get("s0", 0.0) for each in (one, other)))}
    notes = (*one.notes, *other.notes)
    errors = Errors(np.hypot(one.sd, other.sd[order]), covariance, dof, sizes, notes)
    return after.having(
        y=after.y - off[after.condition], mean=after.mean - off, errors=errors, repeat_of=None,
        less=(before, order), own_notes=(*before.own_notes, *after.own_notes),
    )  # fmt: skip
