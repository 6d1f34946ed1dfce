"""The paper's statements that depend on settings, S1 to S14, as criteria on the survey.

All angles are magnitudes: the upstroke is where |theta| rises, whatever the clamp coil's sign.
Velocities are the medians over small changes of frequency, friction and field: near 100 Hz a curve
is jagged, and one point of it says little. The paper gives no thresholds: those here are choices of
this study, which the table of statements names.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.reproduction.lines import Line, bend, crossing, proportional, ratio, straight
from stickslip.reproduction.points import SCANS, Array
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


@dataclass(frozen=True)
class Criterion:
    """A statement of the paper, and how it is tested with behaviours of IPP and OPP.

    A margin is a pure number, from zero where a part of the statement holds, and below zero where
    it does not; or NaN, where it does not either.
    """

    name: str  # "S1" to "S14"
    text: str  # the statement, in other words than the paper's
    condition: str  # what counts as such
    margins: Callable[[Behaviour, Behaviour], Mapping[str, Array]]  # of its parts by name
    numbers: Callable[[Behaviour, Behaviour], str]  # in words, of one setting of each mode


def least(margins: Mapping[str, Array]) -> Array:
    """The margin of a whole statement: the least of all its parts, or NaN."""
    return functools.reduce(np.minimum, margins.values())


def above(value: Any, limit: Any) -> Any:
    """The margin of a value that is to be above a limit: their difference over their sum."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return (value - limit) / (np.abs(value) + np.abs(limit))


def if_also(margin: Any, condition: Any) -> Any:
    """A margin where a condition is met, and -1 at most where it is not."""
    return np.minimum(margin, np.where(condition, np.inf, -1.0))


def _margins_of_both(
    margin: Callable[[Behaviour], Array],
) -> Callable[[Behaviour, Behaviour], Mapping[str, Array]]:
    """The same margin of both modes."""
    return lambda ipp, opp: {"IPP": margin(ipp), "OPP": margin(opp)}


def _words_of_both(words: Callable[[Behaviour], str]) -> Callable[[Behaviour, Behaviour], str]:
    """The same words of both modes."""
    return lambda ipp, opp: f"IPP {words(ipp)}; OPP {words(opp)}"


def _mean(each: Behaviour, part: Part) -> Array:
    """Mean velocity, m/s."""
    return np.asarray(each.velocity(*part).mean(axis=-1))


def _speeds(part: Part, ipp: Behaviour, opp: Behaviour) -> str:
    return f"IPP {_mean(ipp, part) * 1e3:.2f} mm/s, OPP {_mean(opp, part) * 1e3:.2f} mm/s"


def _low_line(each: Behaviour) -> Line:
    """Velocity over low frequencies."""
    low = _X["frequency"] <= LOW_FREQUENCY_END
    return proportional(_X["frequency"][low], each.frequency[..., low])


def _low_line_words(each: Behaviour) -> str:
    line = _low_line(each)
    return (
        f"{line.slope * 1e6:.1f} µm a pulse to 30 Hz, R² {line.explained:.3f}, departures to "
        f"{line.worst:.0%}"
    )


def _over_line(each: Behaviour) -> Array:
    """Velocity at high frequencies over the line of the low ones."""
    line = _low_line(each).slope[..., np.newaxis] * np.array(HIGH_FREQUENCY[1])
    return ratio(each.velocity(*HIGH_FREQUENCY), line)


def _apart(ipp: Behaviour, opp: Behaviour) -> Array:
    """Mean difference of the modes with middle friction, over their mean."""
    first, second = ipp.velocity(*MIDDLE_FRICTION), opp.velocity(*MIDDLE_FRICTION)
    mean = 0.5 * (np.abs(first) + np.abs(second)).mean(axis=-1)
    return ratio(np.abs(second - first).mean(axis=-1), mean)


def _left_with_adhesion(each: Behaviour) -> Array:
    return ratio(_mean(each, HIGH_ADHESION), _mean(each, LOW_ADHESION))


def _over_first(curve: Array) -> Array:
    """Velocity over that at the first of a scan's values."""
    return ratio(curve, curve[..., :1])


def _level(*left: Array) -> Array:
    """The margin of both modes staying at their first value."""
    changes = (np.abs(each - 1.0).max(axis=-1) for each in left)
    return np.asarray(MAX_CHANGE - np.maximum(*changes))


def _linear_damping(ipp: Behaviour, opp: Behaviour) -> dict[str, Array]:
    left = [_over_first(each.linear) for each in (ipp, opp)]
    low = _X["linear"] <= 1e-6
    rises = [np.diff(each, axis=-1).max(axis=-1) for each in left]
    frozen = [np.abs(each[..., -1]) for each in left]
    return {
        "level to 1e-6 N s/m": _level(*(each[..., low] for each in left)),
        "slower with more damping": MAX_CHANGE - np.maximum(*rises),
        "frozen at 1e-2 N s/m": MAX_SUPPRESSED - np.maximum(*frozen),
    }


