"""What makes the data suspect, before any cause is blamed.

A `Note` says what to do about it; None means that nothing stands out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.stats import t as t_law

from stickslip._util.numbers import Array, Indices, root_mean_square
from stickslip._util.units import factor_text, far_size
from stickslip.diagnosis.data.errors import along_runs
from stickslip.diagnosis.data.field import FieldTable
from stickslip.diagnosis.data.film import FilmTable
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.data.velocity import VelocityTable, in_words, varied
from stickslip.diagnosis.fitting.problem import Problem
from stickslip.simulation.note import Note
from stickslip.simulation.note_table import STEADY_PULSES

FEWEST_CONDITIONS = 4
"""Conditions without which no cause is told from another, if there are no other data. Chosen: two
constants and a cause leave one degree of freedom."""

_SPREAD = 3.0
"""Variance of the conditions' means, in that of their errors, below which they are alike. Chosen:
means of nothing but errors have 1."""

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

_LIKENESS, _FACTORS = 0.3, (1e3, 1e-3, 1e6, 1e-6)
"""Part of the model's size within which changed readings are its own, and mistakes of a unit.
Chosen: constants and causes of the usual size change predictions by less."""

_WALKS, _LISTED = 0.1, 4
"""Share of the median speed above which the model is said to move, and conditions that a note
names. Chosen: slower motion may well be read as zero; more are not read."""


def suspect_of(problem: Problem) -> Note | None:
    """What makes the data of a problem suspect, if anything does; each table is asked."""
    alone = len(problem.tables) == 1
    stated = problem.model(problem.physical(np.zeros((1, problem.size))))[0]
    for table, part in zip(problem.tables, problem.rows, strict=True):
        if isinstance(table, VelocityTable):
            found = find_velocity_problem(table, alone=alone)
        else:
            found = find_problem(table, alone=alone) or _unlike(table, stated[part])
        if found is not None and not alone:
            title = getattr(table, "title", "") or table.name or "a table"
            found = replace(found, text=f"{title}: {found.text}")
        if found is not None:
            return found
    count, free = len(problem.y), len(problem.constants)
    if count <= free:
        text = f"{count} conditions cannot tell {free} uncertain constants, let alone causes."
        return Note("too-many-constants", text, free)
    return None


def find_problem(table: Table, *, alone: bool = True) -> Note | None:
    """What makes the readings of a table suspect by themselves, if anything does.

    A table that does not stand `alone` may say little: other data can tell causes apart.
    """
    if not np.any(table.y):
        text = "Every reading is zero: nothing moved, so nothing can be told apart."
        return Note("all-zero", text)
    if not alone:
        return None
    mean, errors = table.mean, table.errors
    conditions = f"{len(mean)} condition{'' if len(mean) == 1 else 's'}"
    if len(mean) < FEWEST_CONDITIONS:
        text = f"{conditions} cannot tell causes apart; at least {FEWEST_CONDITIONS} are needed."
        return Note("too-few-conditions", text, len(mean))
    if not errors.known:
        text = (
            "The error of a reading is not known, so no misfit can be judged: repeat some "
            "conditions, or state the error (velocity_sd of a measurement, sd of a table)."
        )
        return Note("no-noise", text)
    if 0.0 < errors.dof < math.inf and 3 < len(mean) < len(table.y):  # from repeats
        # What set-ups share is no error of one condition beside another.
        own = errors.of_reading(mean) ** 2 / np.bincount(table.condition)
        ratio = float(np.var(mean) / np.mean(own))
        if ratio < _SPREAD:
            text = (
                "The conditions differ by no more than their readings do: the variance between "
                f"them is {ratio:.2g} times that of their errors, and {_SPREAD:g} times is needed. "
                "Labels may be mixed up."
            )
            return Note("conditions-alike", text, ratio)
    return None


def find_velocity_problem(table: VelocityTable, *, alone: bool = True) -> Note | None:
    """The same of velocities, which may also drift or not be what the stated model can give."""
    return (
        find_problem(table, alone=alone)
        or _wrong_size(table)
        or _wrong_sign(table)
        or _drift(table)
    )


def velocity_notes(table: VelocityTable) -> list[Note]:
    """What a reader should know of velocities that can be used."""
    notes = []
    short = sum(float(each["drive.pulses"]) < STEADY_PULSES for each in table.conditions)
    if short:
        text = (
            f"At {short} of {len(table.mean)} conditions the drive has fewer than {STEADY_PULSES} "
            "pulses, so the mean velocity includes the start-up."
        )
        notes.append(Note("few-pulses", text, short))
    speed = np.abs(table.stated)
    if np.isfinite(speed).any():
        still = np.flatnonzero((table.mean == 0.0) & (speed > _WALKS * np.nanmedian(speed)))
        if len(still):
            keys = varied(table.conditions)
            names = [in_words(table.conditions[k], keys) for k in still[:_LISTED].tolist()]
            more = f" and {len(still) - _LISTED} more" if len(still) > _LISTED else ""
            fastest = float(np.max(speed[still]))
            text = (
                f"Every reading is zero at {len(still)} of {len(table.mean)} conditions where the "
                f"stated model moves by up to {1e3 * fastest:.3g} mm/s: {'; '.join(names)}{more}."
            )
            notes.append(Note("stands-still", text, fastest))
    return notes


def _unlike(table: Table, stated: Array) -> Note | None:
    """Readings that are the stated model's once they are reversed, rescaled or exchanged.

    Only a nearly perfect likeness counts: what is between is a matter of causes.
    """
    for rows, what in _parts(table):
        y, model = table.mean[rows], stated[rows]
        size = root_mean_square(model)
        if not np.isfinite(size) or size == 0.0:
            continue
        if isinstance(table, FilmTable):
            far = far_size(root_mean_square(y), size, _of_a_film(what), "the stated model's")
            if far is not None:
                return Note("readings-size", f"{what} is {far}.", root_mean_square(y) / size)
        if root_mean_square(y - model) < size:
            continue
        for changed, code, text in _changes(table, y):
            if root_mean_square(changed - model) < _LIKENESS * size:
                return Note(code, f"{what} would fit the stated model if it were {text}.")
    return None


def _parts(table: Table) -> list[tuple[Indices | slice, str]]:
    """Rows of a table that share a unit, and what they are called."""
    if not isinstance(table, FilmTable):
        return [(slice(None), "The table")]
    columns = table["column"][table.first]
    return [(np.flatnonzero(columns == each), f"Column {each}") for each in ("x", "theta")
            if each in columns]  # fmt: skip


def _of_a_film(what: str) -> str:
    return "rad" if what.endswith("theta") else "m"


def _changes(table: Table, y: Array) -> Iterator[tuple[Array, str, str]]:
    """Readings as they may have been meant, with the code of the note and its words."""
    yield -y, "readings-reversed", "of the other sign"
    for factor in _FACTORS:
        size = factor_text(1.0 / factor)
        yield y / factor, "readings-unit", f"{size} times as large: look at its unit"
    if isinstance(table, FieldTable):
        vectors = y.reshape(-1, 3)
        for order in itertools.permutations(range(3)):
            for sign in (1.0, -1.0):
                exchanged = sign * vectors[:, order]
                yield exchanged.ravel(), "readings-exchanged", "one with its components exchanged"
        for k, name in enumerate("xyz"):
            mirrored = vectors * np.where(np.arange(3) == k, -1.0, 1.0)
            yield mirrored.ravel(), "readings-reversed", f"one with the other sign of B{name}"


def _wrong_size(table: VelocityTable) -> Note | None:
    """Velocities of another size than the stated model's, or all of the opposite sign."""
    sound = np.isfinite(table.stated)
    if not sound.any():
        why = table.refusal or "look at the settings, and whether [uncertain] has refused values"
        text = (
            "No condition can be simulated with the stated scenario and the middles of what is "
            f"uncertain: {why}."
        )
        return Note("nothing-computed", text)
    stated, mean = table.stated[sound], table.mean[sound]
    usual, measured = (float(np.median(np.abs(each))) for each in (stated, mean))
    if usual == 0.0 or measured == 0.0:
        return None
    far = far_size(measured, usual, "m/s", "what the stated model gives")
    if far is not None:
        return Note("velocities-size", f"The velocities are {far}.", measured / usual)
    fastest, most = float(np.max(np.abs(stated))), int(np.argmax(np.abs(table.mean)))
    largest = abs(float(table.mean[most]))
    far = far_size(largest, fastest, "m/s", "the stated model's fastest")
    if far is not None and largest > fastest:
        where = in_words(table.conditions[most], varied(table.conditions))
        return Note("velocity-size", f"The velocity at {where} is {far}.", largest / fastest)
    cosine = float(stated @ mean / (np.linalg.norm(stated) * np.linalg.norm(mean)))
    if cosine < _OPPOSITE:
        text = (
            f"The velocities have the opposite sign of the stated model's (a cosine of {cosine:.2g}"
            "); x, a direction, a mode or the clamp may be reversed."
        )
        return Note("opposite-sign", text, cosine)
    return None


