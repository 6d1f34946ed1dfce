"""A measurement as a problem: its conditions, constants and causes, and the simulator as model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.data.conditions import Conditions, find_singleton_condition, named, varied
from stickslip.diagnosis.data.plausibility import (
    standing_still,
    start_up_included,
    wrong_sign,
    wrong_size,
)
from stickslip.diagnosis.data.pooling import pooled_velocities
from stickslip.diagnosis.data.trial_noise import fit_noise
from stickslip.diagnosis.fit.multistart import SMALLER_INFLATION
from stickslip.diagnosis.inference.smooth_residual import Settings
from stickslip.diagnosis.model.effect_causes import library
from stickslip.diagnosis.model.problem import Array, Cause, Indices, Uncertain
from stickslip.diagnosis.model.simulator import (
    TOLERANCES,
    Simulator,
    loosest_tolerances,
    with_extrapolation,
)
from stickslip.diagnosis.observables import Combined, find_observables
from stickslip.diagnosis.observables.combined import pooled_observables
from stickslip.diagnosis.observables.observable import Observable
from stickslip.diagnosis.options import Options
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import Value, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.run_notes import peak_voltages

# Most pulses of a low-fidelity simulation. Chosen: enough for the first stages of a search.
_LOW_FIDELITY_PULSES = 5.0
# Fewest conditions of which a smooth function is asked for. Chosen: as for holding some out.
_FEWEST_FOR_SMOOTH = 8


@dataclass(frozen=True, repr=False, eq=False)
class MeasurementProblem(OneLine):
    """What `diagnose_model` takes, made of a measurement, in SI units.

    The conditions are drive settings by dotted key, each with the tolerance of its simulation. Of a
    measurement without velocities, the observables of all channels are what was observed. The first
    notes are on the conditions, the last ones on the channels.
    """

    posed: PosedProblem
    conditions: list[dict[str, Value]]
    observed: Array
    uncertain: list[Uncertain]
    causes: tuple[Cause, ...]
    options: Options
    first_notes: tuple[Fact, ...]
    last_notes: tuple[Fact, ...]


@dataclass(frozen=True, repr=False, eq=False)
class _Velocities(OneLine):
    """Trials of all tables, and the stated model's velocities at the m conditions, `nominal`."""

    conditions: list[dict[str, Value]]
    value: Array
    condition: Indices
    block: Indices
    order: Array
    nominal: Array

    @property
    def mean(self) -> Array:
        return np.bincount(self.condition, self.value) / np.bincount(self.condition)


def pose_measurement(measurement: Measurement, seed: int, threads: int) -> MeasurementProblem:
    """The problem that a measurement poses.

    Raises
    ------
    ScenarioError
        If nothing was measured that the diagnosis can use.
    """
    scenario = measurement.scenario
    observables = find_observables(measurement, threads)
    keys = known_keys()
    shared = [Uncertain(key, prior, keys[key].unit) for key, prior in measurement.uncertain.items()]
    nuisance = [each for observable in observables for each in observable.nuisance]
    causes = library(scenario, dict(measurement.uncertain), _top_voltage(measurement))
    amplitudes = [parameter.name for cause in causes for parameter in cause.parameters]
    # Columns that are scenario keys, and all columns.
    columns = [*(each.name for each in shared), *amplitudes]
    names = [*(each.name for each in (*shared, *nuisance)), *amplitudes]
    simulator = Simulator(scenario, columns, threads)
    velocities, lost = _computable(_velocities(measurement, simulator, shared, causes))
    # One error for all tables: of those that state one, the largest.
    stated = [each.relative_sd for each in measurement.velocity if math.isfinite(each.relative_sd)]
    relative_sd = max(stated, default=math.nan)
    conditions: list[dict[str, Value]] = []
    given = np.zeros(0)
    if velocities.conditions:
        noise = fit_noise(velocities.value, velocities.condition, velocities.block, relative_sd)
        cheaper = with_extrapolation(velocities.conditions, noise)
        rtol = loosest_tolerances(simulator, cheaper, shared, causes, noise, seed)
        finest = {"solver.rtol": float(np.min(rtol))}
        simulator = Simulator(scenario.replace(finest), columns, threads)
        conditions = [
            {**each, "solver.rtol": float(r)} for each, r in zip(cheaper, rtol, strict=True)
        ]
        believed = [float(scenario.get(name)) for name in columns]
        given = simulator(conditions, np.array([believed]))[0]
    model = Combined(simulator, names, columns, observables)
    observed, options = _data(measurement, velocities, observables, relative_sd)
    first_notes = [start_up_included(velocities.conditions)]
    if conditions:
        seen = (velocities.conditions, velocities.nominal, velocities.mean)
        first_notes.append(standing_still(*seen))
    left_out = [*(fact for each in observables for fact in each.left_out), *lost]
    source = ["velocity"] * len(conditions)
    source += [each.name for each in observables for _ in each.observed]

    def low_fidelity(conditions: Conditions, values: Array) -> Array:
        return model([_low_fidelity(scenario, each) for each in conditions], values)

    return MeasurementProblem(
        PosedProblem(model, velocities.conditions, simulator, given, tuple(left_out)),
        conditions,
        observed,
        [*shared, *nuisance],
        causes,
        replace(options, seed=seed, source=source, low_fidelity=low_fidelity),
        tuple(each for each in first_notes if each is not None),
        tuple(fact for each in observables for fact in each.notes),
    )


