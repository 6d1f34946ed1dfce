"""Whether measured velocities can be what the stated model speaks of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.data.conditions import Conditions, in_words, named, varied
from stickslip.diagnosis.data.unit_check import magnitude_mismatch
from stickslip.facts import Code, Fact

Array = NDArray[np.float64]

_OPPOSITE = -0.8
_REVERSED = 3
_WALKS = 0.1
_LISTED = 4


def wrong_size(conditions: Conditions, predicted: Array, velocity: Array) -> Fact | None:
    """Whether the velocities can be what the model speaks of, by their size and sign."""
    sound = np.isfinite(predicted)
    if not sound.any():
        return Fact(Code.NOTHING_COMPUTED, {})
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
    likeness = float(predicted[sound] @ velocity[sound])
    likeness /= float(np.linalg.norm(predicted[sound]) * np.linalg.norm(velocity[sound]))
    if likeness < _OPPOSITE:
        return Fact(Code.OPPOSITE_SIGN, {"cosine": likeness, "limit": _OPPOSITE})
    return None


def standing_still(conditions: Conditions, predicted: Array, velocity: Array) -> Fact | None:
    """What to know of conditions that read zero where the model walks."""
    speed = np.abs(predicted)
    odd = np.flatnonzero((velocity == 0.0) & (speed > _WALKS * np.nanmedian(speed)))
    if not len(odd):
        return None
    names = [in_words(conditions[k], varied(conditions)) for k in odd[:_LISTED]]
    still = {"count": len(odd), "speed": float(np.max(speed[odd])), "conditions": names}
    return Fact(Code.STANDS_STILL, still)


def wrong_sign(conditions: Conditions, predicted: Array, velocity: Array) -> Fact | None:
    """Whether velocities are speeds, or count forwards, or one direction or mode, the other way.

    Every condition that is not slow has then the model's size, and its sign or the reverse by a
    rule that a cause would hardly follow.
    """
    usual = float(np.nanmedian(np.abs(predicted)))
    clear = np.isfinite(predicted) & (np.minimum(np.abs(predicted), np.abs(velocity)) > usual / 3)
    ratio = np.abs(velocity[clear] / predicted[clear])
    reversed_ = np.sign(velocity[clear]) != np.sign(predicted[clear])
    away = np.abs(np.log(ratio))
    if min(reversed_.sum(), (~reversed_).sum()) < _REVERSED:
        return None
    if max(np.median(away[reversed_]), np.median(away[~reversed_])) > np.log(1.5):
        return None
    if np.array_equal(reversed_, predicted[clear] < 0.0):
        return Fact(Code.SPEEDS, {})
    for key in ("drive.direction", "drive.mode"):
        words = np.array([str(each[key]) for each in conditions])[clear]
        for word in sorted(set(words.tolist())):
            if np.array_equal(reversed_, words == word):
                return Fact(Code.REVERSED, {"setting": key.split(".")[1], "value": word})
    return None
