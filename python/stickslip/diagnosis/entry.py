"""A diagnosis of data with a forward model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from stickslip._util.arrays import Array
from stickslip._util.messages import check_whole
from stickslip._util.note import Note
from stickslip.diagnosis.data.readings import CLIPPED
from stickslip.diagnosis.data.series import LOST_SENSOR, Series
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.diagnosis.fitting.scatter import with_scatter
from stickslip.diagnosis.fitting.search import Progress
from stickslip.diagnosis.model import (
    Predict,
    computed_tables,
    overflows,
    posed,
    tables_in,
    without_effect,
)
from stickslip.diagnosis.pipeline import first_look, moved_constants, run
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.diagnosis.terms.unlisted import unlisted
from stickslip.errors import ScenarioError

Terms = tuple[Sequence[Parameter], Sequence[Cause]]


def diagnose_model(
    predict: Predict, data: Table | Sequence[Table], uncertain: Sequence[Parameter] | None = None,
    causes: Sequence[Cause] = (), *, seed: int = 0, progress: Progress | None = None,
) -> Diagnosis:  # fmt: skip
    """Diagnose measured data with a forward model of one's own, or with one of `models`.

    Parameters
    ----------
    predict : callable
        ``predict(table, p)`` returns readings of one table or series of `data`, shape (vectors,
        rows). ``p["name"]`` are the values of a parameter in its unit, shape (vectors, 1); those
        of absent causes are at their `absent` value. What it cannot compute is NaN. With free laws
        among the causes it is called as ``predict(table, p, curves)``, see `free_law`. A model of
        `stickslip.models` brings its uncertain parameters and usual causes.
    data : Table, Series, or sequence of them
    uncertain : sequence of Parameter
        Constants that are known by their priors; not given with a model of
        `stickslip.models`. For each whose prior has a middle, unless `cause` is False,
        "other than stated" is a cause, too.
    causes : sequence of Cause
        Effects, instruments (see `instruments`) and free laws, beside those of the model.
    seed : int
        From 0, of the random draws.
    progress : callable, optional
        ``progress(fraction, stage)`` is told the fraction that is done and what comes next.

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
    >>> from stickslip import Cause, Parameter, Prior, Table, diagnose_model
    >>> x = np.linspace(1.0, 3.0, 12)
    >>> def line(table, p):
    ...     return p["slope"] * table["x"] + p["height"] * np.sin(5 * table["x"])
    >>> slope = Parameter("slope", Prior("normal", 1.0, 0.1))
    >>> wave = Cause("wave", Parameter("height", size=0.5, low=-5, high=5))
    >>> table = Table({"x": x}, x + np.sin(5 * x), sd=0.1)
    >>> result = diagnose_model(line, table, [slope], [wave])
    >>> result.verdict.kind, result.verdict.causes
    ('named', ('wave',))
    """
    check_whole("seed", seed)
    with one_blas_thread():
        data = in_pieces(predict, "data", data, causes)
        terms = stated_terms(predict, uncertain, causes, data)
        problem, fault = prepared(predict, data, terms, int(seed))
        problem = problem if fault else with_scatter(problem, int(seed))
        problem = replace(problem, unlisted=partial(_unlisted, predict))
        notes = [*overflows(problem), *without_effect(problem)]
        return diagnosed(problem, int(seed), progress, notes, fault=fault)


def _unlisted(predict: Any, problem: Problem, x: Array) -> list[Cause]:
    """Effects that nobody listed; a ready-made model has states, at coordinates `x`."""
    tables = [getattr(table, "whole", None) or table for table in problem.tables]
    if not hasattr(predict, "kind"):
        return unlisted(tables, problem.causes)
    names = [one.name.partition("[") for one in problem.constants]
    values, states = problem.physical(x[None])[0, : len(names)].tolist(), list[Any]()
    for table in tables:
        p = {name: np.array([[value]]) for (name, _, of), value in zip(names, values, strict=True)
             if of in ("", f"{table.name}]")}  # fmt: skip
        bare, mine = table.having(unit="-"), dict[str, Array]()
        for reads, (state, _) in predict.kind.reads.items():
            if state < min(len(predict.kind.states), 2):
                mine["xv"[state]] = np.asarray(replace(predict, reads=reads)(bare, p)[0])
        if "v" not in mine:  # of a heater
            ambient = table.inputs.get("ambient", predict.middles.get("ambient", table.y[0]))
            mine = {"v": mine["x"] - ambient}
        states.append(mine)
    return unlisted(tables, problem.causes, states, predict.kind.inputs)


def in_pieces(
    predict: Any, key: str, data: Table | Sequence[Table], causes: Sequence[Cause]
) -> list[Table]:
    """Tables as a list; where states at the first reading are free, records in their pieces."""
    tables = tables_in(key, data)
    of_a_table = any(getattr(cause, "table", None) for cause in causes)
    states = [name for name, _ in predict.kind.states] if hasattr(predict, "kind") else []
    if of_a_table or not states or not predict.known.keys().isdisjoint(states):
        return [*tables]
    return [piece for table in tables
            for piece in (table.pieces() if isinstance(table, Series) else [table])]  # fmt: skip


def stated_terms(
    predict: Predict, uncertain: Sequence[Parameter] | None, causes: Sequence[Cause], data: Any
) -> Terms:
    """The stated terms, or those of a model, and the other causes."""
    if uncertain is not None:
        return uncertain, causes
    if not hasattr(predict, "terms"):
        raise ScenarioError("uncertain: allowed is a list of Parameter, or a model of `models`")
    constants, usual = predict.terms(data)
    return constants, [*usual, *causes] if isinstance(causes, Sequence) else causes


def prepared(
    predict: Predict, data: Table | Sequence[Table], terms: Terms, seed: int
) -> tuple[Problem, Note | None]:
    """The problem of what can be computed of data, and what is wrong with them, if anything is."""
    problem = posed(data, predict, *terms)
    tables = computed_tables(problem, seed)
    if tables != problem.tables:
        problem = posed(tables, predict, *terms)
    for k, table in enumerate(problem.tables):
        windows = table.windows() if isinstance(table, Series) else []
        if len(windows) > 1:  # a mean that a logger wrote: of the rows that fit the model best
            each = [(*problem.tables[:k], one, *problem.tables[k + 1 :]) for one in windows]
            tried = [posed(tables, predict, *terms) for tables in each]
            problem = max(tried, key=partial(first_look, seed=seed))
    lost = (note for table in problem.tables for note in table.own_notes)
    fault = next((note for note in lost if note.code in (LOST_SENSOR, CLIPPED)), None)
    return problem, fault


def diagnosed(
    problem: Problem, seed: int, progress: Progress | None, notes: Sequence[Note],
    source: Any = None, fault: Note | None = None,
) -> Diagnosis:  # fmt: skip
    """The diagnosis of a problem; `source` is what poses it, a `fault` what is wrong with data."""
    say = progress or (lambda fraction, stage: None)
    findings = run(problem, seed, say, fault or fault_of(problem))
    return Diagnosis(findings, source, (*notes, *moved_constants(findings)))


# Matrices are small: further threads of their products wait for each other longer than they work.
one_blas_thread = partial(threadpool_limits, limits=1, user_api="blas")


def fault_of(problem: Problem, beside: bool = False) -> Note | None:
    """A fault of the data of a problem, if there is one; each table is asked.

    Tables `beside` others need not tell their errors.
    """
    alone = len(problem.tables) == 1 and not beside
    stated = problem.model(problem.physical(np.zeros((1, problem.size))))[0]
    known = beside or any(errors.known for errors in problem.errors)
    for table, part in zip(problem.tables, problem.rows, strict=True):
        fault = table.data_fault(stated[part], alone or not known)
        if fault is not None:
            return fault if alone else replace(fault, text=f"{table.at}{fault.text}")
    count, free = len(problem.y), len(problem.constants)
    if count <= free:
        text = f"{count} conditions cannot tell {free} uncertain constants, let alone causes."
        return Note("too-many-constants", text, free)
    return None
