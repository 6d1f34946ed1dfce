"""What differs between two states of a machine, `before` and `after`: one problem of both.

A cause is one difference: a constant that has another value after, or an effect, an instrument or
an event that is there on one side only. What both sides share cancels. Where each table has one of
the same settings on the other side, or of the same times and inputs, their differences are what is
fitted, so that errors of the model that both have cancel too. Elsewhere both are fitted as they
are, and where no difference explains them, effects that both may have are tried as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
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
from stickslip.diagnosis.data.signal import Signal
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.entry import diagnosed, fault_of, one_blas_thread, stated_terms, units_of
from stickslip.diagnosis.fitting.other_units import unit_fault
from stickslip.diagnosis.fitting.problem import Problem
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
)
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.terms.cause import Acts, Cause, Read
from stickslip.diagnosis.terms.parameter import LARGEST_ERROR, Parameter, either_way
from stickslip.diagnosis.terms.words import Vocabulary
from stickslip.errors import ScenarioError

SIDES = BEFORE, AFTER = "before", "after"
WHERE = {BEFORE: "only before", AFTER: "only after", "both": "before and after"}
"""Words behind the name of a cause, and what they mean."""

_T = TypeVar("_T", bound=Table)
Models = Callable[[Sequence[Table]], tuple[Predict, Predict | None]]
"""The forward model of some tables, and a cheaper one."""

_RELAXED = 5.0
"""Times the stated error of a constant within which it is likely: what both sides share need not be
as stated. Chosen: twenty errors off cost eight nats, which all models pay."""

_USUAL = 0.1
"""A usual difference, as a part of a constant. Chosen, as for the effects of `models`."""

_SAME = 1e-6  # part of a column's size, or of a step, within which settings are equal
_LEAST = 1e-9  # error of a fitted constant, as a part of it: below it is rounding


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
    tables = [*of_side(before, BEFORE), *of_side(after, AFTER)]
    stated = stated_terms(predict, uncertain, causes, tables)
    with one_blas_thread():
        whole = posed(tables, predict, stated[0], ())
        tables = list(computed_tables(whole, int(seed)))
        lost = (note for table in tables for note in table.own_notes)
        fault = next((note for note in lost if note.code == LOST_SENSOR), None) or unit_fault(
            whole, lambda others: bare_problem(others, predict, stated[0], ()),
            units_of(predict), int(seed),
        )  # fmt: skip
        problem = posed_change(tables, lambda _: (predict, None), *stated, seed=int(seed))
        fault = fault or absolute_fault(whole)
        problem = problem if fault else with_scatter(problem, int(seed))
        notes = [*overflows(problem), *without_effect(problem)]
        return diagnosed(problem, int(seed), progress, notes, fault=fault)


def of_side(given: Any, side: str) -> list[Table]:
    """Tables of a side, with its word in their names."""
    tables = [given] if isinstance(given, Table) else given
    if not isinstance(tables, Sequence) or not all(isinstance(each, Table) for each in tables):
        raise ScenarioError(
            f"{side} = {brief(given)}: allowed is a Table or a Series, or a list of them"
        )
    if not tables:
        raise ScenarioError(f"{side} = []: allowed is one log or more")
    return [
        table.named(f"{k}").of_side(side)
        if isinstance(table, Series) and not table.name and len(tables) > 1
        else table.of_side(side)
        for k, table in enumerate(tables, start=1)
    ]


def absolute_fault(whole: Problem) -> Note | None:
    """What is wrong with the data of a side; how large their errors are is asked later."""
    tables = [
        table if table.errors.known else table.having(errors=replace(table.errors, dof=math.inf))
        for table in whole.tables
    ]
    return fault_of(replace(whole, tables=tuple(tables), errors=()))


def posed_change(
    tables: Sequence[Table],
    models: Models,
    constants: Sequence[Parameter],
    causes: Sequence[Cause],
    *,
    seed: int,
    alike: bool = True,
    words: Vocabulary | None = None,
    sides: type[Sides] | partial[Sides] | None = None,
) -> Problem:
    """The problem of two sides, whose tables say of which they are.

    They are `alike` where nothing but their settings tells what a table was measured with.
    """
    paired = _paired(tables) if alike else []
    fitted = [_relaxed(constant) for constant in constants]
    if paired:
        before = [table for table in tables if table.side == BEFORE]
        predict, cheap = models(before)
        fitted, paired = _as_before(
            bare_problem(before, predict, constants, (), cheap), constants, paired, seed
        )
    every = list(_differences(constants, causes, tables, words or Vocabulary()))
    shared = [cause for cause in every if not cause.side]
    listed = [cause for cause in every if cause.side and not (paired and _undone(cause))]
    of = {name: act for cause in every for name, act in _acts(cause, constants, causes)}
    predict, cheap = (None if model is None else TwoSides(model, of)
                      for model in models(paired or tables))  # fmt: skip
    assert predict is not None
    return replace(
        posed(
            paired or tables, predict, fitted, listed, low_fidelity=cheap,
            laws=None if paired else lambda problem, x: shared,
            words=_words(words, every), rivals=(sides or Sides)(predict),
        ), forward=None,
    )  # fmt: skip


# ------------------------------------------------------------------------- the model
@dataclass(frozen=True)
class _Act:
    """What a parameter of the problem does to one of the model, by the name `to`.

    The difference of a `constant` is added to it, and so is an amplitude. A shape is that of the
    amplitude `first`, where that is not `off`.
    """

    to: str
    side: str
    absent: float
    added: bool
    first: str
    off: float
    constant: Parameter | None = None


@dataclass(frozen=True, repr=False, eq=False)
class TwoSides(OneLine):
    """A forward model of tables of both sides; `acts` are by the parameters of the problem."""

    predict: Predict
    acts: Mapping[str, _Act]

    def __call__(self, table: Table, p: Mapping[str, Array], *curves: Any) -> Array:
        vectors, own = max(map(len, p.values()), default=1), self.values(table.side, p)
        rows = {name: np.broadcast_to(value, (vectors, 1)) for name, value in own.items()}
        return self.predict(table, Values(rows), *curves)

    def values(self, side: str, p: Mapping[str, Any]) -> dict[str, Any]:
        """Parameters of the model on a side; those of absent differences are at `absent`."""
        own = {name: value for name, value in p.items() if name not in self.acts}
        for name, act in self.acts.items():
            before = own.get(act.to, act.absent)
            if act.side not in ("", side):
                own[act.to] = before
            elif act.added:
                own[act.to] = before + p.get(name, act.absent) - act.absent
            else:
                acts = p.get(act.first, act.off) != act.off
                own[act.to] = np.where(acts, p.get(name, act.absent), before)
            if act.constant is not None:
                own[act.to] = np.clip(own[act.to], act.constant.low, act.constant.high)
        return own


class Sides(Rivals):
    """Both sides of the extended model; of a model of one's own the values of its parameters."""

    def __init__(self, model: TwoSides) -> None:
        self.model = model

    def sides(self, values: Mapping[str, Any]) -> dict[str, dict[str, float]]:
        return {side: {name: float(value) for name, value in self.model.values(side, values).items()}
                for side in SIDES}  # fmt: skip

    def extended(self, values: Mapping[str, Any], covariance: DataFrame | None) -> Any:
        return self.sides(values)


