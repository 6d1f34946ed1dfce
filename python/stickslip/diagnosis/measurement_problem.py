"""A measurement as a problem: its conditions, constants and causes, and the simulator as model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import compress

import numpy as np

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.data.conditions import Conditions, find_singleton_condition, named, varied
from stickslip.diagnosis.data.plausibility import (
    standing_still,
    start_up_included,
    wrong_sign,
    wrong_size,
)
from stickslip.diagnosis.data.trial_noise import fit_noise
from stickslip.diagnosis.data.trials import Trials, pooled_velocities
from stickslip.diagnosis.inference.cause_or_law import judged_beside_laws, looks_for_laws
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.free_term_search import search_terms
from stickslip.diagnosis.inference.model_comparison import Progress
from stickslip.diagnosis.inference.open_set import OpenSet
from stickslip.diagnosis.inference.smooth_residual import Settings
from stickslip.diagnosis.model.effect_causes import library
from stickslip.diagnosis.model.free_shapes import HOOKS, find_spans
from stickslip.diagnosis.model.problem import Array, Cause, Uncertain
from stickslip.diagnosis.model.simulator import TOLERANCES, Simulator, loosest_tolerances
from stickslip.diagnosis.observables import Combined, find_observables
from stickslip.diagnosis.observables.combined import pooled_observables
from stickslip.diagnosis.observables.observable import Observable
from stickslip.diagnosis.observables.reading_errors import of_velocities
from stickslip.diagnosis.options import Options
from stickslip.diagnosis.pipeline import run_steps
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import Value, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import refuse_uncertain_geometry
from stickslip.simulation.scenario_notes import peak_voltages
from stickslip.sweeping.notes import notes_of_points
from stickslip.sweeping.points import from_changes
from stickslip.sweeping.run_sweep import simulated

# Most pulses of a low-fidelity simulation. Chosen: the first that is measured differs from the mean
# of 8 by 0.05 standard errors, and from that of 30 by 0.25; the first stages inflate these errors.
_LOW_FIDELITY_PULSES = 4.0
# Fewest conditions of which a smooth function is asked for. Chosen: as for holding some out.
_FEWEST_FOR_SMOOTH = 8


@dataclass(frozen=True, repr=False, eq=False)
class _Walks(OneLine):
    """Trials of all tables, and the stated model's velocities at the m conditions, `nominal`."""

    conditions: list[dict[str, Value]]
    trials: Trials
    nominal: Array

    @property
    def seen(self) -> tuple[Conditions, Array, Array]:
        """The conditions with their velocities: those of the stated model, and those measured."""
        return self.conditions, self.nominal, self.trials.mean


