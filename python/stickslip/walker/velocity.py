"""Mean velocities of a measurement as one table, with the stick-slip simulator as its model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import compress
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array
from stickslip._util.columns import index_labels
from stickslip._util.messages import refuse
from stickslip._util.note import Note
from stickslip.diagnosis.data.errors import estimate
from stickslip.diagnosis.data.settings import Settings
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import Value, find_key, in_allowed_case, known_keys
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.notes import STEADY_PULSES
from stickslip.sweeping.dataset import notes_of
from stickslip.sweeping.points import encoded, from_changes
from stickslip.walker.instruments import of_velocities
from stickslip.walker.read_velocity import NOT_SETTINGS, VelocityData, with_index_columns
from stickslip.walker.reading import Measurement
from stickslip.walker.simulated import SimulatedTable
from stickslip.walker.velocity_checks import CHECKS

if TYPE_CHECKING:
    from typing_extensions import Self

Conditions = Sequence[Mapping[str, Value]]
"""Drive settings by dotted key, of each condition."""

_RTOL, _LOOSE = 1e-6, 1e-4
"""Relative tolerances of a simulation and of one of low fidelity. Chosen: the error of the first is
below a twentieth of that of a reading of 1 %. Where it is larger it counts as roughness."""

_FEW_PULSES = 4.0
"""Most pulses of a low-fidelity simulation. Chosen: the first that is measured differs from the
mean of 8 by 0.05 standard errors, and from that of 30 by 0.25."""

_WALKS, _LISTED = 0.1, 4
"""Share of the median speed above which the model is said to move, and conditions that a note
names. Chosen: slower motion may well be read as zero; more are not read."""

_STEPS_A_PULSE = 6000
"""Most steps of a simulation for each of its pulses. Chosen: usual motions take some dozens, and
one in thousands, of endless contacts, as many as all the others together."""


class VelocityTable(SimulatedTable):
    """All [[velocity]] tables of a measurement, pooled: trials at equal drives are repeats.

    The measurement has at least one trial; `seed` is that of the draws of the errors. The order of
    conditions does not depend on that of the rows. Conditions that the stated model cannot compute
    are left out, unless it computes none.

    `scenario` is what neither a condition nor a parameter sets, with the tolerance of the
    simulations. `conditions` are drive settings by dotted key. `stated`, shape (m,), are velocities
    of the stated model, with all constants at the middle of their priors, m/s; NaN where it has
    none. Of each trial, shape (n,): `block` is -1 where it is not known, `curve` is its run, and
    `sequence` its place in time, where the column order tells it; else NaN. A run is a curve, whose
    conditions differ only in frequency, in one sweep of one block of one table; where a table has a
    column order, it is the curve with all its sweeps.
    """

    words = "velocities"

    def __init__(self, measurement: Measurement, *, threads: int = 1, seed: int = 0) -> None:
        self.name, self.unit = "velocity", "m/s"
        self.scenario, self.threads = measurement.scenario.replace({"solver.rtol": _RTOL}), threads
        uncertain = measurement.uncertain
        self.conditions, trials = _pooled(measurement.velocity)
        middle = np.array([[float(prior.value(0.0)) for prior in uncertain.values()]])
        self.stated = self.velocities(self.conditions, list(uncertain), middle)[0]
        self.left_out = []
        trials = self._without_refused(trials)
        self.condition, self.block, self.curve = trials[:, :3].T.astype(np.int64)
        self.y, self.sequence, place = np.ascontiguousarray(trials[:, 3:].T)
        self.first = np.unique(self.condition, return_index=True)[1].astype(np.int64)
        # One error for all tables: of those that state one, the largest.
        known = [data.relative_sd for data in measurement.velocity]
        self.mean, self.errors = estimate(
            self.y, self.condition, run=self.curve, place=place, block=self.block, seed=seed,
            relative=max((sd for sd in known if math.isfinite(sd)), default=math.nan),
        )  # fmt: skip
        if np.all(self.block < 0):
            text = "There is no column block: what trials of a block share is not known."
            note = Note("no-block-column", text)
            self.errors = replace(self.errors, notes=(*self.errors.notes, note))
        self.instruments = of_velocities(self.mean)
        self.group = np.arange(len(self.conditions), dtype=np.int64)
        keys = self.conditions[0]
        self.settings = {
            key: np.array([drive[key] for drive in self.conditions])[self.condition] for key in keys
        }

    @property
    def at(self) -> str:
        return f"{self.name}: "

    @property
    def named_settings(self) -> Settings:
        return settings_of(self.conditions)

    def elsewhere(self, condition: int, over: str, places: Array) -> list[dict[str, Value]]:
        drive = self.conditions[condition]
        return [{**drive, f"drive.{over}": place} for place in places.tolist()]

    def physics(self, names: Sequence[str], values: Array) -> Array:
        """Velocities, m/s; NaN where a run is refused."""
        return self.velocities(self.conditions, names, values)

    def low_fidelity(self, names: Sequence[str], values: Array) -> Array:
        """By fewer pulses and a loose tolerance."""
        loose = [
            {**drive, "solver.rtol": _LOOSE,
             "drive.pulses": min(self._pulses(drive), _FEW_PULSES)}
            for drive in self.conditions
        ]  # fmt: skip
        return self.at_drives(loose).predict(names, values)

    def velocities(self, conditions: Conditions, names: Sequence[str], values: Array) -> Array:
        """Mean velocities at any conditions, m/s, shape (vectors, conditions).

        `names` are scenario keys; NaN where a simulation is refused.
        """
        most = float(self.scenario.get("solver.max_steps"))
        conditions = [
            {**drive, "solver.max_steps": min(most, _STEPS_A_PULSE * self._pulses(drive))}
            for drive in conditions
        ]
        keys = sorted({key for drive in conditions for key in drive})
        settings = np.column_stack(
            [encoded(key, [self._setting(drive, key) for drive in conditions]) for key in keys]
        )
        vectors, count = len(values), len(conditions)
        rows = np.hstack([np.tile(settings, (vectors, 1)), np.repeat(values, count, axis=0)])
        base = self.scenario.to_core()
        made = _core.mean_velocities(base, [*keys, *names], rows, self.threads)
        return made.reshape(vectors, count)

    def at_drives(self, drives: Conditions) -> Self:
        """A table of other drives, to be predicted; it has no readings."""
        return self.having(conditions=list(drives), mean=np.full(len(drives), np.nan))

    def _setting(self, condition: Mapping[str, Value], key: str) -> Value:
        return condition[key] if key in condition else self.scenario.get(key)

    def _pulses(self, condition: Mapping[str, Value]) -> float:
        return float(self._setting(condition, "drive.pulses"))

    def _without_refused(self, trials: Array) -> Array:
        """Leave out the conditions that the stated model cannot compute, if it computes others."""
        sound = np.isfinite(self.stated)
        if sound.all() or not sound.any():
            return trials
        for words in compress(self.named_settings.words, ~sound):
            text = f"The stated model cannot compute {words}; left out."
            self.left_out.append(Note("condition-not-computed", text))
        self.conditions = list(compress(self.conditions, sound))
        self.stated = self.stated[sound]
        trials = trials[sound[trials[:, 0].astype(np.int64)]]
        trials[:, 0] = np.unique(trials[:, 0], return_inverse=True)[1]
        return trials

    # ------------------------------------------------------------------ what is wrong with it
    checks = CHECKS

    def remarks(self) -> list[Note]:
        notes = []
        short = sum(float(drive["drive.pulses"]) < STEADY_PULSES for drive in self.conditions)
        if short:
            text = (
                f"At {short} of {len(self.mean)} conditions the drive has fewer than "
                f"{STEADY_PULSES} pulses, so the mean velocity includes the start-up."
            )
            notes.append(Note("few-pulses", text, short))
        speed = np.abs(self.stated)
        if np.isfinite(speed).any():
            still = np.flatnonzero((self.mean == 0.0) & (speed > _WALKS * np.nanmedian(speed)))
            if len(still):
                names = [self.named_settings.words[k] for k in still[:_LISTED].tolist()]
                more = f" and {len(still) - _LISTED} more" if len(still) > _LISTED else ""
                fastest = float(np.max(speed[still]))
                text = (
                    f"Every reading is zero at {len(still)} of {len(self.mean)} conditions where "
                    f"the stated model moves by up to {1e3 * fastest:.3g} mm/s: "
                    f"{'; '.join(names)}{more}."
                )
                notes.append(Note("stands-still", text, fastest))
        return notes + self._notes_of_runs()

    def _notes_of_runs(self) -> list[Note]:
        """Notes on the stated model's runs at the measured conditions."""
        walked = self.scenario.replace({"record.pull_share": "no"})  # no note asks for it
        points = from_changes(walked, self.conditions)
        rows = points.rows(np.arange(points.count))
        columns, _ = _core.sweep(points.scenario.to_core(), points.keys, rows, self.threads)
        return notes_of(points, columns, "conditions")


