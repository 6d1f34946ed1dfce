"""All that a diagnosis found, as plain data."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip._util.one_line import OneLine
from stickslip.diagnosis.data.trial_noise import NoiseModel
from stickslip.diagnosis.fit.fit_result import Fit, Ranking
from stickslip.diagnosis.fit.profile_likelihood import Profile
from stickslip.diagnosis.fit.sensitivity import Sensitivities
from stickslip.diagnosis.inference.cross_validation import Gain
from stickslip.diagnosis.inference.detection import Detection
from stickslip.diagnosis.inference.open_set import FreeShape, OpenSet
from stickslip.diagnosis.inference.verdict import Table, Verdict
from stickslip.diagnosis.model.problem import Array, Problem
from stickslip.facts import Fact


@dataclass(frozen=True, repr=False, eq=False)
class Findings(OneLine):
    """All that the steps of a diagnosis found.

    Attributes
    ----------
    problem : Problem
    noise : NoiseModel
    roughness : ndarray, shape (m,)
        Scatter of the model itself under tiny changes of its parameters, in the observable's unit;
        part of the errors.
    null : Fit
        The recalibrated model.
    detection : Detection
    sensitivities : Sensitivities
    ranking : Ranking
    cosines : ndarray, shape (causes, causes)
    indistinguishable_causes : list of tuple of str
        Causes that these data can hardly tell apart.
    verdict : Verdict
    bounds : dict
        95 % upper limits, filled for the verdict none.
    smooth_bound : float, optional
        Chi-square that a smooth function of the settings would take from the misfit, where the
        settings were given.
    gain : Gain, optional
    profiles : tuple of Profile
        Profiles of the parameters of the verdict's fit.
    notes : tuple of Fact
    seed : int
    tables : tuple of Table
        Kinds of data that have to agree each.
    open_set : OpenSet, optional
        Laws of a free shape, where no cause explains the data or they were asked for.
    """

    problem: Problem
    noise: NoiseModel
    roughness: Array
    null: Fit
    detection: Detection
    sensitivities: Sensitivities
    ranking: Ranking
    cosines: Array
    indistinguishable_causes: list[tuple[str, ...]]
    verdict: Verdict
    bounds: dict[str, float]
    smooth_bound: float | None
    gain: Gain | None
    profiles: tuple[Profile, ...]
    notes: tuple[Fact, ...]
    seed: int
    tables: tuple[Table, ...]
    open_set: OpenSet | None = None

    @property
    def free_shape(self) -> FreeShape | None:
        """The law of a free shape that the extended model has, where no cause is claimed."""
        if self.open_set is None or self.verdict.fit is not None:
            return None
        return self.open_set.first if self.open_set.accepted else None

    @property
    def extended(self) -> tuple[Problem, Fit] | None:
        """The fit of the extended model after the problem that it is of, where there is one."""
        if self.verdict.fit is not None:
            return self.problem, self.verdict.fit
        if self.open_set is None or self.free_shape is None:
            return None
        return self.open_set.problem, self.free_shape.fit

    @property
    def held_out(self) -> NDArray[np.bool_]:
        """Which of the problem's observables were held out for the gain, shape (m,)."""
        rows = () if self.gain is None else self.gain.held_out
        return np.isin(np.arange(len(self.problem.observed)), rows)
