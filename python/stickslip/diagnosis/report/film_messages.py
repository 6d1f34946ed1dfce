"""What a tracked run says of forces, in sentences."""

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

_NEARLY = 0.7
"""Of the clearest t: a constant that has as much is named instead, as it is simpler. Chosen."""

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


def direction_lines(found: Directions | None) -> list[str]:
    """Sentences on two runs that differ in their direction alone."""
    if found is None:
        return ["One of the two films is too short to show the advance of a pulse."]
    t = found.total / found.sd
    lines = [
        f"The advances of a pulse, {found.forward:.4g} m and {found.reverse:.4g} m, "
        + (
            "are equal and opposite within their errors."
            if abs(t) < CLEAR
            else f"do not cancel: {found.total:.2g} m is left (t = {t:.1f}), so something is fixed "
            "to the world: tilt, an ambient field, or the surface."
        )
    ]
    if found.world is not None:
        lines.append(
            f"Of the force residuals while slipping, {found.world:.2g} ± {found.force_sd:.1g} N is "
            f"fixed to the world (along +x) and {found.robot:.2g} ± {found.force_sd:.1g} N turns "
            "with the robot."
        )
    return lines


def _worst(found: Residual) -> Slope | None:
    """The clearest departure from zero; a constant, if it is nearly as clear as any."""
    clear = [each for each in found.slopes if abs(each.t) > CLEAR]
    if not clear:
        return None
    best = max(clear, key=lambda each: abs(each.t))
    constant = found.slopes[0]
    return constant if abs(constant.t) > max(CLEAR, _NEARLY * abs(best.t)) else best


def _signed(slope: Slope, unit: str) -> str:
    return f"{slope.value:+.2g} ± {slope.sd:.1g} {unit}"


def _said(slope: Slope, unit: str) -> str:
    if slope.variable == "constant":
        return f"{slope.value:+.2g} {unit} in the mean (t = {slope.t:.1f})"
    return (
        f"{slope.value:+.2g} {unit} for one standard deviation of the {slope.variable} "
        f"(t = {slope.t:.1f})"
    )
