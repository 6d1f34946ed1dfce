"""A measurement as a problem: its conditions, constants and causes, and the simulator as model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.data.conditions import (
    Conditions,
    find_singleton_condition,
    named,
    varied,
)
from stickslip.diagnosis.data.noise import fit_noise
from stickslip.diagnosis.data.plausibility import standing_still, wrong_sign, wrong_size
from stickslip.diagnosis.data.pooling import pooled_velocities
from stickslip.diagnosis.inference.smooth_residual import Settings
from stickslip.diagnosis.model.effect_causes import library, parameter_unit
from stickslip.diagnosis.model.problem import Cause, Uncertain
from stickslip.diagnosis.model.simulator import TOLERANCES, Simulator, loosest_tolerances
from stickslip.diagnosis.observables import Combined, find_observables
from stickslip.diagnosis.observables.combined import pooled_observables
from stickslip.diagnosis.observables.observable import Observable
from stickslip.diagnosis.options import Options
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import Value
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.run_notes import peak_voltages

Array = NDArray[np.float64]

_LOW_FIDELITY_PULSES = 5.0
_FEWEST_FOR_SMOOTH = 8


@dataclass(frozen=True, repr=False, eq=False)
class MeasurementProblem(OneLine):
    """What `diagnose_model` takes, made of a measurement.

    Attributes
    ----------
    posed : PosedProblem
    conditions : list of dict
        Drive settings by dotted key and the tolerance of their simulation.
    observed : ndarray, shape (n,)
        Trials; of a measurement without velocities, the observables of all channels. SI units.
    uncertain : list of Uncertain
    causes : tuple of Cause
    options : Options
    first_notes, last_notes : tuple of Fact
        What a reader has to know of the conditions, and of the channels.
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
    condition: NDArray[np.int64]
    block: NDArray[np.int64]
    order: Array
    nominal: Array
    relative_sd: float


@dataclass(frozen=True)
class _Parameters:
    """What is uncertain, by the scenario and by the channels alone, and the causes."""

    shared: list[Uncertain]
    nuisance: list[Uncertain]
    causes: tuple[Cause, ...]

    @property
    def amplitudes(self) -> list[str]:
        return [parameter.name for cause in self.causes for parameter in cause.parameters]

    @property
    def keys(self) -> list[str]:
        """Columns that are scenario keys."""
        return [*(each.name for each in self.shared), *self.amplitudes]

    @property
    def names(self) -> list[str]:
        """All columns."""
        return [*(each.name for each in (*self.shared, *self.nuisance)), *self.amplitudes]


def pose_measurement(measurement: Measurement, seed: int, threads: int) -> MeasurementProblem:
    """The problem that a measurement poses.

    Raises
    ------
    ScenarioError
        If nothing was measured that the diagnosis can use.
    """
    scenario = measurement.scenario
    observables = find_observables(measurement, threads)
    parameters = _parameters(measurement, observables)
    simulator = Simulator(scenario, parameters.keys, threads)
    velocities, lost = _computable(_velocities(measurement, simulator, parameters))
    left_out = [*(fact for each in observables for fact in each.left_out), *lost]
    conditions: list[dict[str, Value]] = []
    given = np.zeros(0)
    if velocities.conditions:
        rtol = _tolerances(velocities, simulator, parameters, seed)
        finest = {"solver.rtol": float(np.min(rtol))}
        simulator = Simulator(scenario.replace(finest), parameters.keys, threads)
        conditions = [
            {**each, "solver.rtol": float(r)}
            for each, r in zip(velocities.conditions, rtol, strict=True)
        ]
        believed = [float(scenario.get(name)) for name in parameters.keys]
        given = simulator(conditions, np.array([believed]))[0]
    model = Combined(simulator, parameters.names, parameters.keys, observables)
    observed, options = _data(measurement, velocities, observables)
    source = ["velocity"] * len(conditions)
    source += [each.name for each in observables for _ in each.observed]

    def low_fidelity(conditions: Conditions, values: Array) -> Array:
        return model([_low_fidelity(scenario, each) for each in conditions], values)

    return MeasurementProblem(
        PosedProblem(model, velocities.conditions, simulator, given, tuple(left_out)),
        conditions,
        observed,
        [*parameters.shared, *parameters.nuisance],
        parameters.causes,
        replace(options, seed=seed, source=source, low_fidelity=low_fidelity),
        tuple(_still(velocities)),
        tuple(fact for each in observables for fact in each.notes),
    )


