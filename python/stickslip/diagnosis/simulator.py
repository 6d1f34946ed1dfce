"""The stick-slip simulator as a forward model of the engine."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.diagnosis.engine import Diagnosis, diagnose_model
from stickslip.diagnosis.library import library, parameter_unit
from stickslip.diagnosis.model import Uncertain
from stickslip.errors import ScenarioError
from stickslip.keys import Value
from stickslip.measurement.reading import Measurement
from stickslip.processors import worker_count
from stickslip.scenario import Scenario

Array = NDArray[np.float64]
Conditions = Sequence[Mapping[str, Value]]


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


def diagnose(
    measurement: Measurement,
    *,
    seed: int = 0,
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> tuple[Diagnosis, Simulator, list[dict[str, Value]]]:
    """Diagnose measured mean velocities with the simulator and its library of causes.

    Parameters
    ----------
    measurement : Measurement
    seed : int
        Of all random draws; the result does not depend on `threads`.
    threads : int, optional
    progress : callable, optional
        Called with the fraction that is done.

    Returns
    -------
    diagnosis : Diagnosis
    simulator : Simulator
        The forward model that was used.
    conditions : list of dict
        Drive settings by dotted key, in the order of `Diagnosis.problem.observed`.

    Raises
    ------
    ScenarioError
        If nothing was measured that the diagnosis can use.
    """
    if not measurement.velocity:
        raise ScenarioError(
            f"{measurement.path}: there is no [[velocity]]; a diagnosis needs mean velocities"
        )
    conditions, velocity, index, block, order = _merged(measurement)
    top = max(
        max(abs(float(each["drive.peak"])), abs(float(each["drive.hold"]))) for each in conditions
    )
    uncertain = [
        Uncertain(name, prior, parameter_unit(name))
        for name, prior in measurement.uncertain.items()
    ]
    causes = library(measurement.scenario, dict(measurement.uncertain), top)
    names = [each.name for each in uncertain]
    names += [parameter.name for cause in causes for parameter in cause.parameters]
    simulator = Simulator(measurement.scenario, names, threads)
    stated = [each.relative_sd for each in measurement.velocity if math.isfinite(each.relative_sd)]
    found = diagnose_model(
        simulator,
        conditions,
        velocity,
        uncertain,
        causes,
        condition=index,
        block=block,
        order=order,
        relative_sd=stated[0] if stated else math.nan,
        seed=seed,
        progress=progress,
    )
    return found, simulator, conditions


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
