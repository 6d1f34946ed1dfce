"""What a tracked run says of forces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from stickslip.diagnosis.observables.tracking.force_residuals import (
    FEWEST_ORDERS,
    ForceView,
    Residual,
    Slope,
)
from stickslip.facts import Code, Fact

if TYPE_CHECKING:
    from stickslip.diagnosis.observables.tracking.film import FilmObservable

CLEAR = 3.5
"""A residual differs from zero beyond this t: of some ten looks one in 200 does by chance."""


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


def field_chain_clean(view: ForceView) -> bool:
    """Whether the torque while sticking leaves nothing for currents, field and moment to explain.

    False too where it cannot be judged.
    """
    return view.sticking is not None and all(abs(s.t) < CLEAR for s in view.sticking.slopes)


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


def direction_lines(
    one: FilmObservable, other: FilmObservable
) -> tuple[list[Fact], dict[str, object]]:
    """Facts and numbers on two runs that differ in their direction alone."""
    forward, reverse = one.advance, other.advance
    if forward is None or reverse is None:
        return [Fact(Code.DIRECTIONS_TOO_SHORT, {})], {}
    total, sd = forward[0] + reverse[0], math.hypot(forward[1], reverse[1])
    t = total / sd
    code = Code.DIRECTIONS_CANCEL if abs(t) < CLEAR else Code.DIRECTIONS_DIFFER
    ways = {"forward": forward[0], "reverse": reverse[0], "total": total, "t": t}
    lines = [Fact(code, ways)]
    numbers: dict[str, object] = {"advance_sum": total, "advance_sum_sd": sd}
    views = (one.last_view, other.last_view)
    if all(view is not None and view.slipping is not None for view in views):
        parts = []
        for observable, view in ((one, views[0]), (other, views[1])):
            assert view is not None
            assert view.slipping is not None
            sign = -1.0 if observable.run.scenario.drive.direction == "-x" else 1.0
            mean = view.slipping.slopes[0]
            parts.append((sign, mean.value, mean.sd))
        even = 0.5 * sum(sign * value for sign, value, _ in parts)
        odd = 0.5 * sum(value for _, value, _ in parts)
        error = 0.5 * math.hypot(parts[0][2], parts[1][2])
        forces = {"world": even, "robot": odd, "sd": error}
        lines.append(Fact(Code.FORCES_OF_DIRECTIONS, forces))
        numbers |= {"force_world": even, "force_robot": odd, "force_sd": error}
    return lines, numbers


def _worst(found: Residual) -> Slope | None:
    """The clearest departure from zero; a constant, if it is nearly as clear as any."""
    clear = [each for each in found.slopes if abs(each.t) > CLEAR]
    if not clear:
        return None
    best = max(clear, key=lambda each: abs(each.t))
    constant = found.slopes[0]
    return constant if abs(constant.t) > max(CLEAR, 0.7 * abs(best.t)) else best