def _linear_damping_words(each: Behaviour) -> str:
    fall = functools.partial(crossing, _over_first(each.linear), _X["linear"])
    return f"falls to 90% at {fall(0.9):.1g} N s/m, to 10% at {fall(0.1):.1g} N s/m"


def _damped_apart(ipp: Behaviour, opp: Behaviour) -> Array:
    """Mean difference of the parts that much rotational damping leaves of the velocity."""
    high = _X["rotational"] >= 1e-15
    left = [_over_first(each.rotational)[..., high] for each in (ipp, opp)]
    return np.asarray(np.abs(left[0] - left[1]).mean(axis=-1))


def _rotational_damping(ipp: Behaviour, opp: Behaviour) -> dict[str, Array]:
    left = [_over_first(each.rotational) for each in (ipp, opp)]
    low = _X["rotational"] <= 3e-17
    return {
        "little effect to 3e-17 N m s²": _level(*(each[..., low] for each in left)),
        "slower at 1e-13": 1.0 - MAX_CHANGE - np.maximum(*(each[..., -1] for each in left)),
        "modes lose alike": 0.5 * MAX_DIFFERENCE - _damped_apart(ipp, opp),
    }


def _linear_in_field(each: Behaviour) -> Array:
    line = straight(_X["field"], each.field)
    return np.asarray(if_also(line.explained - MIN_R_SQUARED, line.slope > 0.0))


def _field_words(each: Behaviour) -> str:
    line = straight(_X["field"], each.field)
    return (
        f"{line.slope:.2f} (mm/s)/mT, R² {line.explained:.3f}, slope of the upper half over that "
        f"of the lower {bend(_X['field'], each.field):.2f}"
    )