# -------------------------------------------------------------------------- differences
def _differences(
    constants: Sequence[Parameter], causes: Sequence[Cause], tables: Sequence[Table],
    words: Vocabulary,
) -> Iterator[Cause]:  # fmt: skip
    for constant in constants:
        if constant.cause and not constant.each_record:
            middle, far = constant.value(np.array([0.0, 1.0])).tolist()
            size = max(abs(far - middle), _USUAL * abs(middle))
            change = either_way(f"{constant.name} change", constant.unit, size)
            title = words.constants.get(constant.name, {}).get("name", constant.name)
            yield Cause(change.name, (change,), f"a change of {title}", side=AFTER,
                        changes=constant.name)  # fmt: skip
    names = {table.name for table in tables}
    for cause in causes:
        if cause.curve is not None or cause.frees is not None:
            raise ScenarioError(f"cause {cause.name}: allowed is no law of a free shape here")
        for word in WHERE:
            table = None if cause.table is None else f"{word} {cause.table}"
            if table is None or table in names:
                yield _copy(cause, word, table)


def _copy(cause: Cause, word: str, table: str | None) -> Cause:
    """A cause that acts where a word says, with parameters of its own."""
    old = {_named(one.name, word): one.name for one in cause.parameters}
    parts = [replace(one, name=new) for new, one in zip(old, cause.parameters, strict=True)]
    what = cause.meaning.strip().rstrip(".") or f"“{cause.name}”"
    return replace(
        cause, name=f"{cause.name} {word}", parameters=tuple(parts), table=table,
        meaning=f"{what} {WHERE[word]}", side=word if word in SIDES else "",
        read=cause.read and partial(_read, cause.read, old),
        acts=cause.acts and partial(_acted, cause.acts, old),
    )  # fmt: skip


