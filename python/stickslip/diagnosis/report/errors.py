"""Mean errors of two models, as a person reads them: in per cent, and in a handy unit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.inference.cross_validation import Gain
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.facts.sentences import two_digits

Array = NDArray[np.float64]

MIXED = "SI"
"""What the unit is called where readings of several units are held out together."""

SHOWN = {
    "m/s": ("mm/s", 1e3),
    "rad": ("degrees", math.degrees(1.0)),
    "T": ("mT", 1e3),
}
"""Unit that people use in place of an SI unit, and the factor to it."""


@dataclass(frozen=True)
class Errors:
    """Mean errors before and after something was found.

    Attributes
    ----------
    before, after : float, optional
        Mean absolute errors in the unit; where readings have several units, root mean squares in
        units of their noise. None where there is no such model.
    level : float, optional
        Mean absolute size of the readings, where they have one unit.
    unit : str
    """

    before: float | None
    after: float | None
    level: float | None
    unit: str

    @property
    def in_short(self) -> dict[str, str]:
        """Both as fields of a headline, in per cent where they have one unit."""
        before, after = self._short(self.before), self._short(self.after)
        return {"before": before, "after": f"{after} the noise" if self.unit == MIXED else after}

    @property
    def in_full(self) -> dict[str, str]:
        """Both with their unit, as fields of a fact."""
        return {"before": self._full(self.before), "after": self._full(self.after)}

    def _short(self, error: float | None) -> str:
        if error is None:
            return "nothing"
        if self.unit == MIXED:
            return f"{two_digits(error)} times"
        if self.level is None:
            return self._full(error)
        return f"{two_digits(100.0 * error / self.level)} %"

    def _full(self, error: float | None) -> str:
        if error is None:
            return "nothing"
        if self.unit == MIXED:
            return f"{two_digits(error)} times the noise"
        unit, factor = SHOWN.get(self.unit, ("" if self.unit == "-" else self.unit, 1.0))
        text = f"{error * factor:.2g} {unit}".rstrip()
        if self.level is None:
            return text
        return f"{two_digits(100.0 * error / self.level)} % ({text})"


def gain_unit(posed: PosedProblem) -> str:
    """Unit of what is held out: velocities, where there are any, else the channels' observables."""
    if posed.conditions:
        return "m/s"
    kinds = {observable.name for observable in posed.model.observables}
    return {"angle": "rad", "field": "T"}.get(kinds.pop(), MIXED) if len(kinds) == 1 else MIXED


def errors_of_gain(found: Findings, gain: Gain, unit: str) -> Errors:
    """Errors on the held-out conditions."""
    if unit == MIXED:
        return Errors(math.sqrt(gain.chi2_before), math.sqrt(gain.chi2_after), None, unit)
    level = _level(found.problem.observed[gain.held_out])
    return Errors(gain.mae_before, gain.mae_after, level, unit)


def errors_of(found: Findings, posed: PosedProblem, unit: str) -> Errors:
    """Errors on the conditions of the fit.

    Of the extended model after the recalibrated one; where there is none, of the recalibrated model
    after the stated one, which is not known of a model of one's own.
    """
    m = len(posed.conditions) or len(found.problem.observed)
    observed, stated = found.problem.observed[:m], None
    models = [(found.problem, found.null), *([] if found.extended is None else [found.extended])]
    if unit == MIXED:
        level = None
        error = [math.sqrt(fit.data_chi2 / len(problem.observed)) for problem, fit in models]
    else:
        level = _level(observed)
        if len(posed.given) == m:
            stated = _mean_error(observed, posed.given)
        error = [
            _mean_error(observed, problem.predicted(fit.x[None, :])[0, :m])
            for problem, fit in models
        ]
    before, after = error if len(error) == 2 else (stated, error[0])
    return Errors(before, after, level, unit)


def _mean_error(observed: Array, predicted: Array) -> float:
    """Of the observables that the model computes; NaN where it computes none."""
    error = np.abs(observed - predicted)
    return float(np.mean(error[np.isfinite(error)])) if np.isfinite(error).any() else math.nan


def _level(observed: Array) -> float | None:
    size = float(np.mean(np.abs(observed)))
    return size if size > 0.0 else None
