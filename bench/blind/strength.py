"""Signal to noise of what is hidden, after all that recalibration could absorb of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from blind.apparatus import FLOOR, PULSES, SCATTER, TRIALS
from blind.truth import Drive, Truth
from stickslip import Scenario
from stickslip.diagnosis.fit.baseline import recalibrate
from stickslip.diagnosis.fit.fit_result import Start, make_candidate
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.model.problem import Problem, Uncertain
from stickslip.diagnosis.model.simulator import Simulator
from stickslip.measurement import Prior

Array = NDArray[np.float64]

PRIORS = {
    "contact.kinetic_friction": Prior("normal", 0.145, 0.01),
    "contact.adhesion": Prior("normal", 0.22e-6, 0.03e-6),
    "drag.linear": Prior("log-uniform", 1e-6, 1e-4),
    "drag.rotational": Prior("log-normal", 9e-17, 2.0),
}

_FEWER = 5.0  # pulses of a draft, for the search from afar


class Absorber:
    """What the constants can undo about a truth.

    The core is used only to say how strong a hidden effect is; no datum comes from it.
    """

    def __init__(self, truth: Truth, drives: Sequence[Drive], level: Array) -> None:
        values = [truth.constants[name.split(".")[1]] for name in PRIORS]
        self._centre = np.array(
            [prior.coordinate(value) for prior, value in zip(PRIORS.values(), values, strict=True)]
        )
        scenario = Scenario().replace({"solver.rtol": 1e-5})
        settings = [
            {**{f"drive.{key}": value for key, value in drive.items()}, "drive.pulses": PULSES}
            for drive in drives
        ]
        low_fidelity = [{**each, "drive.pulses": _FEWER, "solver.rtol": 1e-4} for each in settings]
        simulator = Simulator(scenario, list(PRIORS), 1)
        sd = np.hypot(SCATTER * level, FLOOR) / np.sqrt(TRIALS)
        self._problem = Problem(
            simulator,
            settings,
            level,
            np.diag(1.0 / sd),
            np.inf,
            tuple(Uncertain(name, prior) for name, prior in PRIORS.items()),
            low_fidelity=lambda _, parameters: simulator(low_fidelity, parameters),
        )
        self._plain = self._nearby(level)

    def strength(self, level: Array) -> float:
        """S of velocities without noise, m/s: what is left of them after recalibration nearby."""
        return self._size(self._nearby(level))

    def searched(self, level: Array) -> float:
        """The same after recalibration that has looked for constants everywhere."""
        problem = replace(self._problem, observed=level)
        return self._size(min(self._nearby(level), recalibrate(problem, 0).null.chi2))

    def _size(self, chi2: float) -> float:
        return float(np.sqrt(max(chi2 - self._plain, 0.0)))

    def _nearby(self, level: Array) -> float:
        problem = replace(self._problem, observed=level)
        start = [[Start(self._centre)]]
        return fit_candidates(problem, [make_candidate(problem)], start, 12, exact=False)[0].chi2
