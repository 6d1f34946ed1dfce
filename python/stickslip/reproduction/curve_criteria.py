"""The paper's statements on velocities, S5 to S13, as criteria.

Velocities are the medians over small changes of frequency, friction and field: near 100 Hz a curve
is jagged, and one point of it says little. The paper gives no thresholds: those here are choices of
this study, which the table of statements names.
"""

from __future__ import annotations

import numpy as np

from stickslip.reproduction.fits import Line, bend, crossing, proportional, ratio, straight
from stickslip.reproduction.outcome import Outcome, mode_by_mode, of_both, of_each, of_ipp, of_opp
from stickslip.reproduction.points import Array
from stickslip.reproduction.scans import SCANS
from stickslip.reproduction.settings import MODES, Mode
from stickslip.reproduction.survey import Survey

MIN_R_SQUARED = 0.95
"""Part of the variance that a line must explain to count as linear."""
LOW_FREQUENCY_END = 30.0
"""Up to here a frequency counts as low, Hz."""
MAX_DIFFERENCE = 0.3
"""Greatest mean difference of two velocities that count as similar, relative to their mean."""
MAX_CHANGE = 0.1
"""Greatest relative change of what counts as level."""
MAX_SUPPRESSED = 0.02
"""Greatest velocity that counts as suppressed motion, relative to that without damping."""

# What the statements S7 to S10 call little and much, as values of the scans.
LOW_FRICTION = (0.02, 0.05, 0.1)
MIDDLE_FRICTION = (0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)
HIGH_FRICTION = (1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4)
LOW_ADHESION = (0.0, 0.05e-6)  # N
HIGH_ADHESION = (0.4e-6, 0.5e-6, 0.6e-6)  # N


def _frequency_fit(found: Survey, mode: Mode) -> tuple[Line, Array]:
    """Fit to 30 Hz, and the velocity over its line at all frequencies, shape (n, frequencies)."""
    x = np.array(SCANS["frequency"].values)
    y = found.velocity[mode, "frequency"]
    fit = proportional(x[x <= LOW_FREQUENCY_END], y[:, x <= LOW_FREQUENCY_END])
    return fit, ratio(y, fit.slope[:, np.newaxis] * x)


def linear_in_frequency(found: Survey) -> Outcome:
    """S5: velocity is proportional to a low frequency."""
    fits = {mode: _frequency_fit(found, mode)[0] for mode in MODES}

    def numbers(mode: Mode, k: int) -> str:
        fit = fits[mode]
        return (
            f"{mode} {fit.slope[k] * 1e6:.1f} µm a pulse to 30 Hz, R² {fit.explained[k]:.3f}, "
            f"departures to {fit.worst[k]:.0%}"
        )

    parts = of_each({mode: fit.explained >= MIN_R_SQUARED for mode, fit in fits.items()})
    return Outcome(parts, mode_by_mode(numbers))


def roll_off(found: Survey) -> Outcome:
    """S6: at 100 Hz and above velocity is less than the low frequencies' line."""
    places = [SCANS["frequency"].values.index(each) for each in (100.0, 120.0, 150.0)]
    left = {mode: _frequency_fit(found, mode)[1][:, places] for mode in MODES}
    ipp, opp = left["IPP"], left["OPP"]

    def numbers(i: int, j: int) -> str:
        return (
            f"velocity over that line at 100 and 150 Hz: IPP {ipp[i, 0]:.2f} and "
            f"{ipp[i, -1]:.2f}, OPP {opp[j, 0]:.2f} and {opp[j, -1]:.2f}"
        )

    parts = of_each({mode: np.all(each < 1.0 - MAX_CHANGE, axis=1) for mode, each in left.items()})
    return Outcome(parts, numbers)


def _means(found: Survey, scan: str, values: tuple[float, ...]) -> tuple[Array, Array]:
    """Mean velocity over some values of a scan: IPP as a column, OPP as a row."""
    ipp, opp = (found.at(mode, scan, values).mean(axis=1) for mode in MODES)
    return ipp[:, np.newaxis], opp[np.newaxis, :]


def _speeds(ipp: float, opp: float) -> str:
    return f"IPP {ipp * 1e3:.2f} mm/s, OPP {opp * 1e3:.2f} mm/s"


def low_friction(found: Survey) -> Outcome:
    """S7: with static friction 0.02 to 0.1, OPP is faster."""
    ipp, opp = _means(found, "friction", LOW_FRICTION)
    return Outcome(
        {"OPP faster": opp > ipp},
        lambda i, j: f"mean for static friction 0.02 to 0.1: {_speeds(ipp[i, 0], opp[0, j])}",
    )


def middle_friction(found: Survey) -> Outcome:
    """S8: with static friction 0.2 to 1.0 the two modes are about as fast."""
    ipp, opp = (found.at(mode, "friction", MIDDLE_FRICTION) for mode in MODES)
    ipp, opp = ipp[:, np.newaxis], opp[np.newaxis]
    mean = 0.5 * (np.abs(ipp) + np.abs(opp)).mean(axis=-1)
    apart = ratio(np.abs(opp - ipp).mean(axis=-1), mean)

    def numbers(i: int, j: int) -> str:
        return (
            f"mean for static friction 0.2 to 1.0: {_speeds(ipp[i].mean(), opp[0, j].mean())}; "
            f"mean difference {apart[i, j]:.0%}"
        )

    return Outcome({"similar": apart <= MAX_DIFFERENCE}, numbers)


