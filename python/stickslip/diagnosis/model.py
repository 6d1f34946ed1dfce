"""A forward model and its data as a problem."""

from __future__ import annotations

import contextlib
import inspect
import itertools
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from stickslip._util.arrays import Array, Mask, columns_of, distinct_rows, locked, numbers
from stickslip._util.messages import meant
from stickslip._util.note import Note
from stickslip._util.text import OneLine, brief
from stickslip._util.units import is_of, same_unit
from stickslip.diagnosis.data.series import Series, with_repeats
from stickslip.diagnosis.data.signal import Signal
from stickslip.diagnosis.data.table import Table, rows_in_words
from stickslip.diagnosis.fitting.fineness import with_measured_fineness
from stickslip.diagnosis.fitting.problem import HUGE, Cached, Problem
from stickslip.diagnosis.fitting.rivals import Rivals
from stickslip.diagnosis.fitting.starts import recalibrated
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.instruments import read_by
from stickslip.diagnosis.terms.laws import Curves, beside_constants
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.diagnosis.terms.words import Vocabulary
from stickslip.errors import ScenarioError

Predict = Callable[..., Array]
"""``predict(table, p)`` of a `Table` or `Series`, or ``predict(table, p, curves)``, which free laws
need."""


_ARRAYS = "p holds arrays of shape (vectors, 1): allowed is a model that returns (vectors, rows)"
_MEANT = {
    "read-only": 'it writes into its table or into p: allowed are copies, as table["x"].copy()',
    **dict.fromkeys(("truth value of an array", "only length-1 arrays",
                     "only 0-dimensional arrays", "must be real number, not"), _ARRAYS),
}  # fmt: skip
"""Meanings of errors of NumPy in a user's model, by a part of their text."""

_AT_ONCE = 1 << 19  # numbers of a block of predictions: 4 MiB; chosen
_MOST_LOST = 0.1  # part of the rows that the model may not compute; chosen
# Readings that a search of a record begins with, at least; how far their predictions may differ, in
# the scatter of all; and the part of the usual changes in all that they have to see. Chosen.
_FIRST, _SAME_FIRST, _AS_LARGE = 2000, 1e-6, 0.5
_FEWEST_VALUES = 8  # different readings of a copy; chosen: a coarse meter may read fewer twice
_SAME = 1e-9  # part of the readings by which two equal calls may differ; chosen: rounding


class Values(dict[str, Array]):
    """Values of the parameters by name, each of shape (vectors, 1)."""

    def __missing__(self, name: str) -> Array:
        raise ScenarioError(f"p: there is no parameter {name}{meant(str(name), self)}")


def posed(
    tables: Table | Sequence[Table], predict: Predict, constants: Sequence[Parameter],
    causes: Sequence[Cause], *, low_fidelity: Predict | None = None,
    laws: Callable[[Problem, Array], Sequence[Cause]] | None = None,
    words: Vocabulary | None = None, rivals: Rivals | None = None,
) -> Problem:  # fmt: skip
    """The problem that data pose to a forward model: the one door of the diagnosis.

    Parameters
    ----------
    tables, predict, constants, causes
        As for `diagnose_model`. A `predict` with the attribute `jumps` is a simulation, whose
        predictions jump and cost too much for measuring how they turn.
    low_fidelity : callable, optional
        A cheaper `predict` for searches from afar, of a simulation whose predictions jump.
    laws : callable, optional
        ``laws(problem, x)`` returns laws of a free shape as causes, at coordinates `x` of the
        recalibrated constants, for data that no listed cause explains.
    words : Vocabulary, optional
        What causes and constants are called.
    rivals : Rivals, optional
        What else can be measured.
    """
    problem = bare_problem(tables, predict, constants, causes, low_fidelity)
    words, rivals = words or problem.words, rivals or problem.rivals
    problem = replace(problem, laws=laws, words=words, rivals=rivals)
    if getattr(predict, "jumps", False):
        return problem
    if np.all(_not_computed(problem, np.zeros(problem.size))):
        raise ScenarioError("predict: with the stated parameters it computes no reading")
    stated = problem.physical(np.zeros((1, problem.size)))
    assert isinstance(problem.model, Cached)
    once, again = problem.model(stated), problem.model.anew(stated)
    if not np.allclose(once, again, _SAME, _SAME * np.nanmax(np.abs(once)), equal_nan=True):
        text = "allowed is a function of its arguments alone; fix the seed of its random numbers"
        raise ScenarioError(f"predict: it returns other readings when it is called again: {text}")
    return _with_short(with_measured_fineness(problem))


