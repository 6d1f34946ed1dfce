"""The paper's statements that depend on settings, S1 to S14, as criteria on the survey.

All angles are magnitudes: the upstroke is where |theta| rises, whatever the clamp coil's sign.
Velocities are the medians over small changes of frequency, friction and field: near 100 Hz a curve
is jagged, and one point of it says little. The paper gives no thresholds: those here are choices of
this study, which the table of statements names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.reproduction.lines import Line, bend, crossing, proportional, ratio, straight
from stickslip.reproduction.points import SCANS, Array
from stickslip.reproduction.settings import MODES
from stickslip.reproduction.survey import Behaviour

SLIP_SHARE = 0.8
"""Part of the slip's path that counts as "slips on this stroke"."""
MUCH_LARGER = 1.25
"""Least ratio of two angles of which one is "much larger"."""
MIN_SPEED = 1e-6
"""Least speed that counts as motion, m/s."""
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

# What the statements S6 to S10 call little and much: some values of a scan.
Part = tuple[str, tuple[float, ...]]
HIGH_FREQUENCY: Part = ("frequency", (100.0, 120.0, 150.0))  # Hz
LOW_FRICTION: Part = ("friction", (0.02, 0.05, 0.1))
MIDDLE_FRICTION: Part = ("friction", (0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0))
HIGH_FRICTION: Part = ("friction", (1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4))
LOW_ADHESION: Part = ("adhesion", (0.0, 0.05e-6))  # N
HIGH_ADHESION: Part = ("adhesion", (0.4e-6, 0.5e-6, 0.6e-6))  # N

_X = {name: np.array(scan.values) for name, scan in SCANS.items()}
WORST = -1e3  # the least margin, also of what is NaN; chosen: farther off than any that counts

IPP, OPP = 0, 1  # places of the modes along the first axis of `paired` behaviours


@dataclass(frozen=True)
class Criterion:
    """A statement of the paper, and how it is tested with the behaviours of a pair or of many.

    A margin is a pure number, from zero where a part of the statement holds, and below zero where
    it does not; or NaN, where it does not either.
    """

    name: str  # "S1" to "S14"
    text: str  # the statement, in other words than the paper's
    condition: str  # what counts as such
    margins: Callable[[Behaviour], Mapping[str, Array]]  # of its parts by name, for every pair
    numbers: Callable[[Behaviour], str]  # of one pair, in words


def above(value: Any, limit: Any) -> Any:
    """The margin of a value that is to be above a limit: their difference over their sum."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return (value - limit) / (np.abs(value) + np.abs(limit))


def if_also(margin: Any, condition: Any) -> Any:
    """A margin where a condition is met, and -1 at most where it is not."""
    return np.minimum(margin, np.where(condition, np.inf, -1.0))


def _by_mode(margins: Array) -> dict[str, Array]:
    return dict(zip(MODES, margins, strict=True))


def _of_both(words: str, *numbers: Iterable[float]) -> str:
    """A format string that says the same of both modes, each with its own numbers."""
    by_mode = zip(MODES, *numbers, strict=True)
    return "; ".join(f"{mode} {words.format(*own)}" for mode, *own in by_mode)


def _much_larger_in_ipp(angle: Array) -> Any:
    return above(angle[IPP], MUCH_LARGER * angle[OPP])


def _mean(pair: Behaviour, part: Part) -> Array:
    """Mean velocity of each mode, m/s."""
    return np.asarray(pair.velocity(*part).mean(axis=-1))


def _speeds(pair: Behaviour, part: Part) -> str:
    return "IPP {:.2f} mm/s, OPP {:.2f} mm/s".format(*_mean(pair, part) * 1e3)


def _low_line(pair: Behaviour) -> Line:
    """Velocity over low frequencies."""
    low = _X["frequency"] <= LOW_FREQUENCY_END
    return proportional(_X["frequency"][low], pair.frequency[..., low])


def _low_line_words(pair: Behaviour) -> str:
    slope, explained, worst = _low_line(pair)
    words = "{:.1f} µm a pulse to 30 Hz, R² {:.3f}, departures to {:.0%}"
    return _of_both(words, slope * 1e6, explained, worst)


def _over_line(pair: Behaviour) -> Array:
    """Velocity at high frequencies over the line of the low ones."""
    line = _low_line(pair).slope[..., np.newaxis] * np.array(HIGH_FREQUENCY[1])
    return ratio(pair.velocity(*HIGH_FREQUENCY), line)


def _apart(pair: Behaviour) -> Array:
    """Mean difference of the modes with middle friction, over their mean."""
    ipp, opp = pair.velocity(*MIDDLE_FRICTION)
    mean = 0.5 * (np.abs(ipp) + np.abs(opp)).mean(axis=-1)
    return ratio(np.abs(opp - ipp).mean(axis=-1), mean)


def _left_with_adhesion(pair: Behaviour) -> Array:
    return ratio(_mean(pair, HIGH_ADHESION), _mean(pair, LOW_ADHESION))


def _over_first(curves: Array) -> Array:
    """Velocity over that at the first of a scan's values."""
    return ratio(curves, curves[..., :1])