def _velocities(
    measurement: Measurement,
    simulator: Simulator,
    constants: Sequence[Uncertain],
    causes: Sequence[Cause],
) -> _Velocities:
    """All tables, and the velocities at the middle of all priors without any cause, NaN if none."""
    conditions, value, condition, block, order = pooled_velocities(measurement)
    nominal = np.zeros(0)
    if conditions:
        absent = [each.value(np.zeros(1))[0] for cause in causes for each in cause.parameters]
        middle = [float(each.prior.value(0.0)) for each in constants]
        nominal = np.asarray(simulator(conditions, np.array([[*middle, *absent]]))[0], dtype=float)
    return _Velocities(conditions, value, condition, block, order, nominal)


def _computable(given: _Velocities) -> tuple[_Velocities, list[Fact]]:
    """Without the conditions that the stated model cannot compute, and a fact for each of those.

    If it computes none, all stay: then something is wrong with the data, and that is said.
    """
    sound = np.isfinite(given.nominal)
    if sound.all() or not sound.any():
        return given, []
    among = varied(given.conditions)
    said = [
        Fact(Code.CONDITION_NOT_COMPUTED, named(given.conditions[k], among))
        for k in np.flatnonzero(~sound).tolist()
    ]
    kept = sound[given.condition]
    number = np.cumsum(sound) - 1
    found = _Velocities(
        [given.conditions[k] for k in np.flatnonzero(sound).tolist()],
        given.value[kept],
        number[given.condition[kept]],
        given.block[kept],
        given.order[kept],
        given.nominal[sound],
    )
    return found, said


def _data(
    measurement: Measurement,
    given: _Velocities,
    observables: Sequence[Observable],
    relative_sd: float,
) -> tuple[Array, Options]:
    """What was observed, and what is known of it; the channels stand alone without velocities."""
    known = pooled_observables(observables)
    if given.conditions:
        seen = (given.conditions, given.nominal, given.mean)
        return given.value, Options(
            condition=given.condition,
            block=given.block,
            order=given.order,
            auxiliary=known,
            relative_sd=relative_sd,
            singleton_condition=find_singleton_condition(given.conditions),
            settings=_smooth_settings(given.conditions),
            data_problem=wrong_size(*seen) or wrong_sign(*seen),
        )
    if known is None:
        raise ScenarioError(f"{measurement.path}: nothing was measured that can be diagnosed")
    return known.observed, Options(sd=known.covariance, group=known.group)


def _low_fidelity(scenario: Scenario, condition: Mapping[str, Value]) -> dict[str, Value]:
    """A condition that is computed sooner and less exactly."""
    pulses = float(condition.get("drive.pulses", scenario.get("drive.pulses")))
    fewer = min(pulses, _LOW_FIDELITY_PULSES)
    looser = SMALLER_INFLATION * float(condition["solver.velocity_error"])
    return {
        **condition,
        "solver.rtol": TOLERANCES[0],
        "solver.velocity_error": looser,
        "drive.pulses": fewer,
    }


def _top_voltage(measurement: Measurement) -> float:
    """Largest voltage that any drive asks for, V; that of the scenario if there is no drive."""
    stated = measurement.scenario
    drives = [
        stated.replace({"drive.program": None, **each})
        for data in measurement.velocity
        for each in data.conditions
    ]
    drives += [run.scenario for run in measurement.tracking]
    return max(volts for each in drives or [stated] for volts in peak_voltages(each).values())


def _smooth_settings(conditions: Conditions) -> Settings | None:
    """Where the conditions lie, if they are enough for a smooth function."""
    if len(conditions) < _FEWEST_FOR_SMOOTH:
        return None
    keys = ("drive.frequency", "drive.peak", "drive.hold", "drive.base")
    numbers = np.array([[float(each[key]) for key in keys] for each in conditions])
    numbers[:, 0] = np.log(numbers[:, 0])
    words = [(each["drive.mode"], each["drive.direction"]) for each in conditions]
    number = {word: k for k, word in enumerate(dict.fromkeys(words))}
    return Settings(numbers, np.array([number[word] for word in words]))
