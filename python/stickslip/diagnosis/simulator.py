"""The stick-slip simulator as a forward model of the engine."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from stickslip import _core
from stickslip.diagnosis.ceiling import Settings
from stickslip.diagnosis.channels import Channel, Combined, Sketch, find_channels
from stickslip.diagnosis.comparison import Progress
from stickslip.diagnosis.conditions import in_words, varied
from stickslip.diagnosis.engine import Diagnosis, Known, diagnose_model
from stickslip.diagnosis.library import library, parameter_unit
from stickslip.diagnosis.model import Cause, Uncertain
from stickslip.diagnosis.noise import NoiseModel, fit_noise
from stickslip.errors import ScenarioError
from stickslip.keys import Value
from stickslip.measurement.reading import Measurement
from stickslip.processors import worker_count
from stickslip.run_notes import peak_voltages
from stickslip.scenario import Scenario

Array = NDArray[np.float64]
Conditions = Sequence[Mapping[str, Value]]

_TOLERANCES = (1e-4, 1e-5, 1e-6)
_TOLERANCE_DRAWS, _MOST = 8, 0.75
_DRAFT_PULSES = 5.0
_FEW = 8
_SMALLEST = 0.02
_OPPOSITE = -0.8
_REVERSED = 3


class Simulator:
    """Mean velocities at conditions and parameters, by one batch call of the core.

    Parameters
    ----------
    scenario : Scenario
        Everything that neither a condition nor a parameter sets.
    parameters : sequence of str
        Dotted keys of the parameters' columns.
    threads : int, optional
        Simulations at a time; as many as there are processors, if not given.
    """

    def __init__(
        self, scenario: Scenario, parameters: Sequence[str], threads: int | None = None
    ) -> None:
        self.scenario = scenario
        self.parameters = tuple(parameters)
        self.threads = worker_count(threads, "threads")
        self.simulated = 0
        self._words = {row["key"]: list(row["allowed"]) for row in _core.choices()}

    def __call__(self, conditions: Conditions, parameters: Array) -> Array:
        """Velocities, m/s, shape (vectors, conditions); NaN where a simulation is refused."""
        keys = sorted({key for each in conditions for key in each})
        settings = np.array(
            [[self._number(key, each.get(key, self.scenario.get(key))) for key in keys]
             for each in conditions]
        )  # fmt: skip
        vectors, count = len(parameters), len(conditions)
        values = np.hstack([np.tile(settings, (vectors, 1)), np.repeat(parameters, count, axis=0)])
        columns, _ = _core.sweep(
            self.scenario.to_core(), [*keys, *self.parameters], values, self.threads
        )
        self.simulated += len(values)
        velocity = np.where(columns["status"] == 0, columns["mean_velocity"], np.nan)
        return np.asarray(velocity.reshape(vectors, count), dtype=float)

    def _number(self, key: str, value: Value) -> float:
        if isinstance(value, str):
            return float(self._words[key].index(value))
        return float(value)


@dataclass(frozen=True)
class Examination:
    """A diagnosis and what it was made with.

    Attributes
    ----------
    found : Diagnosis
    simulator : Simulator
        Of mean velocities.
    conditions : list of dict
        Drive settings by dotted key, of the first rows of `Diagnosis.problem.observed`.
    combined : Combined
        The forward model of all rows; its channels' rows follow those of the conditions.
    left_out : tuple of str
        Sound rows that could not be used, and why.
    given : ndarray, shape (conditions,)
        Velocities of the scenario as it was given, m/s; NaN where it has none.
    """

    found: Diagnosis
    simulator: Simulator
    conditions: list[dict[str, Value]]
    combined: Combined
    left_out: tuple[str, ...]
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

    def sketches(self) -> list[Sketch]:
        """Parts of the report that the channels draw."""
        problem, fit = self.found.problem, self.found.verdict.fit
        null = problem.physical(self.found.null.x[None, :])[0]
        extended = None if fit is None else problem.physical(fit.x[None, :])[0]
        drawn = []
        for number, channel in enumerate(self.combined.channels):
            names, before = self.combined.sketch_arguments(number, null)
            after = None
            if extended is not None:
                after = self.combined.sketch_arguments(number, extended)[1]
            drawn += channel.sketches(names, before, after)
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
    conditions, velocity, index, block, order = _merged(measurement)
    channels = find_channels(measurement, threads)
    stated = [each.relative_sd for each in measurement.velocity if math.isfinite(each.relative_sd)]
    # One error for all tables: of those that state one, the largest.
    relative_sd = max(stated, default=math.nan)
    uncertain = [
        Uncertain(name, prior, parameter_unit(name))
        for name, prior in measurement.uncertain.items()
    ]
    nuisance = [each for channel in channels for each in channel.nuisance]
    causes = library(measurement.scenario, dict(measurement.uncertain), _top_voltage(measurement))
    shared = [each.name for each in uncertain]
    amplitudes = [parameter.name for cause in causes for parameter in cause.parameters]
    keys = [*shared, *amplitudes]
    names = [*shared, *(each.name for each in nuisance), *amplitudes]
    simulator = Simulator(measurement.scenario, keys, threads)
    middle = _nominal(simulator, conditions, uncertain, causes)
    lost = np.flatnonzero(~np.isfinite(middle))
    left_out = [line for channel in channels for line in channel.left_out]
    if len(lost) and len(lost) < len(conditions):
        kept = np.isfinite(middle)[index]
        number = np.cumsum(np.isfinite(middle)) - 1
        velocity, block, order = velocity[kept], block[kept], order[kept]
        index = number[index[kept]]
        among = varied(conditions)
        left_out += [
            f"{in_words(conditions[k], among)}: the stated model cannot compute it"
            for k in lost.tolist()
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
    combined = Combined(simulator, names, keys, channels)
    known = _known(channels)
    options: dict[str, Any] = {"seed": seed, "progress": progress}
    if conditions:
        options |= {"condition": index, "block": block, "order": order, "also": known}
        options |= {"relative_sd": relative_sd}
        options["doubt"] = _wrong_size(middle, noise.mean) or wrong_sign(
            conditions, middle, noise.mean
        )
    elif known is not None:
        velocity = known.observed
        options |= {"sd": known.covariance, "group": known.group}
    else:
        raise ScenarioError(f"{measurement.path}: nothing was measured that can be diagnosed")

    def draft(conditions: Conditions, parameters: Array) -> Array:
        return combined([_drafted(measurement.scenario, each) for each in conditions], parameters)

    source = ["velocity"] * len(computed)
    source += [channel.name for channel in channels for _ in channel.observed]
    options |= {"draft": draft, "settings": _settings(conditions), "source": source}
    found = diagnose_model(combined, computed, velocity, [*uncertain, *nuisance], causes, **options)
    notes = (*found.notes, *(line for channel in channels for line in channel.notes))
    return Examination(
        replace(found, notes=notes), simulator, conditions, combined, tuple(left_out), predicted
    )


def loosest_tolerances(
    simulator: Simulator,
    conditions: Conditions,
    uncertain: Sequence[Uncertain],
    causes: Sequence[Cause],
    noise: NoiseModel,
    seed: int,
) -> Array:
    """For each condition the largest of some tolerances whose error is far below the noise.

    A twentieth, not only a fifth, of the noise: derivatives are taken over steps whose effect is
    about the noise.

    Judged at draws of the uncertain parameters against a tolerance a hundred times finer than the
    finest tried. Where the motion is so sensitive that no tolerance will do, one is enough that is
    hardly worse than the finest. Shape (conditions,).
    """
    random = np.random.default_rng([seed, 31])
    absent = [each.value(np.zeros(1))[0] for cause in causes for each in cause.parameters]
    draws = [
        [*(each.prior.value(random.standard_normal()) for each in uncertain), *absent]
        for _ in range(_TOLERANCE_DRAWS)
    ]
    base, threads = simulator.scenario, simulator.threads
    finest = min(float(base.get("solver.rtol")), _TOLERANCES[-1])
    tried = np.array([each for each in _TOLERANCES if each > finest] + [finest])

    def velocities(rtol: float) -> Array:
        scenario = base.replace({"solver.rtol": rtol})
        return Simulator(scenario, simulator.parameters, threads)(conditions, np.array(draws))

    truth = velocities(max(0.01 * finest, 1e-11))
    errors = np.array([_most(np.abs(velocities(rtol) - truth)) for rtol in tried])
    allowed = np.maximum(np.sqrt(np.diag(noise.covariance)) / 20.0, 1.5 * errors[-1])
    good = errors <= allowed
    good[-1] = True
    return np.asarray(tried[np.argmax(good, axis=0)])


def _most(errors: Array) -> Array:
    """Below which most of the errors of each column are; infinity where there is none."""
    some = np.isfinite(errors).any(axis=0)
    return np.where(some, np.nanquantile(np.where(some, errors, 0.0), _MOST, axis=0), np.inf)


def _drafted(scenario: Scenario, condition: Mapping[str, Value]) -> dict[str, Value]:
    """A condition that is computed sooner and less exactly."""
    pulses = float(condition.get("drive.pulses", scenario.get("drive.pulses")))
    return {
        **condition, "solver.rtol": _TOLERANCES[0], "drive.pulses": min(pulses, _DRAFT_PULSES)
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


def _settings(conditions: Conditions) -> Settings | None:
    """Where the conditions lie, if they are enough for a smooth function."""
    if len(conditions) < _FEW:
        return None
    keys = ("drive.frequency", "drive.peak", "drive.hold", "drive.base")
    numbers = np.array([[float(each[key]) for key in keys] for each in conditions])
    numbers[:, 0] = np.log(numbers[:, 0])
    words = [(each["drive.mode"], each["drive.direction"]) for each in conditions]
    number = {word: k for k, word in enumerate(dict.fromkeys(words))}
    return Settings(numbers, np.array([number[word] for word in words]))


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


def _wrong_size(predicted: Array, velocity: Array) -> str | None:
    """Whether the velocities can be what the model speaks of, by their size and sign."""
    sound = np.isfinite(predicted)
    if not sound.any():
        return "no condition can be simulated with the stated scenario; look at its settings"
    usual, measured = (float(np.median(np.abs(each[sound]))) for each in (predicted, velocity))
    if usual == 0.0 or measured == 0.0:
        return None
    ratio = measured / usual
    if not _SMALLEST < ratio < 1.0 / _SMALLEST:
        unit = ""
        if 0.1 < ratio / 1e3 < 10.0 or 0.1 < ratio * 1e3 < 10.0:
            unit = ", so a column may be in a unit that is wrong by 1000"
        return (
            f"the velocities are about {ratio:.3g} times what the stated model gives "
            f"({measured:.3g} against {usual:.3g} m/s){unit}"
        )
    likeness = float(predicted[sound] @ velocity[sound])
    likeness /= float(np.linalg.norm(predicted[sound]) * np.linalg.norm(velocity[sound]))
    if likeness < _OPPOSITE:
        return (
            "the velocities have the opposite sign of the stated model's; "
            "x, a direction or a clamp may be reversed"
        )
    return None


def wrong_sign(conditions: Conditions, predicted: Array, velocity: Array) -> str | None:
    """Whether velocities are speeds, or count forwards, or one direction or mode, the other way.

    Every condition that is not slow has then the model's size, and its sign or the reverse by a
    rule that a cause would hardly follow.
    """
    usual = float(np.nanmedian(np.abs(predicted)))
    clear = np.isfinite(predicted) & (np.minimum(np.abs(predicted), np.abs(velocity)) > usual / 3)
    ratio = np.abs(velocity[clear] / predicted[clear])
    reversed_ = np.sign(velocity[clear]) != np.sign(predicted[clear])
    away = np.abs(np.log(ratio))
    if min(reversed_.sum(), (~reversed_).sum()) < _REVERSED:
        return None
    if max(np.median(away[reversed_]), np.median(away[~reversed_])) > np.log(1.5):
        return None
    if np.array_equal(reversed_, predicted[clear] < 0.0):
        return (
            "the velocities have the model's size without its sign: they look like speeds; a "
            "velocity is that along +x"
        )
    for key in ("drive.direction", "drive.mode"):
        words = np.array([str(each[key]) for each in conditions])[clear]
        for word in sorted(set(words.tolist())):
            if np.array_equal(reversed_, words == word):
                return (
                    f"the velocities have the model's size, and the reverse of its sign wherever "
                    f"{key.split('.')[1]} is {word}; a velocity is that along +x"
                )
    return None


def _known(channels: Sequence[Channel]) -> Known | None:
    """Rows of all channels one after another."""
    if not channels:
        return None
    groups, above = [], 0
    for channel in channels:
        groups.append(channel.group + above)
        above += int(channel.group.max()) + 1
    return Known(
        np.concatenate([channel.observed for channel in channels]),
        np.asarray(block_diag(*(channel.covariance for channel in channels)), dtype=float),
        np.concatenate(groups),
    )


def _merged(
    measurement: Measurement,
) -> tuple[list[dict[str, Value]], Array, NDArray[np.int64], NDArray[np.int64], Array]:
    """All tables as one, with conditions in an order that does not depend on the rows'."""
    found: dict[tuple[tuple[str, Value], ...], list[tuple[float, int, float]]] = {}
    above = 0
    for data in measurement.velocity:
        rows = zip(data.velocity, data.condition, data.block, data.order, strict=True)
        for velocity, at, block, order in rows:
            key = tuple(sorted(data.conditions[at].items()))
            shifted = int(block) + above if block >= 0 else -1
            found.setdefault(key, []).append((float(velocity), shifted, float(order)))
        above += int(data.block.max()) + 1
    ordered = sorted(found, key=_rank)
    trials = [(number, *trial) for number, key in enumerate(ordered) for trial in found[key]]
    return (
        [dict(key) for key in ordered],
        np.array([trial[1] for trial in trials]),
        np.array([trial[0] for trial in trials], dtype=np.int64),
        np.array([trial[2] for trial in trials], dtype=np.int64),
        np.array([trial[3] for trial in trials]),
    )


def _rank(key: tuple[tuple[str, Value], ...]) -> tuple[object, ...]:
    """Words first, then the field, then the frequency: neighbours lie on one curve."""
    words = tuple(value for _, value in key if isinstance(value, str))
    numbers = {name: float(value) for name, value in key if not isinstance(value, str)}
    frequency = numbers.pop("drive.frequency", 0.0)
    return (*words, *(numbers[name] for name in sorted(numbers)), frequency)
