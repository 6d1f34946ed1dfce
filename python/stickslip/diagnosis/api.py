"""A measurement diagnosed with the simulator and its library of causes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip._util.processor_count import worker_count
from stickslip.diagnosis.data.conditions import (
    Conditions,
    find_singleton_condition,
    named,
    varied,
)
from stickslip.diagnosis.data.noise import fit_noise
from stickslip.diagnosis.data.plausibility import standing_still, wrong_sign, wrong_size
from stickslip.diagnosis.data.pooling import pooled_velocities
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.model_comparison import Progress
from stickslip.diagnosis.inference.smooth_residual import Settings
from stickslip.diagnosis.model.effect_causes import library, parameter_unit
from stickslip.diagnosis.model.problem import Cause, Uncertain
from stickslip.diagnosis.model.simulator import TOLERANCES, Simulator, loosest_tolerances
from stickslip.diagnosis.observables import Combined, ReportSection, find_observables
from stickslip.diagnosis.observables.combined import pooled_observables
from stickslip.diagnosis.pipeline import diagnose_model
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import Value
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.run_notes import peak_voltages

Array = NDArray[np.float64]

_LOW_FIDELITY_PULSES = 5.0
_FEWEST_FOR_SMOOTH = 8


@dataclass(frozen=True)
class Examination:
    """A diagnosis and what it was made with.

    Attributes
    ----------
    found : Findings
    simulator : Simulator, optional
        Of mean velocities; a user's own model has none.
    conditions : list of dict
        Drive settings by dotted key, of the first rows of `Findings.problem.observed`.
    combined : Combined
        The forward model of all rows; its channels' rows follow those of the conditions.
    left_out : tuple of Fact
        Sound rows that could not be used, and why.
    given : ndarray, shape (conditions,)
        Velocities of the scenario as it was given, m/s; NaN where it has none.
    """

    found: Findings
    simulator: Simulator | None
    conditions: list[dict[str, Value]]
    combined: Combined
    left_out: tuple[Fact, ...]
    given: Array

    def parts(self) -> dict[str, NDArray[np.int64]]:
        """Conditions in complementary parts: modes, directions, low and high frequency and peak."""
        result: dict[str, NDArray[np.int64]] = {}
        for key in ("drive.mode", "drive.direction"):
            words = np.array([str(each[key]) for each in self.conditions])
            found = sorted(set(words.tolist()))
            if len(found) == 2:
                result |= {word: np.flatnonzero(words == word) for word in found}
        for key in ("drive.frequency", "drive.peak"):
            values = np.array([float(each[key]) for each in self.conditions])
            middle = float(np.median(values)) if len(values) else 0.0
            below, above = np.flatnonzero(values < middle), np.flatnonzero(values >= middle)
            if len(below) and len(above):
                name = key.split(".")[1]
                result |= {f"low {name}": below, f"high {name}": above}
        return result

    def report_sections(self) -> list[ReportSection]:
        """Parts of the report that the channels draw."""
        problem, fit = self.found.problem, self.found.verdict.fit
        null = problem.physical(self.found.null.x[None, :])[0]
        extended = None if fit is None else problem.physical(fit.x[None, :])[0]
        held_out, end = self.found.held_out, len(self.conditions)
        drawn = []
        for number, observable in enumerate(self.combined.observables):
            start, end = end, end + len(observable.observed)
            names, before = self.combined.report_arguments(number, null)
            after = None
            if extended is not None:
                after = self.combined.report_arguments(number, extended)[1]
            drawn += observable.report_sections(names, before, after, held_out[start:end])
        return drawn


def diagnose(
    measurement: Measurement,
    *,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Examination:
    """Diagnose a measurement with the simulator and its library of causes.

    Parameters
    ----------
    measurement : Measurement
    seed : int
        Of all random draws; the result does not depend on `threads`.
    threads : int, optional
    progress : callable, optional
        ``progress(fraction, stage)`` is told the fraction that is done and what comes next.

    Returns
    -------
    Examination

    Raises
    ------
    ScenarioError
        If nothing was measured that the diagnosis can use.
    """
    threads = worker_count(threads, "threads")
    conditions, velocity, index, block, order = pooled_velocities(measurement)
    observables = find_observables(measurement, threads)
    stated = [each.relative_sd for each in measurement.velocity if math.isfinite(each.relative_sd)]
    # One error for all tables: of those that state one, the largest.
    relative_sd = max(stated, default=math.nan)
    uncertain = [
        Uncertain(name, prior, parameter_unit(name))
        for name, prior in measurement.uncertain.items()
    ]
    nuisance = [each for observable in observables for each in observable.nuisance]
    causes = library(measurement.scenario, dict(measurement.uncertain), _top_voltage(measurement))
    shared = [each.name for each in uncertain]
    amplitudes = [parameter.name for cause in causes for parameter in cause.parameters]
    keys = [*shared, *amplitudes]
    names = [*shared, *(each.name for each in nuisance), *amplitudes]
    simulator = Simulator(measurement.scenario, keys, threads)
    middle = _nominal(simulator, conditions, uncertain, causes)
    lost = np.flatnonzero(~np.isfinite(middle))
    left_out = [each for observable in observables for each in observable.left_out]
    if len(lost) and len(lost) < len(conditions):
        kept = np.isfinite(middle)[index]
        number = np.cumsum(np.isfinite(middle)) - 1
        velocity, block, order = velocity[kept], block[kept], order[kept]
        index = number[index[kept]]
        among = varied(conditions)
        left_out += [
            Fact(Code.CONDITION_NOT_COMPUTED, named(conditions[k], among)) for k in lost.tolist()
        ]
        conditions = [each for k, each in enumerate(conditions) if k not in set(lost.tolist())]
        middle = middle[np.isfinite(middle)]
    computed: list[dict[str, Value]] = []
    if conditions:
        noise = fit_noise(velocity, index, block, relative_sd)
        rtol = loosest_tolerances(simulator, conditions, uncertain, causes, noise, seed)
        finest = {"solver.rtol": float(np.min(rtol))}
        simulator = Simulator(measurement.scenario.replace(finest), keys, threads)
        computed = [
            {**each, "solver.rtol": float(r)} for each, r in zip(conditions, rtol, strict=True)
        ]
    believed = [float(measurement.scenario.get(name)) for name in keys]
    predicted = simulator(computed, np.array([believed]))[0] if computed else np.zeros(0)
    combined = Combined(simulator, names, keys, observables)
    known = pooled_observables(observables)
    options: dict[str, Any] = {"seed": seed, "progress": progress}
    still = None
    if conditions:
        options |= {"condition": index, "block": block, "order": order, "auxiliary": known}
        options |= {
            "relative_sd": relative_sd,
            "singleton_condition": find_singleton_condition(conditions),
        }
        seen = (conditions, middle, noise.mean)
        options["data_problem"] = wrong_size(*seen) or wrong_sign(*seen)
        still = standing_still(*seen)
    elif known is not None:
        velocity = known.observed
        options |= {"sd": known.covariance, "group": known.group}
    else:
        raise ScenarioError(f"{measurement.path}: nothing was measured that can be diagnosed")

    def low_fidelity(conditions: Conditions, parameters: Array) -> Array:
        return combined(
            [_low_fidelity(measurement.scenario, each) for each in conditions], parameters
        )

    source = ["velocity"] * len(computed)
    source += [observable.name for observable in observables for _ in observable.observed]
    options |= {
        "low_fidelity": low_fidelity,
        "settings": smooth_settings(conditions),
        "source": source,
    }
    found = diagnose_model(combined, computed, velocity, [*uncertain, *nuisance], causes, **options)
    notes = [*found.notes, *(each for observable in observables for each in observable.notes)]
    if still is not None:
        notes.insert(0, still)
    return Examination(
        replace(found, notes=tuple(notes)),
        simulator,
        conditions,
        combined,
        tuple(left_out),
        predicted,
    )


def _nominal(
    simulator: Simulator,
    conditions: Conditions,
    uncertain: Sequence[Uncertain],
    causes: Sequence[Cause],
) -> Array:
    """Velocities at the middle of all priors, without any cause; NaN where there is none."""
    if not conditions:
        return np.zeros(0)
    absent = [each.value(np.zeros(1))[0] for cause in causes for each in cause.parameters]
    middle = [float(each.prior.value(0.0)) for each in uncertain]
    return np.asarray(simulator(conditions, np.array([[*middle, *absent]]))[0], dtype=float)


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