def _named(name: str, word: str) -> str:
    head, dot, last = name.rpartition(".")
    return f"{head} {word}.{last}" if dot else f"{name} {word}"


def _read(read: Read, old: Mapping[str, str], readings: Array, predicted: Array,
          p: Mapping[str, Array], table: Table) -> Array:  # fmt: skip
    return read(readings, predicted, {name: p[new] for new, name in old.items()}, table)


def _acted(acts: Acts, old: Mapping[str, str], signal: Signal, p: Mapping[str, Array]) -> Signal:
    return acts(signal, {name: p[new] for new, name in old.items()})


def _undone(cause: Cause) -> bool:
    """Whether a cause of the earlier side is one of the later side with the other sign."""
    first = cause.parameters[0]
    either = first.is_amplitude and not first.one_sided and not first.falls
    return cause.side == BEFORE and either and cause.between is None


def _acts(
    cause: Cause, constants: Sequence[Parameter], causes: Sequence[Cause]
) -> Iterator[tuple[str, _Act]]:
    """What the parameters of a difference do; those of an instrument do it themselves."""
    first = cause.parameters[0].name
    off, *_ = absent = [float(one.value(np.zeros(1))[0]) for one in cause.parameters]
    if cause.changes is not None:
        constant = next(one for one in constants if one.name == cause.changes)
        yield first, _Act(constant.name, AFTER, 0.0, True, first, 0.0, constant)
    elif not cause.is_instrument:
        given = next(one for one in causes if cause.name.rpartition(" ")[0] == one.name)
        for one, old, value in zip(cause.parameters, given.parameters, absent, strict=True):
            added = one.is_amplitude and not one.falls
            yield one.name, _Act(old.name, cause.side, value, added, first, off)


def _words(words: Vocabulary | None, causes: Sequence[Cause]) -> Vocabulary:
    """The words of a model, with those of differences."""
    words = words or Vocabulary()
    rows, constants = dict(words.causes), dict(words.constants)
    for cause in causes:
        name, _, word = cause.name.rpartition(" ")
        row = words.causes.get(name) or words.constants.get(name)
        if row is None:
            continue
        if cause.changes is not None:
            constants[cause.name] = {**row, "name": f"change of the {row['name']}"}
            rows[cause.name] = {**row, "name": cause.meaning, "finding": "", "remedy": "",
                                "sizes": {}}  # fmt: skip
        else:
            where = WHERE[word]
            rows[cause.name] = {**row, "name": f"{row['name']} {where}",
                                "finding": f"{where.capitalize()}: {row['finding']}"}  # fmt: skip
            constants |= {new.name: words.constants[old] for new in cause.parameters
                          if (old := new.name.replace(f" {word}", "")) in words.constants}  # fmt: skip
    return replace(words, causes=rows, constants=constants)


# ------------------------------------------------------------------------- constants
def _relaxed(constant: Parameter) -> Parameter:
    """A constant that need not be as stated, and is no cause by itself."""
    prior = constant.prior
    if prior is not None and prior.kind == "normal":
        prior = Prior("normal", prior.first, _RELAXED * prior.second)
    elif prior is not None and prior.kind == "log-normal":
        prior = Prior("log-normal", prior.first, prior.second**_RELAXED)
    return constant if constant.each_record else replace(constant, prior=prior, cause=False)


