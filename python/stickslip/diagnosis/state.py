"""What a diagnosis knows between its steps."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.data.noise import NoiseModel
from stickslip.diagnosis.fit.baseline import Recalibration
from stickslip.diagnosis.fit.fit_result import Ranking
from stickslip.diagnosis.fit.profile_likelihood import Profile
from stickslip.diagnosis.inference.cross_validation import Gain
from stickslip.diagnosis.inference.model_comparison import AssessedBaseline
from stickslip.diagnosis.inference.verdict import Verdict
from stickslip.diagnosis.input_checks import Trials
from stickslip.diagnosis.model.problem import Problem
from stickslip.diagnosis.options import Options
from stickslip.facts import Fact

Array = NDArray[np.float64]


@dataclass(repr=False, eq=False)
class State(OneLine):
    """What one diagnosis knows so far. Each step reads what those before it have set.

    Attributes
    ----------
    options : Options
    trials : Trials
    noise : NoiseModel
        Set by `estimate_noise`.
    covariance : ndarray, shape (m, m)
        Of the data alone. Set by `estimate_noise`; `fit_baseline` makes errors that set-ups share
        follow the recalibrated model.
    problem : Problem
        Set by `pose`, with the errors of `covariance`.
    recalibration : Recalibration
        Set by `fit_baseline`.
    base : AssessedBaseline
        The recalibrated model, its errors and the test. Set by `detect_departure`; `compare_causes`
        and `find_profiles` may lead to a better one.
    data_problem : Fact, optional
        What makes the data suspect. Set by `detect_departure`.
    ranking : Ranking
        Set by `compare_causes`.
    cosines : ndarray, shape (causes, causes)
        How alike the causes' effects are. Set by `compare_effects`.
    screened : dict
        Log-evidence of each cause by linear screening. Set by `compare_effects`.
    smooth_bound : float, optional
        Chi-square that a smooth function would take. Set by `compare_effects`.
    verdict : Verdict
        Set by `decide_verdict`; `find_profiles` and `measure_improvement` may make it more careful.
    profiles : list of Profile
        Set by `find_profiles`.
    gain : Gain, optional
        Set by `measure_improvement`.
    notes : list of Fact
        Whatever a reader has to know, by several steps.
    """

    options: Options
    trials: Trials
    noise: NoiseModel = field(init=False)
    covariance: Array = field(init=False)
    problem: Problem = field(init=False)
    recalibration: Recalibration = field(init=False)
    base: AssessedBaseline = field(init=False)
    data_problem: Fact | None = None
    ranking: Ranking = field(init=False)
    cosines: Array = field(init=False)
    screened: dict[str, float] = field(init=False)
    smooth_bound: float | None = None
    verdict: Verdict = field(init=False)
    profiles: list[Profile] = field(default_factory=list)
    gain: Gain | None = None
    notes: list[Fact] = field(default_factory=list)

    @property
    def dof(self) -> float:
        """Degrees of freedom of the trials' noise; infinity where it is stated or not known."""
        return self.noise.dof if self.noise.dof > 0 else math.inf

    @property
    def compared(self) -> bool:
        """Whether there is reason to look for a cause."""
        return self.data_problem is None and self.base.detection.found
