"""The stick-slip simulator as a forward model, and how exactly it has to compute."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stickslip import _core
from stickslip._util.processor_count import worker_count
from stickslip.diagnosis.data.conditions import Conditions
from stickslip.diagnosis.data.trial_noise import NoiseModel
from stickslip.diagnosis.model.problem import Array, Cause, Uncertain
from stickslip.scenario.keys import Value
from stickslip.scenario.scenario import Scenario

TOLERANCES = (1e-4, 1e-5, 1e-6)
"""Relative tolerances of the simulator that are tried, the loosest first. Chosen: decades."""

# Error of the model over that of the data, at most. Chosen, see `loosest_tolerances`.
_MODEL_ERROR = 0.05
# Draws of the constants at which tolerances are judged, and the quantile of the errors over them
# that counts. Chosen: at one draw of four the motion may jump, where no tolerance helps.
_DRAWS, _QUANTILE = 8, 0.75


class Simulator:
    """Mean velocities at conditions and parameters, by one batch call of the core.

    `parameters` are the dotted keys of the parameters' columns; `scenario` sets everything that
    neither a condition nor a parameter sets. `simulated` counts the simulations.
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


def loosest_tolerances(
    simulator: Simulator,
    conditions: Conditions,
    uncertain: Sequence[Uncertain],
    causes: Sequence[Cause],
    noise: NoiseModel,
    seed: int,
) -> Array:
    """For each condition the largest tolerance whose error is far below the noise, (conditions,).

    The error is judged at draws of the uncertain parameters, against a tolerance a hundred times
    finer than the finest that is tried. A twentieth of the noise is allowed, because derivatives
    are taken over steps whose effect is about the noise. Where the motion is so sensitive that no
    tolerance reaches that, one suffices whose error is at most 1.5 times that of the finest.
    """
    random = np.random.default_rng([seed, 31])
    absent = [each.value(np.zeros(1))[0] for cause in causes for each in cause.parameters]
    draws = [
        [*(each.prior.value(random.standard_normal()) for each in uncertain), *absent]
        for _ in range(_DRAWS)
    ]
    base, threads = simulator.scenario, simulator.threads
    finest = min(float(base.get("solver.rtol")), TOLERANCES[-1])
    tried = np.array([each for each in TOLERANCES if each > finest] + [finest])

    def velocities(rtol: float) -> Array:
        scenario = base.replace({"solver.rtol": rtol})
        return Simulator(scenario, simulator.parameters, threads)(conditions, np.array(draws))

    truth = velocities(max(0.01 * finest, 1e-11))
    errors = np.array([_typical_largest(np.abs(velocities(rtol) - truth)) for rtol in tried])
    allowed = _MODEL_ERROR * np.sqrt(np.diag(noise.covariance))
    allowed = np.maximum(allowed, 1.5 * errors[-1])
    good = errors <= allowed
    good[-1] = True
    return np.asarray(tried[np.argmax(good, axis=0)])


def _typical_largest(errors: Array) -> Array:
    """Quantile of the errors of each column; infinity where nothing could be computed."""
    some = np.isfinite(errors).any(axis=0)
    return np.where(some, np.nanquantile(np.where(some, errors, 0.0), _QUANTILE, axis=0), np.inf)