def _as_before(
    problem: Problem, constants: Sequence[Parameter], paired: Sequence[Table], seed: int
) -> tuple[list[Parameter], list[Table]]:
    """The constants as the earlier side has them, with errors that its misfit widens.

    Those of each record are known of the earlier ones, to which pairs of tables refer.
    """
    fit = recalibrated(problem, seed)[0]
    scatter = math.sqrt(fit.chi2 / max(len(problem.y) - len(fit.free), 1))
    if all(errors.known for errors in problem.errors):
        scatter = max(scatter, 1.0)
    sd = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)) * scatter
    known = {}
    for constant, x, error in zip(problem.constants, fit.x.tolist(), sd.tolist(), strict=False):
        away = min(error, 1.0) or 1.0
        low, value, high = constant.value(x + away * np.array([-1.0, 0.0, 1.0])).tolist()
        if constant.prior is not None and constant.prior.kind == "normal":
            least = _LEAST * max(abs(value), 1e-300)
            known[constant.name] = Prior("normal", value, max(0.5 * (high - low), least))
        else:
            factor = max(math.sqrt(high / low), 1.0 + _LEAST)
            known[constant.name] = Prior("log-normal", value, factor)
    fitted = [one if one.each_record else replace(one, prior=known[one.name], cause=False)
              for one in constants]  # fmt: skip
    own = [one for one in constants if one.each_record]
    tables = []
    for table in paired:
        assert table.less is not None
        other, order = table.less
        starts = {one.name: known[name] for one in own if (name := of_record(one, other)) in known}
        tables.append(table.having(less=(other.having(starts=starts), order)))
    return fitted, tables


# ------------------------------------------------------------------------ pairs of tables
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
    if not isinstance(before, Series):
        keys = [_keys(table) for table in (before, after)]
        places = {key: k for k, key in enumerate(keys[0])}
        alike = len(places) == len(before.mean) and set(keys[1]) == set(places)
        return np.array([places[key] for key in keys[1]]) if alike else None
    columns = [(before.t - before.t[0], after.t - after.t[0], after.step)]
    if isinstance(after, Series) and before.inputs.keys() == after.inputs.keys():
        columns += [(one, after.inputs[name], float(np.max(np.abs(one))))
                    for name, one in before.inputs.items()]  # fmt: skip
        if all(np.all(np.abs(one - other) <= _SAME * size) for one, other, size in columns):
            return np.arange(len(before.mean))
    return None


def _keys(table: Table) -> list[tuple[str, ...]]:
    settings = table.named_settings
    texts = [
        [each if isinstance(each, str) else f"{float(each) + 0.0:.6g}" for each in settings[name][0]]
        for name in settings
    ]
    return list(zip(*texts, strict=True)) if texts else [()] * len(table.mean)


def _less(after: _T, before: Table, order: Indices) -> _T:
    """Readings of one table less those of the conditions of another."""
    off = before.mean[order]
    one, other = after.errors, before.errors
    variances = one.sd**2, other.sd[order] ** 2
    covariance = None
    if one.covariance is not None or other.covariance is not None:
        parts = [np.diag(each.sd**2) if each.covariance is None else each.covariance
                 for each in (one, other)]  # fmt: skip
        covariance = parts[0] + parts[1][np.ix_(order, order)]
    dof = 0.0
    if one.known and other.known:  # as Satterthwaite has it
        means = [float(np.mean(each)) for each in variances]
        spread = means[0] ** 2 / one.dof + means[1] ** 2 / other.dof
        dof = sum(means) ** 2 / spread if spread else math.inf
    errors = Errors(
        np.sqrt(variances[0] + variances[1]), covariance, dof,
        {"s0": math.hypot(*(each.sizes.get("s0", 0.0) for each in (one, other)))},
        (*one.notes, *other.notes),
    )  # fmt: skip
    return after.having(
        y=after.y - off[after.condition], mean=after.mean - off, errors=errors,
        less=(before, order), repeat_of=None,
        own_notes=(*before.own_notes, *after.own_notes),
    )  # fmt: skip