def diagnose_measurement(
    measurement: Measurement,
    seed: int,
    threads: int,
    progress: Progress | None,
    free_shapes: bool = False,
) -> tuple[Findings, PosedProblem]:
    """Run the steps of a diagnosis on the problem that a measurement poses, in SI units.

    Its conditions are drive settings by dotted key, each with the tolerance of its simulation. Laws
    of a free shape are looked at where no single cause explains the data, or with `free_shapes`.

    Raises
    ------
    ScenarioError
        If nothing was measured that the diagnosis can use.
    """
    scenario, keys = measurement.scenario, known_keys()
    refuse_uncertain_geometry(scenario.coil, measurement.uncertain)
    _refuse_turns(measurement)
    observables = find_observables(measurement, threads)
    shared = [Uncertain(key, prior, keys[key].unit) for key, prior in measurement.uncertain.items()]
    nuisance = [each for observable in observables for each in observable.nuisance]
    causes = library(scenario, dict(measurement.uncertain), _top_voltage(measurement))
    amplitudes = [parameter.name for cause in causes for parameter in cause.parameters]
    # Columns that are scenario keys, and all columns.
    columns = [*(each.name for each in shared), *amplitudes]
    simulator = Simulator(scenario, columns, threads)
    walks, lost = _walks(measurement, simulator, shared, causes)
    observed, options = _data(measurement, walks, observables)
    conditions: list[dict[str, Value]] = []
    given = np.zeros(0)
    if walks.conditions:
        trials = walks.trials
        noise = fit_noise(trials.value, trials.condition, trials.block, options.relative_sd)
        rtol = loosest_tolerances(simulator, walks.conditions, shared, causes, noise, seed)
        finest = {"solver.rtol": float(np.min(rtol))}
        simulator = Simulator(scenario.replace(finest), columns, threads)
        pairs = zip(walks.conditions, rtol, strict=True)
        conditions = [{**each, "solver.rtol": float(r)} for each, r in pairs]
        believed = [float(scenario.get(name)) for name in columns]
        given = simulator(conditions, np.array([believed]))[0]
    of_walks = of_velocities(walks.trials.mean) if walks.conditions else ()
    suspects = _suspects([*(table.suspects for table in observables), of_walks])
    readings = [parameter.name for each in suspects.values() for parameter in each.parameters]
    names = [*(each.name for each in (*shared, *nuisance)), *amplitudes, *readings]
    causes = (*causes, *suspects.values())
    model = Combined(simulator, names, columns, observables, of_walks)

    def low_fidelity(conditions: Conditions, values: Array) -> Array:
        return model([_low_fidelity(scenario, each) for each in conditions], values)

    options = replace(options, seed=seed, progress=progress, low_fidelity=low_fidelity)
    found = run_steps(model, conditions, observed, [*shared, *nuisance], causes, options)
    bent = model
    wanted = free_shapes and found.verdict.kind not in ("none", "data-problem")
    if wanted or looks_for_laws(found):
        say = progress or (lambda fraction, stage: None)
        say(0.9, "laws of a free shape")
        shapes, bent = _open_set(found, options, model, simulator, conditions)
        found = judged_beside_laws(replace(found, open_set=shapes))
        say(1.0, "done")
    # The steps know nothing of drives and tables.
    of_conditions = [start_up_included(walks.conditions), standing_still(*walks.seen)]
    of_tables = [fact for each in observables for fact in each.notes]
    of_runs = _notes_of_runs(scenario, walks.conditions, threads)
    notes = (*filter(None, of_conditions), *found.notes, *of_tables, *of_runs)
    left_out = (*(fact for each in observables for fact in each.left_out), *lost)
    posed = PosedProblem(model, walks.conditions, simulator, given, left_out, bent)
    return replace(found, notes=notes), posed


def _notes_of_runs(scenario: Scenario, conditions: Conditions, threads: int) -> list[Fact]:
    """What the stated model's runs at the conditions are noted for."""
    if not conditions:
        return []
    points = from_changes(scenario, conditions)
    notes = notes_of_points(points, simulated(points, threads, None), "conditions")
    return [Fact(Code.STATED_RUNS, {"note": each.code, "text": each.text}) for each in notes]


def _suspects(of_tables: Sequence[Sequence[Cause]]) -> dict[str, Cause]:
    """What may be wrong with the readings, by name.

    Of tables of one kind that of the widest readings: a limit may lie anywhere below them.
    """
    every = [each for suspects in of_tables for each in suspects]
    every.sort(key=lambda each: each.parameters[0].high)
    return {each.name: each for each in every}


def _open_set(
    found: Findings,
    options: Options,
    model: Combined,
    simulator: Simulator,
    conditions: Conditions,
) -> tuple[OpenSet | None, Combined]:
    """Laws of a free shape at the recalibrated model, and the model that has them.

    No laws, and the model as it is, where no velocity was measured.
    """
    if not conditions:
        return None, model
    problem, null = found.problem, found.null
    count = problem.base_count
    constants = problem.physical(null.x[None, :])[0][:count]
    names = [each.name for each in problem.uncertain]
    own = {
        name: value for name, value in zip(names, constants, strict=True) if name in known_keys()
    }
    recalibrated = simulator.scenario.replace({key: float(value) for key, value in own.items()})
    spans = find_spans([recalibrated.replace(each) for each in conditions], simulator.threads)
    # A law that the scenario has, or that is uncertain, is no candidate.
    stated = {key.split(".")[1] for key in own if key.startswith("effects.")}
    hooks = [each for each in HOOKS if each.effect in spans]
    hooks = [each for each in hooks if each.effect not in {*recalibrated.effects, *stated}]
    terms = [hook.term(recalibrated, spans[hook.effect]) for hook in hooks]
    knots = [name for each in terms for name in each.knots]
    # Observables have scenarios of their own, so that the spans are columns as the knots are.
    reach = {key: value for each in terms for key, value in each.fixed.items()}
    free = Simulator(simulator.scenario, [*own, *knots, *reach], simulator.threads)
    bent = Combined(free, [*names, *knots], [*own, *knots], model.observables, fixed=reach)

    def low_fidelity(conditions: Conditions, values: Array) -> Array:
        return bent([_low_fidelity(free.scenario, each) for each in conditions], values)

    return search_terms(found, options, bent, low_fidelity, terms), bent