def bare_problem(
    tables: Table | Sequence[Table], predict: Predict, constants: Sequence[Parameter],
    causes: Sequence[Cause], low_fidelity: Predict | None = None,
) -> Problem:  # fmt: skip
    """The same in the user's words, before anything is predicted."""
    given = tables_in("data", tables)
    for key, each, kind in (("uncertain", constants, Parameter), ("causes", causes, Cause)):
        if not isinstance(each, Sequence) or not all(isinstance(one, kind) for one in each):
            raise ScenarioError(f"{key} = {brief(each)}: allowed is a list of {kind.__name__}")
    for constant in constants:
        if constant.prior is None:
            text = f"uncertain: {constant.name} has no prior; an amplitude belongs to a Cause"
            raise ScenarioError(text)
    records = tuple(_records(given))
    fitted = _of_each_record(constants, records)
    named = tuple(beside_constants(causes, fitted))
    _check_names(records, fitted, named)
    _check_copies(records)
    _check_causes(records, fitted, named)
    model = ForwardModel(predict, low_fidelity, tuple(constants), (*named, *relaxed(fitted)))
    _check_predict(predict, model)
    return Problem(records, constants=fitted, **_of_model(model, records, fitted))


def _with_short(problem: Problem) -> Problem:
    """The problem of a long record whose first readings tell each coordinate as well as the others.

    Their predictions have to be the same, and so has, nearly, what the usual size of a coordinate
    changes in the mean.
    """
    (table, *others), count = problem.tables, _FIRST
    record = isinstance(table, Series) and not others and table.whole is None
    if not record or len(table) < 2 * _FIRST:
        return problem
    points = np.vstack([np.zeros(problem.size), np.diag(np.clip(1.0, *problem.limits))])
    values = problem.physical(points)
    with np.errstate(all="ignore"), contextlib.suppress(ScenarioError):  # a model of one record
        whole, size = problem.model(values), np.std(table.y)
        while 2 * count <= len(table):
            shortened = partial(_of_first, count)
            first = shortened(problem).model(values)
            changes = [np.sqrt(np.mean((each - each[0]) ** 2, axis=1)) for each in (first, whole)]
            same = np.all(np.abs(first - whole[:, :count]) <= _SAME_FIRST * size)
            if same and np.all(changes[0] >= _AS_LARGE * changes[1]):
                return replace(problem, shortened=shortened)
            count *= 2
    return problem


def _of_first(count: int, problem: Problem) -> Problem:
    tables = tuple(table.first_readings(count) for table in problem.tables
                   if isinstance(table, Series))  # fmt: skip
    of_tables: Any = problem.model.anew if isinstance(problem.model, Cached) else None
    model = Cached(partial(of_tables.func, tables, *of_tables.args[1:]))
    return replace(problem, tables=tables, model=model, low_fidelity=None, errors=(),
                   simulator_noise=None, shortened=None)  # fmt: skip


def tables_in(key: str, given: Any) -> Sequence[Table]:
    """One table, or some, as a list."""
    tables = [given] if isinstance(given, Table) else given
    each = isinstance(tables, Sequence) and all(isinstance(table, Table) for table in tables)
    if not each or not tables:
        what = "a Table or a Series, or a list of them"
        raise ScenarioError(f"{key} = {brief(given)}: allowed is {what}")
    return tables


def relaxed(constants: Sequence[Parameter]) -> list[Cause]:
    """A cause for each constant that is stated with a middle: it is other than stated."""
    names = [constant.name for constant in constants if constant.may_be_off]
    return [Cause(name, (), f"{name} is other than stated", frees=name) for name in names]


def _of_model(
    model: ForwardModel, tables: tuple[Table, ...], constants: tuple[Parameter, ...],
    known: tuple[Cause, ...] = (),
) -> dict[str, Any]:  # fmt: skip
    """A problem's share of a model: causes, predictions, and how it takes more causes.

    The first causes are `known` as a problem has them.
    """
    causes = (*known, *(_in_records(cause, tables) for cause in model.causes[len(known) :]))
    names = [*(c.name for c in constants), *(p.name for c in causes for p in c.parameters)]
    low_fidelity = None
    if model.low_fidelity is not None:
        cheap = replace(model, predict=model.low_fidelity, low_fidelity=None)
        low_fidelity = Cached(partial(cheap.of_tables, tables, names))
    return {
        "model": Cached(partial(model.of_tables, tables, names)), "low_fidelity": low_fidelity,
        "causes": causes, "wider": partial(_wider, model), "forward": partial(model.of_new, names),
    }  # fmt: skip


