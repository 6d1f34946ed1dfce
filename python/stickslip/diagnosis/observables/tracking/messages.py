"""What a tracked run says of forces, in sentences."""

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

if TYPE_CHECKING:
    from stickslip.diagnosis.observables.tracking.film import FilmObservable

CLEAR = 3.5
"""A residual differs from zero beyond this t: of some ten looks one in 200 does by chance."""

_TORQUE = {
    "constant": "a constant torque: gain of a coil, ambient field, or a moment that is turned",
    "theta": "it goes with the tilt: strength or direction of moment and field",
    "rate": "it goes with the rate of the tilt: drag on turning, or a field that lags",
}
_FORCE = {
    "constant": "a constant bias: tilt of the surface, ambient gradient, or friction that differs",
    "theta": "it goes with the tilt of the body: adhesion or drag that depends on the angle",
    "rate": "it goes with the rate of the tilt: the normal force is other than thought",
    "contact velocity": "it goes with the contact's velocity: drag, viscous or Stribeck friction",
}


def advance_lines(advance: Mapping[str, float] | None) -> list[str]:
    """A sentence on the way of a pulse, if the film shows it."""
    if advance is None:
        return []
    way = {name: value * 1e6 for name, value in advance.items()}
    extended = f", with the cause by {way['extended']:.5g} um" if "extended" in way else ""
    return [
        f"A pulse moves the robot by {way['measured']:.5g} ± {way['sd']:.1g} um, the recalibrated "
        f"model by {way['recalibrated']:.5g} um{extended}."
    ]


def view_lines(view: ForceView, after: ForceView | None) -> list[str]:
    """Sentences on one run."""
    lines = []
    if view.orders < FEWEST_ORDERS:
        lines.append(
            f"The film shows {view.distinct} different phases of the drive, enough for "
            f"{view.orders} of its harmonics; rates and forces need {FEWEST_ORDERS}, so none are "
            "given. More frames a second, or a rate that is no simple multiple of the drive's, "
            "would show more."
        )
    else:
        lines.append(_torque_line(view.sticking))
        lines.append(_force_line(view.slipping))
        if view.onset is not None:
            measured, sd, model = view.onset
            said = "none that can be seen" if abs(measured - model) < CLEAR * sd else "a clear one"
            lines.append(
                "Just before the contact begins to slip, friction over normal force differs from "
                f"that of the recalibrated model, smoothed alike, by {measured - model:+.2g} ± "
                f"{sd:.1g}: {said}."
            )
    lines.append(_drift_line(view))
    if after is not None and view.slipping is not None and after.slipping is not None:
        before, now = view.slipping.slopes[0], after.slipping.slopes[0]
        if abs(before.t) > CLEAR or abs(now.t) > CLEAR:
            lines.append(
                f"With the cause the mean force residual goes from t = {before.t:.1f} to "
                f"{now.t:.1f}."
            )
    return lines


def field_chain_clean(view: ForceView) -> bool:
    """Whether the torque while sticking leaves nothing for currents, field and moment to explain.

    False too where it cannot be judged.
    """
    return view.sticking is not None and all(abs(s.t) < CLEAR for s in view.sticking.slopes)


def _torque_line(found: Residual | None) -> str:
    if found is None:
        return "The contact never sticks for long enough to judge the torque about it."
    worst = _worst(found)
    if worst is None:
        bound = 2.0 * found.slopes[0].sd
        return (
            "Torque residual while sticking is consistent with zero, "
            f"{_signed(found.slopes[0], 'N m')}: within {bound / found.scale:.1%} of the field's "
            "largest torque the chain of currents, field and moment is clean."
        )
    return f"Torque residual while sticking is {_said(worst, 'N m')}: {_TORQUE[worst.variable]}."


def _force_line(found: Residual | None) -> str:
    if found is None:
        return "The contact never slips for long enough to judge the force along the surface."
    worst = _worst(found)
    if worst is None:
        return (
            "Force residual while slipping is consistent with zero, "
            f"{_signed(found.slopes[0], 'N')} ({2 * found.slopes[0].sd / found.scale:.1%} of "
            "weight and adhesion could hide)."
        )
    return f"Force residual while slipping is {_said(worst, 'N')}: {_FORCE[worst.variable]}."


def _drift_line(view: ForceView) -> str:
    theta, advance = view.drift_theta, view.drift_advance
    parts = []
    for (value, sd), what, unit in (
        (theta, "the tilt changes", "rad"),
        (advance, "the advance changes", "m"),
    ):
        if abs(value) > CLEAR * sd:
            parts.append(f"{what} by {value:.2g} ± {sd:.1g} {unit} each period")
    if not parts:
        return "From period to period nothing drifts that does not drift in the simulation."
    return "Beyond the simulation's own drift, " + " and ".join(parts) + "."


def direction_lines(
    one: FilmObservable, other: FilmObservable
) -> tuple[list[str], dict[str, object]]:
    """Sentences and numbers on two runs that differ in their direction alone."""
    forward, reverse = one.advance, other.advance
    if forward is None or reverse is None:
        return ["One of the two films is too short to show the advance of a pulse."], {}
    total, sd = forward[0] + reverse[0], math.hypot(forward[1], reverse[1])
    t = total / sd
    lines = [
        f"The advances of a pulse, {forward[0]:.4g} m and {reverse[0]:.4g} m, "
        + (
            "are equal and opposite within their errors."
            if abs(t) < CLEAR
            else f"do not cancel: {total:.2g} m is left (t = {t:.1f}), so something is fixed to "
            "the world: tilt, an ambient field, or the surface."
        )
    ]
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
        lines.append(
            f"Of the force residuals while slipping, {even:.2g} ± {error:.1g} N is fixed to the "
            f"world (along +x) and {odd:.2g} ± {error:.1g} N turns with the robot."
        )
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


def _signed(slope: Slope, unit: str) -> str:
    return f"{slope.value:+.2g} ± {slope.sd:.1g} {unit}"


def _said(slope: Slope, unit: str) -> str:
    if slope.variable == "constant":
        return f"{slope.value:+.2g} {unit} in the mean (t = {slope.t:.1f})"
    return (
        f"{slope.value:+.2g} {unit} for one standard deviation of the {slope.variable} "
        f"(t = {slope.t:.1f})"
    )
