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
    problem, fit = found.problem, found.verdict.fit
    if unit == MIXED:
        both = (found.null.data_chi2, None if fit is None else fit.data_chi2)
        rms = [None if c is None else math.sqrt(c / len(problem.observed)) for c in both]
        return Errors(rms[0], rms[1], None, unit) if fit else Errors(None, rms[0], None, unit)
    m = len(posed.conditions) or len(problem.observed)
    observed = problem.observed[:m]
    null = _mean_error(observed, problem.predicted(found.null.x[None, :])[0, :m])
    level = _level(observed)
    if fit is not None:
        after = _mean_error(observed, problem.predicted(fit.x[None, :])[0, :m])
        return Errors(null, after, level, unit)
    stated = _mean_error(observed, posed.given) if len(posed.given) == m else None
    return Errors(stated, null, level, unit)


def _mean_error(observed: Array, predicted: Array) -> float | None:
    error = np.abs(observed - predicted)
    return float(np.mean(error[np.isfinite(error)])) if np.isfinite(error).any() else None


def _level(observed: Array) -> float | None:
    size = float(np.mean(np.abs(observed)))
    return size if size > 0.0 else None
