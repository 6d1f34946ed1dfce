"""A measurement as a problem: its tables, its uncertain constants, and what may be wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import cast

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.data.angle import AngleTable
from stickslip.diagnosis.data.field import FieldTable
from stickslip.diagnosis.data.film import FilmTable
from stickslip.diagnosis.data.simulated import SimulatedTable
from stickslip.diagnosis.data.velocity import VelocityTable
from stickslip.diagnosis.fitting.problem import Cached, Model, Problem
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.laws import find_spans, fixed_numbers, laws
from stickslip.diagnosis.terms.library import library
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.errors import ScenarioError
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.uncertain import refuse_geometry_beside_a_map
from stickslip.simulation.scenario_notes import peak_voltages


def tables_of(measurement: Measurement, threads: int, seed: int) -> list[SimulatedTable]:
    """All tables of a measurement: velocities, films, angles, fields.

    A ScenarioError is raised if nothing was measured that the diagnosis can use.
    """
    tables: list[SimulatedTable] = []
    if any(len(data.velocity) for data in measurement.velocity):
        tables.append(VelocityTable(measurement, threads=threads, seed=seed))
    tables += [
        FilmTable(run, number, threads) for number, run in enumerate(measurement.tracking, start=1)
    ]
    scenario = measurement.scenario
    try:
        for kind, several in ((AngleTable, measurement.angle), (FieldTable, measurement.field)):
            first = 0 if len(several) == 1 else 1  # a single one needs no number
            tables += [kind(table, scenario, k) for k, table in enumerate(several, start=first)]
    except ScenarioError as error:
        raise ScenarioError(f"{measurement.path}: {error}") from None
    if not tables:
        raise ScenarioError(f"{measurement.path}: nothing was measured that can be diagnosed")
    return tables


def problem_of(measurement: Measurement, threads: int = 1, seed: int = 0) -> Problem:
    """The problem that a measurement poses, in SI units.

    A ScenarioError is raised if nothing was measured that the diagnosis can use.
    """
    scenario, keys = measurement.scenario, known_keys()
    if scenario.coil.map is not None:
        refuse_geometry_beside_a_map(measurement.uncertain)
    _refuse_turns(measurement)
    tables = tables_of(measurement, threads, seed)
    constants = [
        Parameter(key, prior, keys[key].unit) for key, prior in measurement.uncertain.items()
    ]
    constants += [parameter for table in tables for parameter in table.nuisance]
    driven = _driven(measurement)
    volts = max(max(peak_voltages(one).values()) for one in driven)
    settled = {*measurement.uncertain}
    if any(one.drive.edge_time != scenario.drive.edge_time for one in driven):
        settled.add("drive.edge_time")
    effects = library(scenario, settled, volts)
    # Tables of one kind share instruments: that of the widest readings stands for all, as a limit
    # may lie anywhere below them.
    every = [instrument for table in tables for instrument in table.instruments]
    every.sort(key=lambda instrument: instrument.parameters[0].high)
    instruments = {instrument.name: instrument for instrument in every}
    causes = (*effects, *instruments.values(), *freed(constants))
    model, draft = model_of(tables, constants, causes)
    laws = partial(_with_laws, measurement)
    return Problem(tuple(tables), model, tuple(constants), causes, draft, laws)


def _with_laws(measurement: Measurement, problem: Problem, x: Array) -> Problem:
    return _beside(problem, _laws(measurement, problem, x))


def _beside(problem: Problem, more: Sequence[Cause]) -> Problem:
    """The problem with further laws, or further forms of them, beside those that it has."""
    causes = (*problem.causes, *more)
    tables = cast(Sequence[SimulatedTable], problem.tables)
    model, draft = model_of(tables, problem.constants, causes)
    return replace(problem, model=model, draft=draft, causes=causes, forms=_beside)


def _laws(measurement: Measurement, problem: Problem, x: Array) -> tuple[Cause, ...]:
    """The simulator's laws of a free shape at recalibrated constants; none without velocities."""
    table = problem.tables[0]
    if not isinstance(table, VelocityTable):
        return ()
    values = problem.physical(x[None, :])[0].tolist()
    constants = {
        constant.name: value
        for constant, value in zip(problem.constants, values, strict=False)
        if constant.name in known_keys()
    }
    scenario = measurement.scenario.replace(constants)
    spans = find_spans([scenario.replace(drive) for drive in table.conditions], table.threads)
    stated = {key.split(".")[1] for key in constants if key.startswith("effects.")}
    # What a diagnosis has found before may be stated, in whichever form.
    stated |= {f"free_{name.rpartition('_')[0]}" for name in scenario.laws}
    spans = {name: span for name, span in spans.items()
             if name not in {*scenario.effects, *scenario.laws, *stated}}  # fmt: skip
    return laws(scenario, measurement.uncertain, spans)


def freed(constants: Sequence[Parameter]) -> list[Cause]:
    """A cause for each constant that is stated with a middle: it is other than stated."""
    return [
        Cause(constant.name, (), f"{constant.name} is other than stated", frees=constant.name)
        for constant in constants
        if constant.cause and constant.prior is not None and constant.prior.has_middle
    ]


def model_of(
    tables: Sequence[SimulatedTable], constants: Sequence[Parameter], causes: Sequence[Cause]
) -> tuple[Model, Model]:
    """The model of all rows and its draft, in which velocities have fewer pulses.

    Their columns are the constants and the parameters of the causes.
    """
    names = [constant.name for constant in constants]
    names += [parameter.name for cause in causes for parameter in cause.parameters]
    reach = fixed_numbers(causes)
    names += reach
    columns = [table.own_columns(names) for table in tables]
    full, cheap = list[Model](), list[Model]()
    for table, places in zip(tables, columns, strict=True):
        mine = [names[k] for k in places]
        full.append(Cached(partial(table.predict, mine)))
        # What has no cheaper model is predicted once for both.
        same = type(table).low_fidelity is SimulatedTable.low_fidelity
        cheap.append(full[-1] if same else Cached(partial(table.low_fidelity, mine)))
    fixed = np.array(list(reach.values()), dtype=float)
    return partial(_rows, columns, fixed, full), partial(_rows, columns, fixed, cheap)


def _rows(
    columns: Sequence[Sequence[int]], fixed: Array, predict: Sequence[Model], values: Array
) -> Array:
    values = np.hstack([values, np.broadcast_to(fixed, (len(values), len(fixed)))])
    return np.hstack([model(values[:, at]) for model, at in zip(predict, columns, strict=True)])


def _driven(measurement: Measurement) -> list[Scenario]:
    """The scenario of each drive that was measured; the stated one if there is none."""
    stated = measurement.scenario
    drives = [
        stated.replace({"drive.program": None, **drive})
        for data in measurement.velocity
        for drive in data.conditions
    ]
    return [*drives, *(run.scenario for run in measurement.tracking)] or [stated]


def _refuse_turns(measurement: Measurement) -> None:
    """Refuse drives that turn the robot: velocities and films are compared along x."""
    for driven in _driven(measurement):
        if driven.whole_plane and driven.coil.map is None:
            raise ScenarioError(
                f"{measurement.path}: with drive.heading = {driven.drive.heading:g} or what else "
                "pushes it across the robot leaves its plane; allowed in a diagnosis are robots "
                "that walk along x"
            )