CRITERIA = (
    Criterion(
        "S1",
        "IPP slips on the downstroke.",
        f"{SLIP_SHARE:.0%} of the slip's path on the downstroke, forwards, at 30 Hz",
        lambda ipp, _: {
            "IPP slips on the downstroke": if_also(
                1.0 - ipp.share_up - SLIP_SHARE, ipp.slip_down > 0.0
            )
        },
        lambda ipp, _: f"{1.0 - ipp.share_up:.1%} of the slip's path is on the downstroke",
    ),
    Criterion(
        "S2",
        "OPP slips on the upstroke.",
        f"{SLIP_SHARE:.0%} of the slip's path on the upstroke, forwards, at 30 Hz",
        lambda _, opp: {
            "OPP slips on the upstroke": if_also(opp.share_up - SLIP_SHARE, opp.slip_up > 0.0)
        },
        lambda _, opp: f"{opp.share_up:.1%} of the slip's path is on the upstroke",
    ),
    Criterion(
        "S3",
        "The normal force is low on IPP's downstroke and high on OPP's upstroke.",
        "mean while slipping below, or above, weight and adhesion, at 30 Hz",
        lambda ipp, opp: {
            "IPP less than at rest": above(1.0, ipp.normal_down),
            "OPP more": above(opp.normal_up, 1.0),
        },
        lambda ipp, opp: (
            "mean N while slipping, over that at rest: IPP on the downstroke "
            f"{ipp.normal_down:.2f}, OPP on the upstroke {opp.normal_up:.2f}"
        ),
    ),
    Criterion(
        "S4",
        "The steady angle is much larger in IPP than in OPP.",
        f"{MUCH_LARGER:g} times or more, before the pulses and in the mean at 30 Hz",
        lambda ipp, opp: {
            "larger before the pulses": above(ipp.still_tilt, MUCH_LARGER * opp.still_tilt),
            "larger in the mean": above(ipp.tilt, MUCH_LARGER * opp.tilt),
        },
        lambda ipp, opp: (
            f"IPP {np.degrees(ipp.still_tilt):.0f}°, OPP {np.degrees(opp.still_tilt):.0f}° before "
            f"the pulses; mean at 30 Hz IPP {np.degrees(ipp.tilt):.0f}°, OPP "
            f"{np.degrees(opp.tilt):.0f}°"
        ),
    ),
    Criterion(
        "S5",
        "Velocity is proportional to a low frequency.",
        f"R² of a line through the origin to {LOW_FREQUENCY_END:g} Hz at least {MIN_R_SQUARED:g}",
        _margins_of_both(lambda each: _low_line(each).explained - MIN_R_SQUARED),
        _words_of_both(_low_line_words),
    ),
    Criterion(
        "S6",
        "Velocity rolls off at high frequency.",
        f"{MAX_CHANGE:.0%} or more below that line at 100, 120 and 150 Hz",
        _margins_of_both(lambda each: 1.0 - MAX_CHANGE - _over_line(each).max(axis=-1)),
        lambda *pair: (
            "velocity over that line at 100 and 150 Hz: IPP {0[0]:.2f} and {0[2]:.2f}, OPP "
            "{1[0]:.2f} and {1[2]:.2f}".format(*map(_over_line, pair))
        ),
    ),
    Criterion(
        "S7",
        "With little friction OPP is faster.",
        "means for static friction 0.02, 0.05 and 0.1",
        lambda ipp, opp: {"OPP faster": above(_mean(opp, LOW_FRICTION), _mean(ipp, LOW_FRICTION))},
        lambda *pair: f"mean for static friction 0.02 to 0.1: {_speeds(LOW_FRICTION, *pair)}",
    ),
    Criterion(
        "S8",
        "With static friction from 0.2 to 1.0 both modes are about as fast.",
        f"mean difference at most {MAX_DIFFERENCE:.0%} of the mean velocity",
        lambda ipp, opp: {"similar": MAX_DIFFERENCE - _apart(ipp, opp)},
        lambda *pair: (
            f"mean for static friction 0.2 to 1.0: {_speeds(MIDDLE_FRICTION, *pair)}; mean "
            f"difference {_apart(*pair):.0%}"
        ),
    ),
    Criterion(
        "S9",
        "With static friction above 1 IPP is faster.",
        "means for static friction 1.2 to 2.4",
        lambda ipp, opp: {
            "IPP faster": above(_mean(ipp, HIGH_FRICTION), _mean(opp, HIGH_FRICTION))
        },
        lambda *pair: f"mean for static friction 1.2 to 2.4: {_speeds(HIGH_FRICTION, *pair)}",
    ),
    Criterion(
        "S10",
        "With little adhesion OPP is faster, and more adhesion costs it more.",
        "means to 0.05 µN, and what is left of them at 0.4 to 0.6 µN",
        lambda ipp, opp: {
            "OPP faster at low adhesion": above(_mean(opp, LOW_ADHESION), _mean(ipp, LOW_ADHESION)),
            "OPP loses more": _left_with_adhesion(ipp) - _left_with_adhesion(opp),
        },
        lambda ipp, opp: (
            f"mean for 0 to 0.05 µN: {_speeds(LOW_ADHESION, ipp, opp)}; left of it at 0.4 to 0.6 "
            f"µN: IPP {_left_with_adhesion(ipp):.0%}, OPP {_left_with_adhesion(opp):.0%}"
        ),
    ),
    Criterion(
        "S11",
        "Linear damping slows both modes, between a range where it matters little and one where "
        "nothing moves.",
        f"within {MAX_CHANGE:.0%} to 1e-6 N s/m, never rising by more than that, below "
        f"{MAX_SUPPRESSED:.0%} at 1e-2 N s/m",
        _linear_damping,
        _words_of_both(_linear_damping_words),
    ),
    Criterion(
        "S12",
        "Rotational damping matters little when low; then both modes lose alike.",
        f"within {MAX_CHANGE:.0%} to 3e-17 N m s², slower at 1e-13, and from 1e-15 on the part "
        f"left of the velocity equal within {0.5 * MAX_DIFFERENCE:.0%}",
        _rotational_damping,
        lambda ipp, opp: (
            f"left at 1e-13 N m s²: IPP {_over_first(ipp.rotational)[-1]:.0%}, OPP "
            f"{_over_first(opp.rotational)[-1]:.0%}; from 1e-15 up the modes differ by "
            f"{_damped_apart(ipp, opp):.0%} of their velocity without it"
        ),
    ),
    Criterion(
        "S13",
        "Velocity grows about linearly with the field, in IPP with some roll-off.",
        f"R² of a line at least {MIN_R_SQUARED:g} from 1.5 to 6.5 mT at 30 Hz, rising; in IPP the "
        f"upper half less steep by {MAX_CHANGE:.0%} or more",
        lambda ipp, opp: {
            "IPP linear": _linear_in_field(ipp),
            "IPP rolls off": 1.0 - MAX_CHANGE - bend(_X["field"], ipp.field),
            "OPP linear": _linear_in_field(opp),
        },
        _words_of_both(_field_words),
    ),
    Criterion(
        "S14",
        "Constant fields move nothing.",
        f"mean speed below {MIN_SPEED * 1e6:g} µm/s for a second, at the sawtooth's bottom and at "
        "its top",
        _margins_of_both(lambda each: 1.0 - each.still_velocity / MIN_SPEED),
        lambda ipp, opp: (
            f"greatest mean speed: IPP {ipp.still_velocity * 1e9:.1g} nm/s, OPP "
            f"{opp.still_velocity * 1e9:.1g} nm/s"
        ),
    ),
)
"""The statements that depend on settings, S1 to S14."""

NAMES = tuple(each.name for each in CRITERIA)

MOTION = 4
"""Number of the statements on the motion itself, S1 to S4."""


def all_margins(ipp: Behaviour, opp: Behaviour) -> Array:
    """Margins of all criteria, shape (14, ...) where the behaviours broadcast to (...)."""
    return np.array(np.broadcast_arrays(*(least(each.margins(ipp, opp)) for each in CRITERIA)))
