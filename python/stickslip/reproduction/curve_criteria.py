"""The paper's statements on velocities, S5 to S13.

Velocities are the medians over small changes of frequency, friction and field: near 100 Hz a curve
is jagged, and one point of it says little. The paper gives no thresholds: those here are choices of
this study, which the table of statements names.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stickslip.reproduction.criteria import Outcome, above, by_mode, criterion, if_also
from stickslip.reproduction.points import SCANS, Array
from stickslip.reproduction.settings import MODES, Mode
from stickslip.reproduction.survey import Survey, pairwise

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

_SPEEDS = "IPP {ipp:.2f} mm/s, OPP {opp:.2f} mm/s"


class Line(NamedTuple):
    """Least-squares lines, one for each curve; arrays have no axis for a curve's values."""

    slope: Array
    explained: Array  # part of the variance that the line explains, R^2
    worst: Array  # greatest departure from the line, relative to it


def ratio(above: Array, below: Array) -> Array:
    """A quotient of velocities, of which some can be zero."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(above / below)


def proportional(x: Array, y: Array) -> Line:
    """Fit y = slope x to each curve of `y`, shape (..., len(x))."""
    slope = (y * x).sum(axis=-1) / (x**2).sum()
    return _line(y, slope[..., np.newaxis] * x, slope)


def straight(x: Array, y: Array) -> Line:
    """Fit y = slope x + constant to each curve of `y`, shape (..., len(x))."""
    centred = x - x.mean()
    slope = (y * centred).sum(axis=-1) / (centred**2).sum()
    return _line(y, y.mean(axis=-1, keepdims=True) + slope[..., np.newaxis] * centred, slope)


def _line(y: Array, line: Array, slope: Array) -> Line:
    spread = ((y - y.mean(axis=-1, keepdims=True)) ** 2).sum(axis=-1)
    explained = 1.0 - ratio(((y - line) ** 2).sum(axis=-1), spread)
    return Line(slope, explained, np.abs(ratio(y, line) - 1.0).max(axis=-1))


def bend(x: Array, y: Array) -> Array:
    """Slope of the upper half over that of the lower, for each curve of `y`; below 1: roll-off."""
    middle = len(x) // 2
    upper = straight(x[middle:], y[..., middle:]).slope
    return ratio(upper, straight(x[: middle + 1], y[..., : middle + 1]).slope)


def crossing(y: Array, x: Array, level: float) -> float:
    """Where a falling curve first meets a level, between points in log x; NaN if it never does."""
    below = np.flatnonzero(y < level)
    if len(below) == 0 or below[0] == 0:
        return math.nan
    k = int(below[0])
    part = ratio(y[k - 1] - level, y[k - 1] - y[k])
    return float(x[k - 1] * (x[k] / x[k - 1]) ** part)


def _curves(found: Survey, mode: Mode, scan: str) -> tuple[Array, Array]:
    """A scan's values, SI, and the velocities there, m/s, pairwise with the values last."""
    return np.array(SCANS[scan].values), pairwise(mode, found.velocity[mode, scan])


def _means(found: Survey, scan: str, values: tuple[float, ...]) -> list[Array]:
    """Mean velocity over some values of a scan, m/s: IPP, then OPP."""
    return [pairwise(mode, found.at(mode, scan, values).mean(axis=1)) for mode in MODES]


def _frequency_fit(found: Survey, mode: Mode) -> tuple[Line, Array]:
    """Fit to 30 Hz, and the velocity over its line at all frequencies."""
    x, y = _curves(found, mode, "frequency")
    low = x <= LOW_FREQUENCY_END
    fit = proportional(x[low], y[..., low])
    return fit, ratio(y, fit.slope[..., np.newaxis] * x)


@criterion(
    "S5",
    "Velocity is proportional to a low frequency.",
    f"R² of a line through the origin to {LOW_FREQUENCY_END:g} Hz at least {MIN_R_SQUARED:g}",
    by_mode(
        "MODE {MODE_slope:.1f} µm a pulse to 30 Hz, R² {MODE_explained:.3f}, departures to "
        "{MODE_worst:.0%}"
    ),
)
def linear_in_frequency(found: Survey) -> Outcome:
    fits = {mode: _frequency_fit(found, mode)[0] for mode in MODES}
    values = {}
    for mode, fit in fits.items():
        values[f"{mode}_slope"] = fit.slope * 1e6
        values[f"{mode}_explained"] = fit.explained
        values[f"{mode}_worst"] = fit.worst
    return Outcome({mode: fit.explained - MIN_R_SQUARED for mode, fit in fits.items()}, values)