def _wider(model: ForwardModel, problem: Problem, more: Sequence[Cause]) -> Problem:
    made = replace(model, causes=(*model.causes, *more))
    share = _of_model(made, problem.tables, problem.constants, problem.causes)
    return replace(problem, shortened=None, **share)


def computed_tables(problem: Problem, seed: int) -> tuple[Table, ...]:
    """The tables without the rows that the model without causes computes nowhere.

    That is neither at the stated constants nor where a fit of the constants ends: a cause that
    makes such a row computable would be named for that alone. A ScenarioError is raised if they are
    more than a tenth of the rows of a table.
    """
    lost = _not_computed(problem, np.zeros(problem.size))
    if lost.any():
        lost &= _not_computed(problem, recalibrated(problem, seed)[0].x)
    checked = []
    for table, part in zip(problem.tables, problem.rows, strict=True):
        gone = lost[part]
        if gone.any():
            rows = rows_in_words(table.rows[gone[table.condition]])
            why = "the model without causes computes no reading there"
            if gone.sum() > _MOST_LOST * len(gone):
                text = f"{why}: allowed are a tenth of the rows; leave them out"
                raise ScenarioError(f"predict: {table.at}{rows}: {text}")
            table = table.without(gone, f"{why}; left out of all models.")
        checked.append(table)
    return tuple(checked)


def _not_computed(problem: Problem, x: Array) -> Mask:
    with np.errstate(all="ignore"):
        return np.asarray(~np.isfinite(problem.model(problem.physical(x[None, :]))[0]))