def _level(left: Array) -> Array:
    """The margin of both modes staying at their first value."""
    return np.asarray(MAX_CHANGE - np.abs(left - 1.0).max(axis=(0, -1)))


def _linear_damping(pair: Behaviour) -> dict[str, Array]:
    left = _over_first(pair.linear)
    return {
        "level to 1e-6 N s/m": _level(left[..., _X["linear"] <= 1e-6]),
        "slower with more damping": MAX_CHANGE - np.diff(left, axis=-1).max(axis=(0, -1)),
        "frozen at 1e-2 N s/m": MAX_SUPPRESSED - np.abs(left[..., -1]).max(axis=0),
    }


def _linear_damping_words(pair: Behaviour) -> str:
    left = _over_first(pair.linear)
    falls = [[crossing(each, _X["linear"], level) for each in left] for level in (0.9, 0.1)]
    return _of_both("falls to 90% at {:.1g} N s/m, to 10% at {:.1g} N s/m", *falls)


def _damped_apart(left: Array) -> Array:
    """Mean difference of the parts that much rotational damping leaves of the velocity."""
    return np.asarray(np.abs(left[IPP] - left[OPP])[..., _X["rotational"] >= 1e-15].mean(axis=-1))


def _rotational_damping(pair: Behaviour) -> dict[str, Array]:
    left = _over_first(pair.rotational)
    return {
        "little effect to 3e-17 N m s²": _level(left[..., _X["rotational"] <= 3e-17]),
        "slower at 1e-13": 1.0 - MAX_CHANGE - left[..., -1].max(axis=0),
        "modes lose alike": 0.5 * MAX_DIFFERENCE - _damped_apart(left),
    }


def _rotational_damping_words(pair: Behaviour) -> str:
    left = _over_first(pair.rotational)
    return (
        f"left at 1e-13 N m s²: IPP {left[IPP, -1]:.0%}, OPP {left[OPP, -1]:.0%}; from 1e-15 up "
        f"the modes differ by {_damped_apart(left):.0%} of their velocity without it"
    )


def _growth_with_field(pair: Behaviour) -> dict[str, Array]:
    line = straight(_X["field"], pair.field)
    linear = if_also(line.explained - MIN_R_SQUARED, line.slope > 0.0)
    return {
        "IPP linear": linear[IPP],
        "IPP rolls off": 1.0 - MAX_CHANGE - bend(_X["field"], pair.field)[IPP],
        "OPP linear": linear[OPP],
    }


def _growth_with_field_words(pair: Behaviour) -> str:
    line, bends = straight(_X["field"], pair.field), bend(_X["field"], pair.field)
    words = "{:.2f} (mm/s)/mT, R² {:.3f}, slope of the upper half over that of the lower {:.2f}"
    return _of_both(words, line.slope, line.explained, bends)