@criterion(
    "S6",
    "Velocity rolls off at high frequency.",
    f"{MAX_CHANGE:.0%} or more below that line at 100, 120 and 150 Hz",
    "velocity over that line at 100 and 150 Hz: IPP {IPP_100:.2f} and {IPP_150:.2f}, OPP "
    "{OPP_100:.2f} and {OPP_150:.2f}",
)
def roll_off(found: Survey) -> Outcome:
    places = [SCANS["frequency"].values.index(each) for each in (100.0, 120.0, 150.0)]
    left = {mode: _frequency_fit(found, mode)[1][..., places] for mode in MODES}
    return Outcome(
        {mode: 1.0 - MAX_CHANGE - each.max(axis=-1) for mode, each in left.items()},
        {f"{mode}_100": each[..., 0] for mode, each in left.items()}
        | {f"{mode}_150": each[..., -1] for mode, each in left.items()},
    )


@criterion(
    "S7",
    "With little friction OPP is faster.",
    "means for static friction 0.02, 0.05 and 0.1",
    f"mean for static friction 0.02 to 0.1: {_SPEEDS}",
)
def low_friction(found: Survey) -> Outcome:
    ipp, opp = _means(found, "friction", LOW_FRICTION)
    return Outcome({"OPP faster": above(opp, ipp)}, {"ipp": ipp * 1e3, "opp": opp * 1e3})


@criterion(
    "S8",
    "With static friction from 0.2 to 1.0 both modes are about as fast.",
    f"mean difference at most {MAX_DIFFERENCE:.0%} of the mean velocity",
    f"mean for static friction 0.2 to 1.0: {_SPEEDS}; mean difference {{apart:.0%}}",
)
def middle_friction(found: Survey) -> Outcome:
    ipp, opp = (pairwise(mode, found.at(mode, "friction", MIDDLE_FRICTION)) for mode in MODES)
    mean = 0.5 * (np.abs(ipp) + np.abs(opp)).mean(axis=-1)
    apart = ratio(np.abs(opp - ipp).mean(axis=-1), mean)
    speeds = {"ipp": ipp.mean(axis=-1) * 1e3, "opp": opp.mean(axis=-1) * 1e3}
    return Outcome({"similar": MAX_DIFFERENCE - apart}, {**speeds, "apart": apart})


@criterion(
    "S9",
    "With static friction above 1 IPP is faster.",
    "means for static friction 1.2 to 2.4",
    f"mean for static friction 1.2 to 2.4: {_SPEEDS}",
)
def high_friction(found: Survey) -> Outcome:
    ipp, opp = _means(found, "friction", HIGH_FRICTION)
    return Outcome({"IPP faster": above(ipp, opp)}, {"ipp": ipp * 1e3, "opp": opp * 1e3})


@criterion(
    "S10",
    "With little adhesion OPP is faster, and more adhesion costs it more.",
    "means to 0.05 µN, and what is left of them at 0.4 to 0.6 µN",
    f"mean for 0 to 0.05 µN: {_SPEEDS}; left of it at 0.4 to 0.6 µN: IPP {{ipp_left:.0%}}, OPP "
    "{opp_left:.0%}",
)
def adhesion(found: Survey) -> Outcome:
    ipp, opp = _means(found, "adhesion", LOW_ADHESION)
    ipp_high, opp_high = _means(found, "adhesion", HIGH_ADHESION)
    left = {"ipp_left": ratio(ipp_high, ipp), "opp_left": ratio(opp_high, opp)}
    return Outcome(
        {
            "OPP faster at low adhesion": above(opp, ipp),
            "OPP loses more": left["ipp_left"] - left["opp_left"],
        },
        {"ipp": ipp * 1e3, "opp": opp * 1e3, **left},
    )