@dataclass(frozen=True, repr=False, eq=False)
class ForwardModel(OneLine):
    """A forward model with the instruments that read it.

    `uncertain` is as it was given. A cause that is a constant other than stated changes nothing
    here.
    """

    predict: Predict
    low_fidelity: Predict | None
    uncertain: tuple[Parameter, ...]
    causes: tuple[Cause, ...]

    @property
    def laws(self) -> list[Cause]:
        """Causes that are laws of another shape."""
        return [cause for cause in self.causes if cause.curve]

    @cached_property
    def _starts(self) -> list[Parameter]:
        """Parameters that have a value of their own in each record."""
        every = (*self.uncertain, *(one for cause in self.causes for one in cause.parameters))
        return [one for one in every if one.each_record]

    @cached_property
    def takes_curves(self) -> bool:
        """Whether `predict` is called with curves; defaults and ``*rest`` need none."""
        return bool(self.laws) or not _takes(self.predict, 2)

    def of_tables(self, tables: Sequence[Table], names: Sequence[str], values: Array) -> Array:
        """Readings of the conditions of some tables, (vectors, n).

        Many vectors are predicted in blocks, in an order in which a block shares predictions.
        """
        at_once = max(_AT_ONCE // max(table.predicted for table in tables), 1)
        if len(values) > at_once:
            result = np.empty((len(values), sum(len(table.mean) for table in tables)))
            order = np.lexsort(values.T[::-1])
            for rows in np.split(order, range(at_once, len(order), at_once)):
                result[rows] = self.of_tables(tables, names, values[rows])
            return result
        of = [table.of_conditions(lambda whole: self(whole, names, values)) for table in tables]
        return np.hstack(of)

    def __call__(self, table: Table, names: Sequence[str], values: Array) -> Array:
        """Readings of a table, shape (vectors, rows), for values by name, (vectors, names).

        Vectors that differ only in what belongs to other tables share a prediction.
        """
        at = self.columns(table.name, names)
        vectors, which = distinct_rows(values[:, list(at.values())])
        acting = [cause for cause in self.causes if cause.table in (None, table.name)]

        def answer(keys: Sequence[str], rows: Array) -> Array:
            p = Values({key: locked(rows[:, [k]]) for k, key in enumerate(keys)})
            return self._answer(_seen(table, acting, p), p, len(rows))

        def physics(keys: Sequence[str], rows: Array) -> Array:
            try:
                return answer(keys, rows)
            except ScenarioError:
                for one in rows if len(rows) > 1 else ():  # the first that fails says why
                    answer(keys, one[None, :])
                raise

        readers = [cause for cause in acting if cause.input is None]
        return read_by(readers, list(at), vectors, physics, table)[which]

    def _answer(self, table: Table, p: Values, vectors: int) -> Array:
        """The own function's answer, (vectors, rows), in an array of its own; NaN is allowed.

        What goes wrong at one vector is told with its values.
        """
        curves = (Curves(self.laws, p),) if self.takes_curves else ()
        at = f" for table {table.name}" if table.name else ""
        values = ", ".join(f"{name} = {row[0, 0]:.6g}" for name, row in p.items())
        beside = f"{at} at {values}" if vectors == 1 and p else f"{at} and {vectors} vectors"
        try:
            made = self.predict(table, p, *curves)
        except ScenarioError:
            raise
        except Exception as error:
            text = f"{type(error).__name__}: {error}"
            advice = next((text for word, text in _MEANT.items() if word in str(error)), None)
            advice = advice or f"{self._title} fails{beside}: allowed is NaN where it has no answer"
            raise ScenarioError(f"predict: {advice}; {text}") from error
        rows = numbers("predict: its answer", made, "an array of numbers", gaps=True, finite=False)
        if rows.shape != (vectors, table.predicted):
            what = "None" if made is None else f"shape {np.shape(made)}"
            raise ScenarioError(
                f"predict: {self._title} returned {what}{beside}; allowed is (vectors, rows), here "
                f"{(vectors, table.predicted)}, with NaN where it has no answer"
            )
        return rows

    @property
    def _title(self) -> str:
        """The own function by its name, where it has one."""
        function = getattr(self.predict, "predict", self.predict)
        name = str(getattr((*getattr(function, "args", ()), function)[0], "__name__", ""))
        return name if name.isidentifier() else "it"

    def columns(self, table: str, names: Sequence[str]) -> dict[str, int]:
        """Columns of `names` that count for a table, by the names that the model knows."""
        elsewhere = {name for cause in self.causes for name in cause.names
                     if cause.is_instrument and cause.table not in (None, table)}  # fmt: skip
        places = {}
        for k, name in enumerate(names):
            starts = (one.name for one in self._starts if name.startswith(f"{one.name}["))
            base = next(starts, name)
            if base not in elsewhere and name in (base, f"{base}[{table}]"):
                places[base] = k
        return places

    def of_new(self, names: Sequence[str], conditions: Any, values: Array) -> Array:
        """Readings of a table, or of settings, that were not measured, (vectors, rows).

        A record of another name begins at the middles of its starts.
        """
        table = conditions
        if not isinstance(table, Table):
            columns = columns_of("conditions", conditions)
            first = conditions if columns is None else next(iter(columns.values()), [])
            table = Table(conditions, np.zeros(np.shape(first)[:1]), sd=1.0, name="conditions")
            if table.own_notes:
                raise ScenarioError(f"{table.own_notes[0]} Allowed are rows without gaps")
        middles = [start.middle for start in self._starts]
        values = np.hstack([np.tile(middles, (len(values), 1)), values])
        return self(table, [*(start.name for start in self._starts), *names], values)


def _seen(table: Table, causes: Sequence[Cause], p: Mapping[str, Array]) -> Table:
    """A record with its inputs as they act."""
    acting: dict[str, list[Cause]] = {}
    for cause in causes:
        if cause.input is not None and cause.is_instrument:
            acting.setdefault(cause.input, []).append(cause)
    if not acting or not isinstance(table, Series):
        return table

    def signal(name: str, held: bool) -> Signal:
        given = np.tile(table[name], (len(p[acting[name][0].parameters[0].name]), 1))
        made = Signal.of(table.t, given, held)
        # What reads values would sample a signal that is late, and lose when it switches.
        for cause in sorted(acting[name], key=lambda cause: cause.acts is not None):
            made = cause.acted(made, {key: p[key] for key in cause.names}, table, given)
        return made

    return table.acted_on({name: partial(signal, name) for name in acting})


def _records(tables: Sequence[Table]) -> list[Table]:
    """Tables where each series has a name, and the errors that its repeats tell."""
    series = [table for table in tables if isinstance(table, Series)]
    number = itertools.count(1)
    if len(tables) > 1:
        series = [one if one.name else one.named(f"record {next(number)}") for one in series]
    known = iter(with_repeats(series))
    return [next(known) if isinstance(table, Series) else table for table in tables]


def _of_each_record(
    uncertain: Sequence[Parameter], tables: Sequence[Table]
) -> tuple[Parameter, ...]:
    """The constants, with one for each record where a parameter has a value of its own there."""
    constants, records = [], [table.name for table in tables if isinstance(table, Series)]
    for one in uncertain:
        if one.each_record and not records:
            raise ScenarioError(f"parameter {one.name}: each_record: allowed beside a Series")
        names = [f"{one.name}[{record}]" if record else one.name for record in records]
        constants += [replace(one, name=name, cause=False, each_record=False) for name in names
                      ] if one.each_record else [one]  # fmt: skip
    return tuple(constants)


def _in_records(cause: Cause, tables: Sequence[Table]) -> Cause:
    """The cause with parameters of each record; tables that are none are refused elsewhere."""
    mine = [table for table in tables if cause.table in (None, table.name)]
    known = all(isinstance(table, Series) for table in mine)
    if not known or not any(one.each_record for one in cause.parameters):
        return cause
    return replace(cause, parameters=_of_each_record(cause.parameters, mine))


def overflows(problem: Problem) -> list[Note]:
    """A note for each cause whose usual size makes predictions that are none, or overflow."""
    causes = [cause for cause in problem.causes if cause.parameters]
    low, high = problem.limits
    x = np.zeros((len(causes) + 1, problem.size))
    for row, cause in zip(x[1:], causes, strict=True):
        columns = problem.columns([cause])
        row[columns] = np.clip(1.0, low[columns], high[columns])
    with np.errstate(all="ignore"):
        bad = ~(np.abs(problem.model(problem.physical(x))) < HUGE)
    notes = []
    for cause, rows in zip(causes, bad[1:] & ~bad[0], strict=True):
        if rows.any():
            notes.append(Note("predictions-overflow", (
                f"At its usual size, {cause.name} makes {int(rows.sum())} of {len(rows)} "
                "predictions infinite or NaN: it can hardly be judged."
            ), float(rows.sum())))  # fmt: skip
    return notes


def without_effect(problem: Problem) -> list[Note]:
    """A note for each parameter that changes no prediction, and each event outside all records.

    Each is changed while the others are as stated and, as shapes need their amplitudes, while all
    are at their usual sizes.
    """
    low, high = problem.limits
    usual = np.clip(1.0, low, high)
    falls = np.array([parameter.falls for parameter in problem.parameters])
    # What begins to act as it falls is looked at where it acts most.
    strong = np.where(falls, high, usual)
    others = np.tile(usual, (problem.size, 1))
    np.fill_diagonal(others, np.where(falls, strong, 0.0))
    dead = np.ones(problem.size, dtype=bool)
    for each in dict.fromkeys((problem.short, problem)):  # a change of the beginning is one of all
        for base, changed in ((np.zeros_like(usual), np.diag(strong)), (usual, others)):
            if dead.any():
                dead &= _unchanged(each, base[None], changed)
    notes, named = [], set[str]()
    for cause in problem.causes:
        outside = _outside(cause, problem.tables)
        notes += outside
        if outside or cause.curve:
            named |= set(cause.names)
        elif cause.is_instrument:
            # What was before a record is nothing where it begins at zero, or stays at rest.
            named |= {one.name for one in cause.parameters if not (one.is_amplitude or one.cause)}
    for name in itertools.compress(problem.names, dead):
        if name not in named:
            notes.append(Note("without-effect", (
                f"{name} changes no prediction anywhere in its range: the model does not read it, "
                "or these data do not show it."
            )))  # fmt: skip
    return notes


def _outside(cause: Cause, tables: Sequence[Table]) -> list[Note]:
    """A note where an event happens outside every record."""
    records = [(table.t[0], table.t[-1]) for table in tables
               if isinstance(table, Series) and cause.table in (None, table.name)]  # fmt: skip
    begin, end = cause.between or (-math.inf, math.inf)
    if not records or any(begin <= last and end >= first for first, last in records):
        return []
    return [Note("event-outside", (
        f"{cause.name} happens at {begin:.12g} to {end:.12g} s, outside every record: the first "
        f"is of {records[0][0]:.12g} to {records[0][1]:.12g} s."
    ))]  # fmt: skip


def _unchanged(problem: Problem, base: Array, changed: Array) -> Mask:
    """Rows of coordinates with the predictions of `base`, shape (1, size)."""
    with np.errstate(all="ignore"):
        made = problem.model(problem.physical(np.vstack([base, changed])))
    same = (made[1:] == made[0]) | (np.isnan(made[1:]) & np.isnan(made[0]))
    return np.asarray(np.all(same, axis=1))


def _check_predict(predict: object, model: ForwardModel) -> None:
    """Refuse a model that does not take the arguments that it is called with."""
    arguments = ["table", "p", "curves"][: 3 if model.laws else 2]
    wanted = f"allowed is a function of ({', '.join(arguments)})"
    if not callable(predict):
        raise ScenarioError(f"predict = {brief(predict)}: {wanted}")
    if not any(_takes(predict, count) for count in ((3,) if model.laws else (2, 3))):
        raise ScenarioError(f"predict takes {inspect.signature(predict)}: {wanted}")


def _takes(function: Callable[..., Any], count: int) -> bool:
    """Whether a function takes so many arguments; some compiled ones do not say, and may."""
    try:
        taken = inspect.signature(function)
    except (TypeError, ValueError):
        return True
    try:
        taken.bind(*range(count))
    except TypeError:
        return False
    return True


def _check_names(
    tables: Sequence[Table], constants: Sequence[Parameter], causes: Sequence[Cause]
) -> None:
    """Refuse names that come twice."""
    groups: Mapping[str, list[str]] = {
        "tables": [table.title for table in tables] if len(tables) > 1 else [],
        "causes and uncertain": [*(one.name for one in constants), *(c.name for c in causes)],
        "parameters": [p.name for p in (*constants, *(p for c in causes for p in c.parameters))],
    }
    for where, names in groups.items():
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            hint = '; a log gets another one by .named("...")' if where == "tables" else ""
            name = twice[0] or "no name"
            raise ScenarioError(f"{where}: {name} comes twice; allowed is once{hint}")


def _check_copies(tables: Sequence[Table]) -> None:
    """Refuse a table that another one is a copy of, whatever they are called."""
    for one, other in itertools.combinations(tables, 2):
        if len(one.y) == len(other.y) and len(np.unique(one.y)) >= _FEWEST_VALUES:
            rows, copied = (_in_order(table) for table in (one, other))
            if all(map(partial(np.allclose, rtol=_SAME, atol=0.0), rows, copied)):
                text = "allowed is each once, or they would count twice"
                raise ScenarioError(f"data: {other.title} has the readings of {one.title}: {text}")


def _in_order(table: Table) -> list[Array]:
    """Readings and the numbers beside them, in an order that copies share."""
    if isinstance(table, Series):
        return [table.y, table.t - table.t[0], *table.inputs.values()]
    order = np.argsort(table.y, kind="stable")
    settings = table.settings.values() if isinstance(table.settings, dict) else [table.settings]
    return [table.y[order], *(each[order] for each in settings if each.dtype.kind == "f")]


def _check_causes(
    tables: Sequence[Table], constants: Sequence[Parameter], causes: Sequence[Cause]
) -> None:
    """Refuse causes of a table, a constant or an input that is not there, or in another unit."""
    of_tables, known = {table.name for table in tables}, {one.name for one in constants}
    for cause in causes:
        wrong = ""
        if cause.table is not None and cause.table not in of_tables:
            wrong = f"there is no table {cause.table}{meant(cause.table, of_tables)}"
        if cause.frees is not None and cause.frees not in known:
            hint = meant(cause.frees, known)
            wrong = f"frees = {cause.frees}: allowed is an uncertain parameter{hint}"
        for table in tables:
            acts = cause.input is not None and cause.table in (None, table.name)
            if acts and cause.input not in table.inputs:
                at = f" of {table.name}" if table.name else ""
                allowed = ", ".join(table.inputs) or "none"
                wrong = f"input = {cause.input}: allowed is an input{at}: {allowed}"
            reads = cause.read is not None and cause.input is None
            for one in cause.parameters if reads and cause.table in (None, table.name) else ():
                if is_of(one.unit, table.unit) and not same_unit(one.unit, table.unit):
                    wrong = f"unit = {one.unit}: allowed is that of the readings, {table.unit}"
        if wrong:
            raise ScenarioError(f"cause {cause.name}: {wrong}")
