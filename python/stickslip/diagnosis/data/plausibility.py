"""Whether measured velocities can be what the stated model speaks of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stickslip.diagnosis.data.conditions import Conditions, in_words, varied
from stickslip.diagnosis.data.unit_check import magnitude_mismatch

Array = NDArray[np.float64]

_OPPOSITE = -0.8
_REVERSED = 3
_WALKS = 0.1
_LISTED = 4


def wrong_size(conditions: Conditions, predicted: Array, velocity: Array) -> str | None:
    """Whether the velocities can be what the model speaks of, by their size and sign."""
    sound = np.isfinite(predicted)
    if not sound.any():
        return (
            "no condition can be simulated with the stated scenario and the middles of what is "
            "uncertain; look at its settings, and whether [uncertain] has values that it forbids"
        )
    usual, measured = (float(np.median(np.abs(each[sound]))) for each in (predicted, velocity))
    if usual == 0.0 or measured == 0.0:
        return None
    far = magnitude_mismatch(measured, usual, "m/s")
    if far is not None:
        return f"the velocities are {far}"
    fastest, most = float(np.max(np.abs(predicted[sound]))), int(np.nanargmax(np.abs(velocity)))
    far = magnitude_mismatch(
        abs(float(velocity[most])), fastest, "m/s", "the stated model's fastest"
    )
    if far is not None and abs(velocity[most]) > fastest:
        return f"the velocity of {in_words(conditions[most], varied(conditions))} is {far}"
    likeness = float(predicted[sound] @ velocity[sound])
    likeness /= float(np.linalg.norm(predicted[sound]) * np.linalg.norm(velocity[sound]))
    if likeness < _OPPOSITE:
        return (
            "the velocities have the opposite sign of the stated model's; "
            "x, a direction, a mode or a clamp may be reversed"
        )
    return None


def standing_still(conditions: Conditions, predicted: Array, velocity: Array) -> str | None:
    """What to know of conditions that read zero where the model walks."""
    speed = np.abs(predicted)
    odd = np.flatnonzero((velocity == 0.0) & (speed > _WALKS * np.nanmedian(speed)))
    if not len(odd):
        return None
    names = [in_words(conditions[k], varied(conditions)) for k in odd[:_LISTED]]
    more = f" and {len(odd) - _LISTED} more" if len(odd) > _LISTED else ""
    return (
        f"{len(odd)} conditions read zero where the stated model moves by up to "
        f"{np.max(speed[odd]) * 1e3:.3g} mm/s: {'; '.join(names)}{more}"
    )


def wrong_sign(conditions: Conditions, predicted: Array, velocity: Array) -> str | None:
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
        return (
            "the velocities have the model's size without its sign: they look like speeds; a "
            "velocity is that along +x"
        )
    for key in ("drive.direction", "drive.mode"):
        words = np.array([str(each[key]) for each in conditions])[clear]
        for word in sorted(set(words.tolist())):
            if np.array_equal(reversed_, words == word):
                return (
                    f"the velocities have the model's size, and the reverse of its sign wherever "
                    f"{key.split('.')[1]} is {word}; a velocity is that along +x"
                )
    return None
