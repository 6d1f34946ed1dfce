"""Checks of readings before a cause is blamed: each gives a note on a fault of a table, or None."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip._util.arrays import root_mean_square
from stickslip._util.note import Note
from stickslip._util.text import counted

Check = Callable[[Any], Note | None]

FEWEST_CONDITIONS = 4
"""Conditions without which no cause is told from another, if there are no other data. Chosen: two
constants and a cause leave one degree of freedom."""

_SPREAD = 3.0
"""Variance of the conditions' means, in that of their errors, below which they are alike. Chosen:
means of nothing but errors have 1."""

_LIKENESS = 0.3
"""Part of the model's size within which changed readings are its own. Chosen: constants and causes
of the usual size change predictions by less."""


def all_zero(table: Any) -> Note | None:
    """Readings of which none moved."""
    if table.less or np.any(table.y):
        return None
    return Note("all-zero", "Every reading is zero: nothing moved, so nothing can be told apart.")


def too_few_conditions(table: Any) -> Note | None:
    """Conditions that cannot tell causes apart."""
    count = len(table.mean)
    if count >= FEWEST_CONDITIONS:
        return None
    text = f"{counted(count, 'condition')} cannot tell causes apart; at least "
    return Note("too-few-conditions", f"{text}{FEWEST_CONDITIONS} are needed.", count)


def no_noise(table: Any) -> Note | None:
    """Readings whose error nothing says."""
    if table.errors.known:
        return None
    return Note("no-noise", (
        "The error of a reading is not known, so no misfit can be judged: repeat some conditions, "
        "or state the error (velocity_sd of a measurement, sd of a table)."
    ))  # fmt: skip


def conditions_alike(table: Any) -> Note | None:
    """Conditions that differ by no more than their readings do."""
    mean, errors = table.mean, table.errors
    if table.less or len(mean) == len(table.y) or errors.dof == math.inf:
        return None
    # What blocks share is no error of one condition and not of another.
    variances = errors.of_reading(mean) ** 2 / np.bincount(table.condition)
    ratio = float(np.var(mean) / np.mean(variances))
    return None if ratio >= _SPREAD else Note("conditions-alike", (
        "The conditions differ by no more than their readings do: the variance between them is "
        f"{ratio:.2g} times that of their errors, and {_SPREAD:g} times is needed. Labels may be "
        "mixed up."
    ), ratio)  # fmt: skip


def changed_readings(table: Any) -> Note | None:
    """Readings that are nearly the stated model's once they are reversed or exchanged."""
    for rows, what in table.parts():
        y, model = table.mean[rows], table.nominal[rows]
        size = root_mean_square(model)
        if not 0.0 < size < math.inf or root_mean_square(y - model) < size:
            continue
        for changed, code, text in table.changes(y):
            if root_mean_square(changed - model) < _LIKENESS * size:
                return Note(code, f"{what} would fit the stated model if it were {text}.")
    return None


ALONE: tuple[Check, ...] = (too_few_conditions, no_noise, conditions_alike)
"""Of a table without others that could tell causes apart."""