def settings_of(conditions: Conditions) -> Settings:
    """Settings of drives as a reader sees them."""
    known = known_keys()
    names = [key for key in known if key in conditions[0]]
    columns = {
        key.removeprefix("drive."): ([drive[key] for drive in conditions], known[key].unit)
        for key in names
    }
    return Settings(columns, len(conditions))


def drive_settings(given: Any, scenario: Scenario) -> list[dict[str, Value]]:
    """Drives that a person writes, by dotted key in SI units.

    `given` is a DataFrame or a list of dicts; every row is a change of `scenario`. Names are dotted
    keys or bare, such as ``frequency``; words are in any case. Columns of measured trials, such as
    ``trial`` and ``velocity``, are passed over. A ScenarioError is raised, with the row (its index
    label, or its number from 0), if a name is no key of ``[drive]`` or a value is not allowed.
    """
    table = with_index_columns(given)
    rows = table.to_dict("records") if hasattr(table, "to_dict") else given
    if not isinstance(rows, Sequence) or not all(isinstance(row, Mapping) for row in rows):
        refuse("conditions", given, "a DataFrame or a list of dicts of settings")
    if not rows:
        raise ScenarioError("conditions: there is no row; allowed is one or more")
    drives = []
    for label, row in zip(index_labels(table) or range(len(rows)), rows, strict=True):
        drive: dict[str, Value] = {}
        with prefixed(f"conditions: row {label}"):
            for name, value in row.items():
                if name not in (*NOT_SETTINGS, "standard_error", "velocity_sd"):
                    key = find_key(f"drive.{str(name).removeprefix('drive.')}", value)
                    # A column of a table has numpy's numbers.
                    value = value.item() if hasattr(value, "item") else value
                    is_word = isinstance(value, str)
                    drive[key.name] = in_allowed_case(key, value.strip()) if is_word else value
            scenario.replace(drive)
        drives.append(drive)
    return drives


