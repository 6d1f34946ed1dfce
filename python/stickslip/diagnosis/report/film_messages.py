"""What a tracked run says of forces."""

from __future__ import annotations

from collections.abc import Mapping

from stickslip.diagnosis.observables.tracking.comparison import Directions
from stickslip.diagnosis.observables.tracking.force_residuals import (
    CLEAR,
    FEWEST_ORDERS,
    ForceView,
    Residual,
    Slope,
)
from stickslip.facts import Code, Fact

_NEARLY = 0.7
"""Of the clearest t: a constant that has as much is named instead, as it is simpler. Chosen."""


def advance_lines(advance: Mapping[str, float] | None) -> list[Fact]:
    """The way of a pulse, if the film shows it."""
    return [] if advance is None else [Fact(Code.ADVANCE, {"extended": None, **advance})]


def view_lines(view: ForceView, after: ForceView | None) -> list[Fact]:
    """What one run says."""
    lines = []
    if view.orders < FEWEST_ORDERS:
        shown = {"phases": view.distinct, "orders": view.orders, "needed": FEWEST_ORDERS}
        lines.append(Fact(Code.TOO_FEW_PHASES, shown))
    else:
        lines.append(_torque(view.sticking))
        lines.append(_force(view.slipping))
        if view.onset is not None:
            measured, sd, model = view.onset
            same = abs(measured - model) < CLEAR * sd
            code = Code.ONSET_SAME if same else Code.ONSET_DIFFERS
            lines.append(Fact(code, {"difference": measured - model, "sd": sd}))
    lines += _drifts(view)
    if after is not None and view.slipping is not None and after.slipping is not None:
        before, now = view.slipping.slopes[0], after.slipping.slopes[0]
        if abs(before.t) > CLEAR or abs(now.t) > CLEAR:
            lines.append(Fact(Code.FORCE_WITH_CAUSE, {"before": before.t, "after": now.t}))
    return lines


def _torque(found: Residual | None) -> Fact:
    if found is None:
        return Fact(Code.TORQUE_NOT_JUDGED, {})
    return _residual(found, Code.TORQUE_CLEAN, Code.TORQUE_RESIDUAL, "N m")


def _force(found: Residual | None) -> Fact:
    if found is None:
        return Fact(Code.FORCE_NOT_JUDGED, {})
    return _residual(found, Code.FORCE_CLEAN, Code.FORCE_RESIDUAL, "N")


def _residual(found: Residual, clean: Code, other: Code, unit: str) -> Fact:
    worst, mean = _worst(found), found.slopes[0]
    if worst is None:
        # Two standard deviations could be there all the same.
        size = {"value": mean.value, "sd": mean.sd, "hidden": 2.0 * mean.sd / found.scale}
        return Fact(clean, {**size, "unit": unit})
    size = {"value": worst.value, "sd": worst.sd, "t": worst.t}
    return Fact(other, {"variable": worst.variable, **size, "unit": unit})


def _drifts(view: ForceView) -> list[Fact]:
    drifts = ((view.drift_theta, Code.DRIFT_OF_TILT), (view.drift_advance, Code.DRIFT_OF_ADVANCE))
    clear = [
        Fact(code, {"value": value, "sd": sd})
        for (value, sd), code in drifts
        if abs(value) > CLEAR * sd
    ]
    return clear or [Fact(Code.NO_DRIFT_OF_PERIODS, {})]


def direction_lines(found: Directions | None) -> list[Fact]:
    """Facts on two runs that differ in their direction alone."""
    if found is None:
        return [Fact(Code.DIRECTIONS_TOO_SHORT, {})]
    t = found.total / found.sd
    code = Code.DIRECTIONS_CANCEL if abs(t) < CLEAR else Code.DIRECTIONS_DIFFER
    ways = {"forward": found.forward, "reverse": found.reverse, "total": found.total, "t": t}
    lines = [Fact(code, ways)]
    if found.world is not None:
        forces = {"world": found.world, "robot": found.robot, "sd": found.force_sd}
        lines.append(Fact(Code.FORCES_OF_DIRECTIONS, forces))
    return lines


def _worst(found: Residual) -> Slope | None:
    """The clearest departure from zero; a constant, if it is nearly as clear as any."""
    clear = [each for each in found.slopes if abs(each.t) > CLEAR]
    if not clear:
        return None
    best = max(clear, key=lambda each: abs(each.t))
    constant = found.slopes[0]
    return constant if abs(constant.t) > max(CLEAR, _NEARLY * abs(best.t)) else best
