"""Whether measured numbers can be what the stated model computes, by their size, unit and sign."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.unit_factor import unit_factor
from stickslip.diagnosis.data.conditions import Conditions, in_words, named, varied
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.simulation.scenario_notes import STEADY_PULSES

_MOST = 50.0
"""Ratio beyond which a size is far from the usual one. Chosen: below 57
(degrees for rad) and 1000 (mm for m), the commonest mistakes of units."""

_OPPOSITE = -0.8
"""Cosine between measured and predicted velocities below which their signs are reversed. Chosen:
near the -1 of reversed signs, with room for a model that is wrong otherwise."""

_REVERSED = 3
"""Conditions with reversed and with equal sign, at the least, to recognise a rule. Chosen: with
fewer a rule is met by chance too easily."""

_SIMILAR = 1.5
"""Largest median ratio of speeds for which only the sign differs. Chosen: room for the error of
the constants."""

_WALKS = 0.1
"""Part of the median speed above which the model is said to move. Chosen: slower motions
may well be read as zero."""

_LISTED = 4
"""Conditions that a sentence names. Chosen: more are not read."""


def magnitude_mismatch(measured: float, usual: float, unit: str) -> dict[str, Any] | None:
    """Whether a size is above 50 times the usual one, or below a 50th of it: fields of a `Fact`.

    Both are in `unit` and not below 0; where either is 0 there is none. `unit_factor` is None where
    the ratio is near no factor between units.
    """
    if measured == 0.0 or usual == 0.0 or 1.0 / _MOST < measured / usual < _MOST:
        return None
    ratio = measured / usual
    return {
        "ratio": ratio,
        "measured": measured,
        "usual": usual,
        "unit": unit,
        "allowed": [1.0 / _MOST, _MOST],
        "unit_factor": unit_factor(ratio),
    }


def refuse_larger(table: str, what: str, size: float, most: float, unit: str) -> None:
    """Refuse a table with a length or a field so large that its unit must be wrong."""
    if size > most:
        raise ScenarioError(
            f"{table}: a {what} of {size:.4g} {unit}; allowed is at most {most:g} {unit}. If "
            f"{what}s are in m{unit}, divide them by 1e3"
        )


def wrong_size(
    conditions: Conditions, predicted: Array, velocity: Array, refusal: str | None
) -> Fact | None:
    """A fact if the velocities of all or of one condition have another size, or reversed signs.

    `predicted` are those of the stated model, `velocity` the means that were measured, shape (m,),
    m/s. `refusal` says why the stated model is none, if it is none.
    """
    sound = np.isfinite(predicted)
    if not sound.any():
        return Fact(Code.NOTHING_COMPUTED, {"refusal": refusal})
    usual, measured = (float(np.median(np.abs(each[sound]))) for each in (predicted, velocity))
    if usual == 0.0 or measured == 0.0:
        return None
    far = magnitude_mismatch(measured, usual, "m/s")
    if far is not None:
        return Fact(Code.VELOCITIES_SIZE, far)
    fastest, most = float(np.max(np.abs(predicted[sound]))), int(np.nanargmax(np.abs(velocity)))
    far = magnitude_mismatch(abs(float(velocity[most])), fastest, "m/s")
    if far is not None and abs(velocity[most]) > fastest:
        return Fact(Code.VELOCITY_SIZE, {**named(conditions[most], varied(conditions)), **far})
    cosine = float(predicted[sound] @ velocity[sound])
    cosine /= float(np.linalg.norm(predicted[sound]) * np.linalg.norm(velocity[sound]))
    if cosine < _OPPOSITE:
        return Fact(Code.OPPOSITE_SIGN, {"cosine": cosine, "limit": _OPPOSITE})
    return None


def standing_still(conditions: Conditions, predicted: Array, velocity: Array) -> Fact | None:
    """A note on conditions that read zero where the stated model moves."""
    if not np.isfinite(predicted).any():
        return None
    speed = np.abs(predicted)
    still = np.flatnonzero((velocity == 0.0) & (speed > _WALKS * np.nanmedian(speed)))
    if not len(still):
        return None
    names = [in_words(conditions[k], varied(conditions)) for k in still[:_LISTED]]
    fastest = float(np.max(speed[still]))
    return Fact(Code.STANDS_STILL, {"count": len(still), "speed": fastest, "conditions": names})


def start_up_included(conditions: Conditions) -> Fact | None:
    """A note on drives so short that their mean velocity includes the start-up."""
    count = sum(float(each["drive.pulses"]) < STEADY_PULSES for each in conditions)
    return Fact(Code.FEW_PULSES, {"count": count, "needed": STEADY_PULSES}) if count else None


def wrong_sign(conditions: Conditions, predicted: Array, velocity: Array) -> Fact | None:
    """A fact if velocities are speeds, or one direction or mode is counted with reversed sign.

    Every condition that is not slow has then the model's size, and its sign or the reverse by a
    rule that a cause would hardly follow.
    """
    usual = float(np.nanmedian(np.abs(predicted)))
    clear = np.isfinite(predicted) & (np.minimum(np.abs(predicted), np.abs(velocity)) > usual / 3)
    reversed_ = np.sign(velocity[clear]) != np.sign(predicted[clear])
    if min(reversed_.sum(), (~reversed_).sum()) < _REVERSED:
        return None
    away = np.abs(np.log(np.abs(velocity[clear] / predicted[clear])))
    if max(np.median(away[reversed_]), np.median(away[~reversed_])) > np.log(_SIMILAR):
        return None
    if np.array_equal(reversed_, predicted[clear] < 0.0):
        return Fact(Code.SPEEDS, {})
    for key in ("drive.direction", "drive.mode"):
        words = np.array([str(each[key]) for each in conditions])[clear]
        for word in sorted(set(words.tolist())):
            if np.array_equal(reversed_, words == word):
                return Fact(Code.REVERSED, {"setting": key.split(".")[1], "value": word})
    return None