def _pooled(tables: Sequence[VelocityData]) -> tuple[list[dict[str, Value]], Array]:
    """Conditions of all tables, and a row for each trial, condition by condition.

    With its condition, block, run, velocity, m/s, order, and place in its run in usual steps. A
    block is -1 and an order NaN where a table does not tell it.
    """
    trials = []
    runs: dict[object, int] = {}
    above = 0
    for table, data in enumerate(tables):
        ordered = bool(np.all(np.isfinite(data.order)))
        rows = zip(data.velocity, data.condition, data.block, data.order, data.sweep, strict=True)
        for velocity, at, block, order, sweep in rows:
            key = tuple(sorted(data.conditions[at].items()))
            curve = tuple(pair for pair in key if pair[0] != "drive.frequency")
            sort = (table, int(block), 0 if ordered else int(sweep), curve)
            block = block + above if block >= 0 else -1
            trials.append((key, block, runs.setdefault(sort, len(runs)), velocity, order, ordered))
        above += int(data.block.max()) + 1
    keys = sorted({trial[0] for trial in trials}, key=_rank)
    number = {key: k for k, key in enumerate(keys)}
    columns = np.array([(number[key], *others) for key, *others in trials], dtype=float)
    columns = columns[np.argsort(columns[:, 0], kind="stable")]
    columns[:, 4] -= np.fmin.reduce(columns[:, 4])  # of dates the digits would be lost
    for run in range(len(runs)):
        mine = np.flatnonzero(columns[:, 2] == run)
        if columns[mine[0], 5]:
            steps = np.diff(np.unique(columns[mine, 4]))
            columns[mine, 5] = columns[mine, 4] / (np.median(steps) if len(steps) else 1.0)
        else:
            columns[mine, 5] = np.arange(len(mine))
    return [dict(key) for key in keys], columns


def _rank(key: tuple[tuple[str, Value], ...]) -> tuple[object, ...]:
    """Words first, then fields, then the frequency: neighbours lie on one curve."""
    words = [value for _, value in key if isinstance(value, str)]
    numbers = [
        float(value)
        for name, value in key
        if not isinstance(value, str) and name != "drive.frequency"
    ]
    return (*words, *numbers, float(dict(key).get("drive.frequency", 0.0)))