def _over_first(found: Survey, scan: str) -> tuple[Array, Array, Array]:
    """A scan's values, and the velocity over that at the first of them: IPP, then OPP."""
    x, ipp = _curves(found, "IPP", scan)
    _, opp = _curves(found, "OPP", scan)
    return x, ratio(ipp, ipp[..., :1]), ratio(opp, opp[..., :1])


def _level(*left: Array) -> Array:
    """The margin of both modes staying at their first value."""
    ipp, opp = (np.abs(each - 1.0).max(axis=-1) for each in left)
    return np.asarray(MAX_CHANGE - np.maximum(ipp, opp))


@criterion(
    "S11",
    "Linear damping slows both modes, between a range where it matters little and one where "
    "nothing moves.",
    f"within {MAX_CHANGE:.0%} to 1e-6 N s/m, never rising by more than that, below "
    f"{MAX_SUPPRESSED:.0%} at 1e-2 N s/m",
    by_mode("MODE falls to 90% at {MODE_90:.1g} N s/m, to 10% at {MODE_10:.1g} N s/m"),
)
def linear_damping(found: Survey) -> Outcome:
    x, ipp, opp = _over_first(found, "linear")
    low = x <= 1e-6
    rises = [np.diff(left, axis=-1).max(axis=-1) for left in (ipp, opp)]
    frozen = [np.abs(left[..., -1]) for left in (ipp, opp)]
    margins = {
        "level to 1e-6 N s/m": _level(ipp[..., low], opp[..., low]),
        "slower with more damping": MAX_CHANGE - np.maximum(*rises),
        "frozen at 1e-2 N s/m": MAX_SUPPRESSED - np.maximum(*frozen),
    }
    values = {
        f"{mode}_{percent}": np.apply_along_axis(crossing, -1, left, x, percent / 100)
        for mode, left in (("IPP", ipp), ("OPP", opp))
        for percent in (90, 10)
    }
    return Outcome(margins, values)


@criterion(
    "S12",
    "Rotational damping matters little when low; then both modes lose alike.",
    f"within {MAX_CHANGE:.0%} to 3e-17 N m s², slower at 1e-13, and from 1e-15 on the part left of "
    f"the velocity equal within {0.5 * MAX_DIFFERENCE:.0%}",
    "left at 1e-13 N m s²: IPP {ipp:.0%}, OPP {opp:.0%}; from 1e-15 up the modes differ by "
    "{apart:.0%} of their velocity without it",
)
def rotational_damping(found: Survey) -> Outcome:
    x, ipp, opp = _over_first(found, "rotational")
    low, high = x <= 3e-17, x >= 1e-15
    apart = np.abs(ipp[..., high] - opp[..., high]).mean(axis=-1)
    margins = {
        "little effect to 3e-17 N m s²": _level(ipp[..., low], opp[..., low]),
        "slower at 1e-13": 1.0 - MAX_CHANGE - np.maximum(ipp[..., -1], opp[..., -1]),
        "modes lose alike": 0.5 * MAX_DIFFERENCE - apart,
    }
    return Outcome(margins, {"ipp": ipp[..., -1], "opp": opp[..., -1], "apart": apart})


@criterion(
    "S13",
    "Velocity grows about linearly with the field, in IPP with some roll-off.",
    f"R² of a line at least {MIN_R_SQUARED:g} from 1.5 to 6.5 mT at 30 Hz, rising; in IPP the "
    f"upper half less steep by {MAX_CHANGE:.0%} or more",
    by_mode(
        "MODE {MODE_slope:.2f} (mm/s)/mT, R² {MODE_explained:.3f}, slope of the upper half over "
        "that of the lower {MODE_bend:.2f}"
    ),
)
def growth_with_field(found: Survey) -> Outcome:
    linear, values = {}, {}
    for mode in MODES:
        x, y = _curves(found, mode, "field")
        fit = straight(x, y)
        linear[mode] = if_also(fit.explained - MIN_R_SQUARED, fit.slope > 0.0)
        values[f"{mode}_slope"] = fit.slope
        values[f"{mode}_explained"] = fit.explained
        values[f"{mode}_bend"] = bend(x, y)
    margins = {
        "IPP linear": linear["IPP"],
        "IPP rolls off": 1.0 - MAX_CHANGE - values["IPP_bend"],
        "OPP linear": linear["OPP"],
    }
    return Outcome(margins, values)