def _wrong_sign(table: VelocityTable) -> Note | None:
    """Speeds in place of velocities, or a direction or mode whose sign is reversed.

    Every condition that is not slow then has the model's size, and its sign or the reverse by a
    rule that a cause would hardly follow.
    """
    stated, mean = table.stated, table.mean
    usual = float(np.nanmedian(np.abs(stated)))
    clear = np.isfinite(stated) & (np.minimum(np.abs(stated), np.abs(mean)) > usual / 3.0)
    turned = np.sign(mean[clear]) != np.sign(stated[clear])
    if min(np.sum(turned), np.sum(~turned)) < _REVERSED:
        return None
    away = np.abs(np.log(np.abs(mean[clear] / stated[clear])))
    if max(np.median(away[turned]), np.median(away[~turned])) > math.log(_SIMILAR):
        return None
    along = "A velocity is that along +x."
    if np.array_equal(turned, stated[clear] < 0.0):
        text = f"The velocities have the model's size without its sign, like speeds. {along}"
        return Note("speeds", text)
    for key in ("direction", "mode"):
        words = np.array([str(each[f"drive.{key}"]) for each in table.conditions])[clear]
        for word in np.unique(words):
            if np.array_equal(turned, words == word):
                text = (
                    "The velocities have the model's size, and the reverse of its sign wherever "
                    f"{key} is {word}. {along}"
                )
                return Note("reversed", text)
    return None