def _parameters(measurement: Measurement, observables: Sequence[Observable]) -> _Parameters:
    uncertain = dict(measurement.uncertain)
    return _Parameters(
        [Uncertain(name, prior, parameter_unit(name)) for name, prior in uncertain.items()],
        [each for observable in observables for each in observable.nuisance],
        library(measurement.scenario, uncertain, _top_voltage(measurement)),
    )


def _velocities(
    measurement: Measurement, simulator: Simulator, parameters: _Parameters
) -> _Velocities:
    conditions, value, condition, block, order = pooled_velocities(measurement)
    stated = [each.relative_sd for each in measurement.velocity if math.isfinite(each.relative_sd)]
    # One error for all tables: of those that state one, the largest.
    relative_sd = max(stated, default=math.nan)
    nominal = _nominal(simulator, conditions, parameters)
    return _Velocities(conditions, value, condition, block, order, nominal, relative_sd)


def _nominal(simulator: Simulator, conditions: Conditions, parameters: _Parameters) -> Array:
    """Velocities at the middle of all priors, without any cause; NaN where there is none."""
    if not conditions:
        return np.zeros(0)
    absent = [
        each.value(np.zeros(1))[0] for cause in parameters.causes for each in cause.parameters
    ]
    middle = [float(each.prior.value(0.0)) for each in parameters.shared]
    return np.asarray(simulator(conditions, np.array([[*middle, *absent]]))[0], dtype=float)


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
        [each for each, good in zip(given.conditions, sound.tolist(), strict=True) if good],
        given.value[kept],
        number[given.condition[kept]],
        given.block[kept],
        given.order[kept],
        given.nominal[sound],
        given.relative_sd,
    )
    return found, said


def _tolerances(
    given: _Velocities, simulator: Simulator, parameters: _Parameters, seed: int
) -> Array:
    """Of the simulator, for each condition."""
    noise = fit_noise(given.value, given.condition, given.block, given.relative_sd)
    return loosest_tolerances(
        simulator, given.conditions, parameters.shared, parameters.causes, noise, seed
    )


def _data(
    measurement: Measurement, given: _Velocities, observables: Sequence[Observable]
) -> tuple[Array, Options]:
    """What was observed, and what is known of it; the channels stand alone without velocities."""
    known = pooled_observables(observables)
    if given.conditions:
        seen = (given.conditions, given.nominal, _means(given))
        return given.value, Options(
            condition=given.condition,
            block=given.block,
            order=given.order,
            auxiliary=known,
            relative_sd=given.relative_sd,
            singleton_condition=find_singleton_condition(given.conditions),
            settings=smooth_settings(given.conditions),
            data_problem=wrong_size(*seen) or wrong_sign(*seen),
        )
    if known is None:
        raise ScenarioError(f"{measurement.path}: nothing was measured that can be diagnosed")
    return known.observed, Options(sd=known.covariance, group=known.group)


def _means(given: _Velocities) -> Array:
    return np.bincount(given.condition, given.value) / np.bincount(given.condition)


def _still(given: _Velocities) -> list[Fact]:
    """A note on conditions that read zero where the model walks."""
    if not given.conditions:
        return []
    said = standing_still(given.conditions, given.nominal, _means(given))
    return [] if said is None else [said]


def _low_fidelity(scenario: Scenario, condition: Mapping[str, Value]) -> dict[str, Value]:
    """A condition that is computed sooner and less exactly."""
    pulses = float(condition.get("drive.pulses", scenario.get("drive.pulses")))
    return {
        **condition, "solver.rtol": TOLERANCES[0], "drive.pulses": min(pulses, _LOW_FIDELITY_PULSES)
    }  # fmt: skip


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


def smooth_settings(conditions: Conditions) -> Settings | None:
    """Where the conditions lie, if they are enough for a smooth function."""
    if len(conditions) < _FEWEST_FOR_SMOOTH:
        return None
    keys = ("drive.frequency", "drive.peak", "drive.hold", "drive.base")
    numbers = np.array([[float(each[key]) for key in keys] for each in conditions])
    numbers[:, 0] = np.log(numbers[:, 0])
    words = [(each["drive.mode"], each["drive.direction"]) for each in conditions]
    number = {word: k for k, word in enumerate(dict.fromkeys(words))}
    return Settings(numbers, np.array([number[word] for word in words]))
