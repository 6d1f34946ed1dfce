"""The constants that recalibration has moved, in a person's units."""

from __future__ import annotations

from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.model.problem import Uncertain
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.parameters import short
from stickslip.facts.causes import CONSTANTS
from stickslip.scenario.keys import known_keys

_LISTED = 3
"""Constants that are named. Chosen: a table has all."""

_NEAR = 1.0
"""Standard deviations of what was stated within which a constant has not moved. Chosen."""


def moved(found: Findings, posed: PosedProblem) -> list[dict[str, object]]:
    """The constants that are farthest from what was stated, those of a mere range too.

    Each has `name`, `unit`, `before`, `after`, and `pull`, in standard deviations of what was
    stated, which is None of a range; that begins at the value that the scenario has, and nowhere
    in a model of one's own.
    """
    pulls = zip(found.problem.uncertain, map(float, found.null.x), strict=False)
    far = [
        (constant, pull)
        for constant, pull in pulls
        if not constant.prior.has_middle or abs(pull) > _NEAR
    ]
    far.sort(key=lambda each: -abs(each[1]))
    return [_moved(posed, *each) for each in far[:_LISTED]]


def _moved(posed: PosedProblem, constant: Uncertain, pull: float) -> dict[str, object]:
    name, unit, factor = constant.name, constant.unit, 1.0
    before, is_range = None, not constant.prior.has_middle
    if not is_range:
        before = float(constant.prior.value(0.0))
    elif posed.simulator is not None and name in known_keys():
        before = float(posed.simulator.scenario.get(name))
    key = known_keys().get(name)
    # A model of one's own may have a constant of the same name in a unit of its own.
    if name in CONSTANTS and key is not None and key.unit == unit:
        words = CONSTANTS[name]
        name, unit, factor = words.name, words.unit, words.size.factor
    return {
        "name": short(name),
        "unit": "" if unit == "-" else unit,
        "before": None if before is None else before * factor,
        "after": float(constant.prior.value(pull)) * factor,
        "pull": None if is_range else pull,
    }