def _drift(table: VelocityTable) -> Note | None:
    """Velocities that change with time; what differs between set-ups is no drift."""
    told = table.errors.told
    moves = np.bincount(table.condition, table.y != 0.0) > 0
    used = np.isfinite(table.sequence) & moves[table.condition]
    if "shift" in told:
        used &= table.block >= 0  # a trial of no known set-up has an error of its own
    if np.sum(used) < _FEWEST_ORDERED:
        return None
    rows, gap = along_runs(table.curve, table.sequence, used, used)
    phi = told.get("phi", 0.0)
    link = (phi if phi < _LASTING else 0.0) ** gap[:, None]

    def independent(columns: Array) -> Array:
        """Columns, shape (trials, k), in which errors along a run are independent."""
        fresh = columns.copy()
        fresh[1:] -= link[1:] * columns[:-1]
        return np.asarray(fresh / np.sqrt(1.0 - link**2))

    c = table.condition[rows]
    signs = np.sign(table.mean)[c, None]
    free = [np.eye(len(table.mean))[c]]
    if "shift" in told:
        shares = np.eye(int(table.block.max()) + 1)[table.block[rows]]
        free += [shares, shares * signs]
    left, singular, _ = np.linalg.svd(independent(np.hstack(free)), full_matrices=False)
    basis = left[:, singular > 1e-9 * singular[0]]
    # A drift shifts all velocities alike, or all in proportion, whatever their sign.
    scatter = (table.y[rows] - table.mean[c]) / table.errors.of_reading(table.mean)[c]
    columns = np.column_stack([table.sequence[rows], scatter, scatter * signs[:, 0]])
    whole = independent(columns)
    time, *changes = (whole - basis @ (basis.T @ whole)).T
    dof, power = len(rows) - basis.shape[1] - 1, float(time @ time)
    if dof < 1 or power <= 1e-9 * float(whole[:, 0] @ whole[:, 0]):
        return None
    chances = []
    for each in changes:
        slope = float(time @ each) / power
        rest = float(np.sum((each - slope * time) ** 2)) / dof
        chances.append(2.0 * t_law.sf(abs(slope) * math.sqrt(power / max(rest, 1e-12)), dof))
    p_value = 2.0 * min(chances)
    if p_value >= _RARE:
        return None
    text = (
        f"The velocities drift with the order in which they were measured (p = {p_value:.1g}, "
        f"below {_RARE:g}); measure the conditions again in random order."
    )
    return Note("drift", text, p_value)
