"""Checks of velocities: those that drift, or that are not what the stated model can give."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.stats import t as t_law

from stickslip._util.arrays import Array, Indices, Mask
from stickslip._util.note import Note
from stickslip.diagnosis.data.errors import along_runs
from stickslip.diagnosis.data.noise import whitener

_RARE, _FEWEST_ORDERED = 0.002, 12
"""p-value below which a drift is said, and the fewest trials to judge by. Chosen: one in 500 sound
data sets; a slope of fewer says little."""

_LASTING = 0.97
"""Correlation of neighbours above which errors are a drift themselves. Chosen: they last for thirty
readings, most of a table."""

_OPPOSITE = -0.8
"""Cosine between measured and predicted velocities below which their signs are reversed. Chosen:
near the -1 of reversed signs, with room for a model that is wrong otherwise."""

_REVERSED, _SIMILAR = 3, 1.5
"""Fewest conditions of either sign that show a rule, and the largest median ratio of speeds for
which only the sign differs. Chosen: with fewer a rule is met by chance; room for constants that are
off."""

_ALONG = "A velocity is that along +x."


def nothing_computed(table: Any) -> Note | None:
    """Conditions of which the stated model computes none."""
    if np.isfinite(table.stated).any():
        return None
    return Note("nothing-computed", (
        "No condition can be simulated with the stated scenario and the middles of what is "
        "uncertain: look at the settings."
    ))  # fmt: skip


def opposite_sign(table: Any) -> Note | None:
    """Velocities that are all of the opposite sign of the stated model's."""
    sound = np.isfinite(table.stated)
    stated, mean = table.stated[sound], table.mean[sound]
    if 0.0 in (np.median(np.abs(stated)), np.median(np.abs(mean))):
        return None
    cosine = float(stated @ mean / (np.linalg.norm(stated) * np.linalg.norm(mean)))
    return None if cosine >= _OPPOSITE else Note("opposite-sign", (
        "The velocities have the opposite sign of the stated model's (a cosine of "
        f"{cosine:.2g}); x, a direction, a mode or the clamp may be reversed."
    ), cosine)  # fmt: skip


def _turned(table: Any) -> tuple[Mask, Mask]:
    """Conditions that are not slow, and which of these have the reverse of the model's sign.

    None are turned unless all have about the model's size and some either sign.
    """
    stated, mean = table.stated, table.mean
    usual = float(np.nanmedian(np.abs(stated)))
    clear = np.isfinite(stated) & (np.minimum(np.abs(stated), np.abs(mean)) > usual / 3.0)
    turned = np.sign(mean[clear]) != np.sign(stated[clear])
    if min(np.sum(turned), np.sum(~turned)) < _REVERSED:
        return clear, np.zeros_like(turned)
    away = np.abs(np.log(np.abs(mean[clear] / stated[clear])))
    typical = max(np.median(away[turned]), np.median(away[~turned]))
    return clear, turned & (typical <= math.log(_SIMILAR))


def speeds(table: Any) -> Note | None:
    """Speeds in place of velocities."""
    clear, turned = _turned(table)
    if not turned.any() or not np.array_equal(turned, table.stated[clear] < 0.0):
        return None
    text = f"The velocities have the model's size without its sign, like speeds. {_ALONG}"
    return Note("speeds", text)


def reversed_rule(table: Any) -> Note | None:
    """A direction or a mode whose sign is reversed, a rule that a cause would hardly follow."""
    clear, turned = _turned(table)
    for key in ("direction", "mode") if turned.any() else ():
        words = np.array([str(drive[f"drive.{key}"]) for drive in table.conditions])[clear]
        for word in np.unique(words):
            if np.array_equal(turned, words == word):
                return Note("reversed", (
                    "The velocities have the model's size, and the reverse of its sign wherever "
                    f"{key} is {word}. {_ALONG}"
                ))  # fmt: skip
    return None


def drift(table: Any) -> Note | None:
    """Velocities that change with time; the value is their part from the first trial to the last.

    A drift shifts all alike, or all in proportion, whatever their sign.
    """
    found = _least_probable_slope(table)
    if found is None or found[0] >= _RARE:
        return None
    p_value, part = found
    return Note("drift", (
        "The velocities drift with the order in which they were measured (p = "
        f"{p_value:.1g}, below {_RARE:g}); measure the conditions again in random order."
    ), part)  # fmt: skip


def _least_probable_slope(table: Any) -> tuple[float, float] | None:
    """p-value of a drift, and the part by which velocities change; None of too few trials."""
    moves = np.bincount(table.condition, table.y != 0.0) > 0
    used = np.isfinite(table.sequence) & moves[table.condition]
    if "shift" in table.errors.sizes:
        used &= table.block >= 0  # a trial of no known block has an error of its own
    if np.sum(used) < _FEWEST_ORDERED:
        return None
    rows, gap = along_runs(table.curve, table.sequence, used, used)
    phi = table.errors.sizes.get("phi", 0.0)
    independent = whitener(gap, phi if phi < _LASTING else 0.0).T
    basis = _free_changes(table, rows, independent)
    c = table.condition[rows]
    error = table.errors.of_reading(table.mean)[c]
    scatter = (table.y[rows] - table.mean[c]) / error
    columns = np.column_stack([table.sequence[rows], scatter, scatter * np.sign(table.mean)[c]])
    whole = independent @ columns
    time, *changes = (whole - basis @ (basis.T @ whole)).T
    dof, power = len(rows) - basis.shape[1] - 1, float(time @ time)
    if dof < 1 or power <= 1e-9 * float(whole[:, 0] @ whole[:, 0]):
        return None
    slopes = [float(time @ change) / power for change in changes]
    rests = [change - slope * time for change, slope in zip(changes, slopes, strict=True)]
    ratios = [abs(slope) * math.sqrt(power / max(float(rest @ rest) / dof, 1e-12))
              for slope, rest in zip(slopes, rests, strict=True)]  # fmt: skip
    most = int(np.argmax(ratios))
    span = np.ptp(table.sequence[rows]) * np.median(error / np.abs(table.mean[c]))
    return 4.0 * float(t_law.sf(ratios[most], dof)), abs(slopes[most]) * float(span)


def _free_changes(table: Any, rows: Indices, independent: Array) -> Array:
    """Basis of what conditions, and blocks, may have of their own: no drift."""
    c = table.condition[rows]
    free = [np.eye(len(table.mean))[c]]
    if "shift" in table.errors.sizes:
        shares = np.eye(int(table.block.max()) + 1)[table.block[rows]]
        free += [shares, shares * np.sign(table.mean)[c, None]]
    left, singular, _ = np.linalg.svd(independent @ np.hstack(free), full_matrices=False)
    return np.asarray(left[:, singular > 1e-9 * singular[0]])


CHECKS = (nothing_computed, opposite_sign, speeds, reversed_rule, drift)