def _walks(
    measurement: Measurement,
    simulator: Simulator,
    constants: Sequence[Uncertain],
    causes: Sequence[Cause],
) -> tuple[_Walks, list[Fact]]:
    """All tables but the conditions that the stated model cannot compute, and a fact for each.

    The model is at the middle of all priors, without any cause. If it computes no condition, all
    stay: then something is wrong with the data, and that is said.
    """
    conditions, trials = pooled_velocities(measurement.velocity)
    if not conditions:
        return _Walks(conditions, trials, np.zeros(0)), []
    absent = [each.value(np.zeros(1))[0] for cause in causes for each in cause.parameters]
    middle = [float(each.prior.value(0.0)) for each in constants]
    nominal = simulator(conditions, np.array([[*middle, *absent]]))[0]
    sound = np.isfinite(nominal)
    if not sound.any():
        return _Walks(conditions, trials, nominal), []
    among = varied(conditions)
    lost = [
        Fact(Code.CONDITION_NOT_COMPUTED, named(each, among))
        for each in compress(conditions, ~sound)
    ]
    return _Walks(list(compress(conditions, sound)), trials.at(sound), nominal[sound]), lost


def _data(
    measurement: Measurement, walks: _Walks, observables: Sequence[Observable]
) -> tuple[Array, Options]:
    """What was observed, and what is known of it; angles, fields and films can stand alone."""
    known = pooled_observables(observables)
    source = [each.name for each in observables for _ in each.observed]
    if not walks.conditions:
        if known is None:
            raise ScenarioError(f"{measurement.path}: nothing was measured that can be diagnosed")
        return known.observed, Options(sd=known.covariance, group=known.group, source=source)
    # One error for all tables: of those that state one, the largest.
    stated = [each.relative_sd for each in measurement.velocity if math.isfinite(each.relative_sd)]
    return walks.trials.value, Options(
        condition=walks.trials.condition,
        block=walks.trials.block,
        order=walks.trials.order,
        run=walks.trials.run,
        auxiliary=known,
        relative_sd=max(stated, default=math.nan),
        singleton_condition=find_singleton_condition(walks.conditions),
        settings=_smooth_settings(walks.conditions),
        source=["velocity"] * len(walks.conditions) + source,
        data_problem=wrong_size(*walks.seen, measurement.refusal()) or wrong_sign(*walks.seen),
    )


def _low_fidelity(scenario: Scenario, condition: Mapping[str, Value]) -> dict[str, Value]:
    """A condition that is computed sooner and less exactly."""
    pulses = float(condition.get("drive.pulses", scenario.get("drive.pulses")))
    fewer = min(pulses, _LOW_FIDELITY_PULSES)
    return {**condition, "solver.rtol": TOLERANCES[0], "drive.pulses": fewer}


def _driven(measurement: Measurement) -> list[Scenario]:
    """The scenario of each drive that was measured; the stated one if there is none."""
    stated = measurement.scenario
    drives = [
        stated.replace({"drive.program": None, **each})
        for data in measurement.velocity
        for each in data.conditions
    ]
    return [*drives, *(run.scenario for run in measurement.tracking)] or [stated]


def _refuse_turns(measurement: Measurement) -> None:
    """Refuse drives that turn the robot: velocities and films are compared along x."""
    for each in _driven(measurement):
        if each.turns and each.coil.map is None:
            raise ScenarioError(
                f"{measurement.path}: with drive.heading = {each.drive.heading:g} or what else "
                "pushes it across the robot leaves its plane; allowed in a diagnosis are robots "
                "that walk along x"
            )


def _top_voltage(measurement: Measurement) -> float:
    """Largest voltage that any drive asks for, V."""
    return max(volts for each in _driven(measurement) for volts in peak_voltages(each).values())


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