CRITERIA = (
    Criterion(
        "S1",
        "IPP slips on the downstroke.",
        f"{SLIP_SHARE:.0%} of the slip's path on the downstroke, forwards, at 30 Hz",
        lambda pair: {
            "IPP slips on the downstroke": if_also(
                1.0 - pair.share_up[IPP] - SLIP_SHARE, pair.slip_down[IPP] > 0.0
            )
        },
        lambda pair: f"{1.0 - pair.share_up[IPP]:.1%} of the slip's path is on the downstroke",
    ),
    Criterion(
        "S2",
        "OPP slips on the upstroke.",
        f"{SLIP_SHARE:.0%} of the slip's path on the upstroke, forwards, at 30 Hz",
        lambda pair: {
            "OPP slips on the upstroke": if_also(
                pair.share_up[OPP] - SLIP_SHARE, pair.slip_up[OPP] > 0.0
            )
        },
        lambda pair: f"{pair.share_up[OPP]:.1%} of the slip's path is on the upstroke",
    ),
    Criterion(
        "S3",
        "The normal force is low on IPP's downstroke and high on OPP's upstroke.",
        "mean while slipping below, or above, weight and adhesion, at 30 Hz",
        lambda pair: {
            "IPP less than at rest": above(1.0, pair.normal_down[IPP]),
            "OPP more": above(pair.normal_up[OPP], 1.0),
        },
        lambda pair: (
            "mean N while slipping, over that at rest: IPP on the downstroke "
            f"{pair.normal_down[IPP]:.2f}, OPP on the upstroke {pair.normal_up[OPP]:.2f}"
        ),
    ),
    Criterion(
        "S4",
        "The steady angle is much larger in IPP than in OPP.",
        f"{MUCH_LARGER:g} times or more, before the pulses and in the mean at 30 Hz",
        lambda pair: {
            "larger before the pulses": _much_larger_in_ipp(pair.still_tilt),
            "larger in the mean": _much_larger_in_ipp(pair.tilt),
        },
        lambda pair: (
            "IPP {:.0f}°, OPP {:.0f}° before the pulses; mean at 30 Hz IPP {:.0f}°, OPP "
            "{:.0f}°".format(*np.degrees([*pair.still_tilt, *pair.tilt]))
        ),
    ),
    Criterion(
        "S5",
        "Velocity is proportional to a low frequency.",
        f"R² of a line through the origin to {LOW_FREQUENCY_END:g} Hz at least {MIN_R_SQUARED:g}",
        lambda pair: _by_mode(_low_line(pair).explained - MIN_R_SQUARED),
        _low_line_words,
    ),
    Criterion(
        "S6",
        "Velocity rolls off at high frequency.",
        f"{MAX_CHANGE:.0%} or more below that line at 100, 120 and 150 Hz",
        lambda pair: _by_mode(1.0 - MAX_CHANGE - _over_line(pair).max(axis=-1)),
        lambda pair: (
            "velocity over that line at 100 and 150 Hz: IPP {:.2f} and {:.2f}, OPP {:.2f} and "
            "{:.2f}".format(*_over_line(pair)[:, [0, -1]].flat)
        ),
    ),
    Criterion(
        "S7",
        "With little friction OPP is faster.",
        "means for static friction 0.02, 0.05 and 0.1",
        lambda pair: {"OPP faster": above(*_mean(pair, LOW_FRICTION)[[OPP, IPP]])},
        lambda pair: f"mean for static friction 0.02 to 0.1: {_speeds(pair, LOW_FRICTION)}",
    ),
    Criterion(
        "S8",
        "With static friction from 0.2 to 1.0 both modes are about as fast.",
        f"mean difference at most {MAX_DIFFERENCE:.0%} of the mean velocity",
        lambda pair: {"similar": MAX_DIFFERENCE - _apart(pair)},
        lambda pair: (
            f"mean for static friction 0.2 to 1.0: {_speeds(pair, MIDDLE_FRICTION)}; mean "
            f"difference {_apart(pair):.0%}"
        ),
    ),
    Criterion(
        "S9",
        "With static friction above 1 IPP is faster.",
        "means for static friction 1.2 to 2.4",
        lambda pair: {"IPP faster": above(*_mean(pair, HIGH_FRICTION)[[IPP, OPP]])},
        lambda pair: f"mean for static friction 1.2 to 2.4: {_speeds(pair, HIGH_FRICTION)}",
    ),
    Criterion(
        "S10",
        "With little adhesion OPP is faster, and more adhesion costs it more.",
        "means to 0.05 µN, and what is left of them at 0.4 to 0.6 µN",
        lambda pair: {
            "OPP faster at low adhesion": above(*_mean(pair, LOW_ADHESION)[[OPP, IPP]]),
            "OPP loses more": np.subtract(*_left_with_adhesion(pair)),
        },
        lambda pair: (
            f"mean for 0 to 0.05 µN: {_speeds(pair, LOW_ADHESION)}; left of it at 0.4 to 0.6 µN: "
            "IPP {:.0%}, OPP {:.0%}".format(*_left_with_adhesion(pair))
        ),
    ),
    Criterion(
        "S11",
        "Linear damping slows both modes, between a range where it matters little and one where "
        "nothing moves.",
        f"within {MAX_CHANGE:.0%} to 1e-6 N s/m, never rising by more than that, below "
        f"{MAX_SUPPRESSED:.0%} at 1e-2 N s/m",
        _linear_damping,
        _linear_damping_words,
    ),
    Criterion(
        "S12",
        "Rotational damping matters little when low; then both modes lose alike.",
        f"within {MAX_CHANGE:.0%} to 3e-17 N m s², slower at 1e-13, and from 1e-15 on the part "
        f"left of the velocity equal within {0.5 * MAX_DIFFERENCE:.0%}",
        _rotational_damping,
        _rotational_damping_words,
    ),
    Criterion(
        "S13",
        "Velocity grows about linearly with the field, in IPP with some roll-off.",
        f"R² of a line at least {MIN_R_SQUARED:g} from 1.5 to 6.5 mT at 30 Hz, rising; in IPP the "
        f"upper half less steep by {MAX_CHANGE:.0%} or more",
        _growth_with_field,
        _growth_with_field_words,
    ),
    Criterion(
        "S14",
        "Constant fields move nothing.",
        f"mean speed below {MIN_SPEED * 1e6:g} µm/s for a second, at the sawtooth's bottom and at "
        "its top",
        lambda pair: _by_mode(1.0 - pair.still_velocity / MIN_SPEED),
        lambda pair: "greatest mean speed: IPP {:.1g} nm/s, OPP {:.1g} nm/s".format(
            *pair.still_velocity * 1e9
        ),
    ),
)
"""The statements that depend on settings, S1 to S14."""

NAMES = tuple(each.name for each in CRITERIA)

MOTION = 4
"""Number of the statements on the motion itself, S1 to S4."""


def all_margins(pairs: Behaviour) -> Array:
    """Margins of all criteria for `paired` behaviours of shape (2, ...), shape (14, ...).

    That of a criterion is the least of its parts; where one cannot be computed, it is `WORST`.
    """
    parts = [[*each.margins(pairs).values()] for each in CRITERIA]
    margins = np.array([np.min(each, axis=0) for each in parts])
    return np.asarray(np.maximum(np.nan_to_num(margins, nan=WORST), WORST))
