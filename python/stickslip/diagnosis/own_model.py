"""A model of one's own and its data as a problem."""

from __future__ import annotations

import inspect
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.one_line import brief
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.fitting.problem import HUGE, Cached, Problem
from stickslip.diagnosis.measured import freed
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.instruments import read_by
from stickslip.diagnosis.terms.laws import Curves, beside_constants
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import meant
from stickslip.simulation.note import Note

Predict = Callable[..., Array]
"""``predict(table, p)``, or ``predict(table, p, curves)`` where a cause is a free law."""


class Values(dict[str, Array]):
    """Values of the parameters by name, each of shape (vectors, 1)."""

    def __missing__(self, name: str) -> Array:
        raise ScenarioError(f"p: there is no parameter {name}{meant(str(name), self)}")


def pose_own(
    predict: Predict,
    data: Table | Sequence[Table],
    uncertain: Sequence[Parameter],
    causes: Sequence[Cause],
) -> Problem:
    """The problem of data with a model of one's own; see `diagnose_model`.

    Raises
    ------
    ScenarioError
        If something is given that is not allowed.
    """
    tables = [data] if isinstance(data, Table) else list(data)
    if not tables or not all(isinstance(each, Table) for each in tables):
        raise ScenarioError(f"data = {brief(data)}: allowed is a Table, or a list of them")
    _check_list("uncertain", uncertain, Parameter)
    _check_list("causes", causes, Cause)
    constants = tuple(uncertain)
    if any(each.prior is None for each in constants):
        raise ScenarioError("uncertain: allowed are Parameters with a prior")
    named = beside_constants(causes, constants)
    every = (*named, *freed(constants))
    _check_names(tables, constants, named)
    _check_constants(constants, named)
    laws = [each for each in named if each.curve is not None]
    _check_predict(predict, ["table", "p", *(["curves"] if laws else [])])
    names = [*(each.name for each in constants), *(p.name for c in every for p in c.parameters)]

    def physics(table: Table) -> Callable[[Sequence[str], Array], Array]:
        def of(keys: Sequence[str], values: Array) -> Array:
            p = Values({key: values[:, [k]] for k, key in enumerate(keys)})
            made = predict(table, p, Curves(laws, p)) if laws else predict(table, p)
            return _rows(table, made, len(values))

        return of

    def model(values: Array) -> Array:
        return np.hstack([
            read_by(
                [each for each in named if each.table in (None, table.name)],
                names, values, physics(table),
            )[:, table.first]
            for table in tables
        ])  # fmt: skip

    problem = Problem(tuple(tables), Cached(model), constants, every)
    if not np.any(np.isfinite(model(problem.physical(np.zeros((1, problem.size)))))):
        raise ScenarioError("predict: with the stated parameters it computes no reading")
    return problem


def overflows(problem: Problem) -> list[Note]:
    """A note for each cause whose usual size makes predictions that are none, or overflow."""
    causes = [each for each in problem.causes if each.parameters]
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
            text = (
                f"At its usual size, {cause.name} makes predictions that are no numbers below "
                f"{HUGE:g} in {int(rows.sum())} of {len(rows)} rows: it can hardly be judged."
            )
            notes.append(Note("predictions-overflow", text, float(rows.sum())))
    return notes


def _rows(table: Table, made: Any, vectors: int) -> Array:
    """Predictions of a table, shape (vectors, n)."""
    try:
        rows = np.asarray(made, dtype=float)
    except (TypeError, ValueError):
        rows = np.zeros(0)
    if rows.shape != (vectors, len(table)):
        at = f" of table {table.name}" if table.name else ""
        raise ScenarioError(
            f"predict: it returned shape {np.shape(made)} for {vectors} vectors{at}; allowed is "
            f"(vectors, rows), here {(vectors, len(table))}"
        )
    return rows


def _check_list(key: str, given: object, kind: type[Parameter] | type[Cause]) -> None:
    if not isinstance(given, Sequence) or not all(isinstance(each, kind) for each in given):
        raise ScenarioError(f"{key} = {brief(given)}: allowed is a list of {kind.__name__}")


def _check_predict(predict: object, arguments: Sequence[str]) -> None:
    """Refuse a model that does not take the arguments that it is called with."""
    wanted = f"allowed is a function of ({', '.join(arguments)})"
    if not callable(predict):
        raise ScenarioError(f"predict = {brief(predict)}: {wanted}")
    try:
        taken = inspect.signature(predict)
    except (TypeError, ValueError):  # some compiled functions do not say
        return
    try:
        taken.bind(*arguments)
    except TypeError:
        raise ScenarioError(f"predict takes {taken}: {wanted}") from None


def _check_names(
    tables: Sequence[Table], constants: Sequence[Parameter], causes: Sequence[Cause]
) -> None:
    """Refuse names that come twice."""
    groups: Mapping[str, list[str]] = {
        "tables": [each.name for each in tables] if len(tables) > 1 else [],
        "causes and uncertain": [*(one.name for one in constants), *(c.name for c in causes)],
        "parameters": [p.name for p in (*constants, *(p for c in causes for p in c.parameters))],
    }
    for where, names in groups.items():
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise ScenarioError(f"{where}: {twice[0] or 'no name'} comes twice; allowed is once")
    of_tables = {each.name for each in tables}
    for cause in causes:
        if cause.table is not None and cause.table not in of_tables:
            hint = meant(cause.table, of_tables)
            raise ScenarioError(f"cause {cause.name}: there is no table {cause.table}{hint}")


def _check_constants(constants: Sequence[Parameter], causes: Sequence[Cause]) -> None:
    """Refuse causes that free what is no uncertain constant."""
    known = {one.name for one in constants}
    for cause in causes:
        if cause.frees is not None and cause.frees not in known:
            hint = meant(cause.frees, known)
            raise ScenarioError(
                f"cause {cause.name}: frees = {cause.frees}: allowed is an uncertain parameter"
                f"{hint}"
            )