def high_friction(found: Survey) -> Outcome:
    """S9: with static friction above 1, IPP is faster."""
    ipp, opp = _means(found, "friction", HIGH_FRICTION)
    return Outcome(
        {"IPP faster": ipp > opp},
        lambda i, j: f"mean for static friction 1.2 to 2.4: {_speeds(ipp[i, 0], opp[0, j])}",
    )


def adhesion(found: Survey) -> Outcome:
    """S10: OPP is faster with little adhesion, and loses more of its velocity to much."""
    ipp, opp = _means(found, "adhesion", LOW_ADHESION)
    ipp_high, opp_high = _means(found, "adhesion", HIGH_ADHESION)
    ipp_left, opp_left = ratio(ipp_high, ipp), ratio(opp_high, opp)

    def numbers(i: int, j: int) -> str:
        return (
            f"mean for 0 to 0.05 µN: {_speeds(ipp[i, 0], opp[0, j])}; left of it at 0.4 to "
            f"0.6 µN: IPP {ipp_left[i, 0]:.0%}, OPP {opp_left[0, j]:.0%}"
        )

    parts = {"OPP faster at low adhesion": opp > ipp, "OPP loses more": opp_left < ipp_left}
    return Outcome(parts, numbers)


def _over_first(found: Survey, scan: str) -> dict[Mode, Array]:
    """Velocity over that at the scan's first value, by mode."""
    curves = {mode: found.velocity[mode, scan] for mode in MODES}
    return {mode: ratio(y, y[:, :1]) for mode, y in curves.items()}


def linear_damping(found: Survey) -> Outcome:
    """S11: velocity falls with linear damping, from a level to nothing, in both modes."""
    x = np.array(SCANS["linear"].values)
    left = _over_first(found, "linear")

    def numbers(mode: Mode, k: int) -> str:
        y = left[mode][k]
        return (
            f"{mode} falls to 90% at {crossing(x, y, 0.9):.1g} N s/m, to 10% at "
            f"{crossing(x, y, 0.1):.1g} N s/m"
        )

    curves = left.items()
    level = {
        mode: np.all(np.abs(y[:, x <= 1e-6] - 1.0) <= MAX_CHANGE, axis=1) for mode, y in curves
    }
    falls = {mode: np.all(np.diff(y, axis=1) <= MAX_CHANGE, axis=1) for mode, y in curves}
    frozen = {mode: np.abs(y[:, -1]) <= MAX_SUPPRESSED for mode, y in curves}
    parts = {
        "level to 1e-6 N s/m": of_both(level),
        "slower with more damping": of_both(falls),
        "frozen at 1e-2 N s/m": of_both(frozen),
    }
    return Outcome(parts, mode_by_mode(numbers))


def rotational_damping(found: Survey) -> Outcome:
    """S12: rotational damping matters little when low; then both modes lose alike."""
    x = np.array(SCANS["rotational"].values)
    left = _over_first(found, "rotational")
    ipp, opp = left["IPP"], left["OPP"]
    high = x >= 1e-15
    apart = np.abs(ipp[:, np.newaxis, high] - opp[np.newaxis, :, high]).mean(axis=-1)

    def numbers(i: int, j: int) -> str:
        return (
            f"left at 1e-13 N m s²: IPP {ipp[i, -1]:.0%}, OPP {opp[j, -1]:.0%}; from 1e-15 up "
            f"the modes differ by {apart[i, j]:.0%} of their velocity without it"
        )

    curves = left.items()
    level = {
        mode: np.all(np.abs(y[:, x <= 3e-17] - 1.0) <= MAX_CHANGE, axis=1) for mode, y in curves
    }
    parts = {
        "little effect to 3e-17 N m s²": of_both(level),
        "slower at 1e-13": of_both({mode: y[:, -1] < 1.0 - MAX_CHANGE for mode, y in curves}),
        "modes lose alike": apart <= 0.5 * MAX_DIFFERENCE,
    }
    return Outcome(parts, numbers)


def growth_with_field(found: Survey) -> Outcome:
    """S13: velocity grows about linearly with the field in both modes, in IPP with roll-off."""
    x = np.array(SCANS["field"].values)
    fits = {mode: straight(x, found.velocity[mode, "field"]) for mode in MODES}
    bends = {mode: bend(x, found.velocity[mode, "field"]) for mode in MODES}

    def numbers(mode: Mode, k: int) -> str:
        fit = fits[mode]
        return (
            f"{mode} {fit.slope[k]:.2f} (mm/s)/mT, R² {fit.explained[k]:.3f}, slope of the upper "
            f"half over that of the lower {bends[mode][k]:.2f}"
        )

    linear = {
        mode: (fit.slope > 0.0) & (fit.explained >= MIN_R_SQUARED) for mode, fit in fits.items()
    }
    parts = {
        "IPP linear": of_ipp(linear["IPP"]),
        "IPP rolls off": of_ipp(bends["IPP"] < 1.0 - MAX_CHANGE),
        "OPP linear": of_opp(linear["OPP"]),
    }
    return Outcome(parts, mode_by_mode(numbers))
