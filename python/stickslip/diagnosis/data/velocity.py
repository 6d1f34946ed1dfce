"""Mean velocities of a measurement as one table, with the stick-slip simulator as its model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import compress

import numpy as np

from stickslip import _core
from stickslip._util.numbers import Array
from stickslip.diagnosis.data.errors import estimate
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.terms.instruments import of_velocities, read_by
from stickslip.measurement.read_velocity import VelocityData
from stickslip.measurement.reading import Measurement
from stickslip.scenario.keys import Value, known_keys
from stickslip.scenario.uncertain import Prior
from stickslip.simulation.note import Note

Conditions = Sequence[Mapping[str, Value]]
"""Drive settings by dotted key, of each condition."""

TOLERANCES = (1e-4, 1e-5, 1e-6)
"""Relative tolerances of the simulator that are tried, the loosest first. Chosen: decades."""

_MODEL_ERROR = 0.05
"""Largest error of a simulation beside that of the data. Chosen: derivatives are taken over steps
whose effect is about the latter."""

_VECTORS, _QUANTILE = 8, 0.75
"""Draws of the constants at which tolerances are judged, and the quantile of the errors that
counts. Chosen: at one draw of four the motion may jump, where no tolerance helps."""

_FEW_PULSES = 4.0
"""Most pulses of a low-fidelity simulation. Chosen: the first that is measured differs from the
mean of 8 by 0.05 standard errors, and from that of 30 by 0.25."""

_LABORATORY = {"T": ("mT", 1e3), "s": ("ms", 1e3)}
"""Units that a laboratory uses in place of SI units, and the factor to them."""


class VelocityTable(Table):
    """All [[velocity]] tables of a measurement, pooled: trials at equal drives are repeats.

    The order of conditions does not depend on that of the rows. A run is a curve, whose conditions
    differ only in frequency, in one sweep of one set-up of one table; where a table has a column
    order, it is the curve with all its sweeps.

    Parameters
    ----------
    measurement : Measurement
        With at least one trial.
    threads : int
    seed : int
        Of the draws at which tolerances are judged, and of those of the errors.

    Attributes
    ----------
    scenario : Scenario
        What neither a condition nor a parameter sets, with the finest tolerance in use.
    conditions : list of dict
        Drive settings by dotted key, with ``solver.rtol``: the loosest tolerance whose error is far
        below that of the data.
    stated : ndarray, shape (m,)
        Velocities of the stated model, with all constants at the middle of their priors, m/s; NaN
        where it has none.
    refusal : str or None
        Why the stated model is refused, if it is.
    block : ndarray of int, shape (n,)
        Set-up of each trial; -1 where it is not known.
    curve : ndarray of int, shape (n,)
        Run of each trial.
    sequence : ndarray, shape (n,)
        Place of each trial in time, where the column order tells it; else NaN.
    simulated : int
        Number of simulations so far.

    The others are those of `Table`. Conditions that the stated model cannot compute are left out,
    unless it computes none.
    """

    nuisance = ()

    def __init__(self, measurement: Measurement, *, threads: int = 1, seed: int = 0) -> None:
        self.name, self.unit = "velocity", "m/s"
        self.scenario, self.threads, self.simulated = measurement.scenario, threads, 0
        self._words = {
            key.name: list(key.words) for key in known_keys().values() if key.kind == "word"
        }
        uncertain = measurement.uncertain
        self.conditions, trials = _pooled(measurement.velocity)
        middle = np.array([[float(prior.value(0.0)) for prior in uncertain.values()]])
        self.stated = self.velocities(self.conditions, list(uncertain), middle)[0]
        self.refusal = measurement.refusal()
        self.left_out: list[Note] = []
        trials = self._without_refused(trials)
        self.condition, self.block, self.curve = trials[:, :3].T.astype(np.int64)
        self.y, self.sequence, place = np.ascontiguousarray(trials[:, 3:].T)
        self.first = np.unique(self.condition, return_index=True)[1].astype(np.int64)
        # One error for all tables: of those that state one, the largest.
        known = [each.relative_sd for each in measurement.velocity]
        self.mean, self.errors = estimate(
            self.y, self.condition, run=self.curve, place=place, setup=self.block, seed=seed,
            relative=max((each for each in known if math.isfinite(each)), default=math.nan),
        )  # fmt: skip
        self.notes = list(self.errors.notes)
        if np.all(self.block < 0):
            text = "There is no column block: what trials of a set-up share is not known."
            self.notes.append(Note("no-block-column", text))
        self.suspects = of_velocities(self.mean)
        self.places = _places(self.conditions)
        self.group = np.arange(len(self.conditions), dtype=np.int64)
        self.run = self.order = None
        rtol = self._loosest_tolerances(uncertain, seed)
        self.scenario = self.scenario.replace({"solver.rtol": float(np.min(rtol))})
        for each, own in zip(self.conditions, rtol.tolist(), strict=True):
            each["solver.rtol"] = own
        keys = self.conditions[0]
        self.settings = {
            key: np.array([each[key] for each in self.conditions])[self.condition] for key in keys
        }

    def predict(self, names: Sequence[str], values: Array) -> Array:
        """Velocities as they are read, m/s, shape (vectors, m); NaN where a run is refused.

        `names` are scenario keys and parameters of `suspects`; `values` have the shape (vectors,
        names).
        """
        return self._read(self.conditions, names, values)

    def low_fidelity(self, names: Sequence[str], values: Array) -> Array:
        """The same by fewer pulses and a loose tolerance."""
        pulses = [float(self._setting(each, "drive.pulses")) for each in self.conditions]
        loose = [
            {**each, "solver.rtol": TOLERANCES[0], "drive.pulses": min(count, _FEW_PULSES)}
            for each, count in zip(self.conditions, pulses, strict=True)
        ]
        return self._read(loose, names, values)

    def velocities(self, conditions: Conditions, names: Sequence[str], values: Array) -> Array:
        """Mean velocities at any conditions, m/s, shape (vectors, conditions).

        `names` are scenario keys; NaN where a simulation is refused.
        """
        keys = sorted({key for each in conditions for key in each})
        settings = np.array(
            [[self._number(key, self._setting(each, key)) for key in keys] for each in conditions]
        )
        vectors, count = len(values), len(conditions)
        rows = np.hstack([np.tile(settings, (vectors, 1)), np.repeat(values, count, axis=0)])
        columns, _ = _core.sweep(self.scenario.to_core(), [*keys, *names], rows, self.threads)
        self.simulated += len(rows)
        velocity = np.where(columns["status"] == 0, columns["mean_velocity"], np.nan)
        return np.asarray(velocity.reshape(vectors, count), dtype=float)

    def _read(self, conditions: Conditions, names: Sequence[str], values: Array) -> Array:
        return read_by(
            self.suspects, names, values,
            lambda keys, own: self.velocities(conditions, keys, own), self,
        )  # fmt: skip

    def _setting(self, condition: Mapping[str, Value], key: str) -> Value:
        return condition[key] if key in condition else self.scenario.get(key)

    def _number(self, key: str, value: Value) -> float:
        """A setting as the core takes it."""
        return float(self._words[key].index(value) if isinstance(value, str) else value)

    def _without_refused(self, trials: Array) -> Array:
        """Leave out the conditions that the stated model cannot compute, if it computes others."""
        sound = np.isfinite(self.stated)
        if sound.all() or not sound.any():
            return trials
        keys = varied(self.conditions)
        for each in compress(self.conditions, ~sound):
            text = f"The stated model cannot compute {in_words(each, keys)}; left out."
            self.left_out.append(Note("condition-not-computed", text))
        self.conditions = list(compress(self.conditions, sound))
        self.stated = self.stated[sound]
        trials = trials[sound[trials[:, 0].astype(np.int64)]]
        trials[:, 0] = np.unique(trials[:, 0], return_inverse=True)[1]
        return trials

    def _loosest_tolerances(self, uncertain: Mapping[str, Prior], seed: int) -> Array:
        """For each condition the loosest tolerance whose error is far below that of the data.

        Judged against a tolerance a hundred times finer than the finest that is tried. Where the
        motion is so sensitive that no tolerance is good enough, one suffices whose error is at most
        1.5 times that of the finest.
        """
        random = np.random.default_rng([seed, 31])
        draws = random.standard_normal((_VECTORS, len(uncertain)))
        constants = zip(uncertain.values(), draws.T, strict=True)
        values = np.array([prior.value(u) for prior, u in constants]).reshape(-1, _VECTORS).T
        finest = min(float(self.scenario.get("solver.rtol")), TOLERANCES[-1])
        tried = np.array([*(each for each in TOLERANCES if each > finest), finest])

        def velocities(rtol: float) -> Array:
            exact = [{**each, "solver.rtol": rtol} for each in self.conditions]
            return self.velocities(exact, list(uncertain), values)

        truth = velocities(max(0.01 * finest, 1e-11))
        apart = np.abs([velocities(rtol) - truth for rtol in tried.tolist()])
        # Where nothing could be computed no tolerance is good.
        apart[:, :, np.isnan(apart).all(axis=(0, 1))] = math.inf
        errors = np.nanquantile(apart, _QUANTILE, axis=1)
        allowed = np.maximum(_MODEL_ERROR * self.errors.sd, 1.5 * errors[-1])
        good = errors <= allowed
        good[-1] = True
        return np.asarray(tried[np.argmax(good, axis=0)])


def varied(conditions: Conditions) -> list[str]:
    """Dotted keys of the settings that are not the same in all conditions."""
    keys = [key for key in known_keys() if key in conditions[0] and key.startswith("drive.")]
    return [key for key in keys if len({each[key] for each in conditions}) > 1]


def in_words(settings: Mapping[str, Value], keys: Sequence[str]) -> str:
    """Some settings of a condition, as in ``mode IPP, frequency 75 Hz, peak 3 mT``."""
    words = []
    for key in keys:
        value, unit = settings[key], known_keys()[key].unit
        if not isinstance(value, str | bool):
            unit, factor = _LABORATORY.get(unit, (unit, 1.0))
            value = f"{float(value) * factor:.5g}"
        words.append(f"{key.split('.')[1]} {value} {unit}".removesuffix(" -").rstrip())
    return ", ".join(words)


def _pooled(tables: Sequence[VelocityData]) -> tuple[list[dict[str, Value]], Array]:
    """Conditions of all tables, and a row for each trial, condition by condition.

    With its condition, set-up, run, velocity, m/s, order, and place in its run in usual steps. A
    set-up is -1 and an order NaN where a table does not tell it.
    """
    trials = []
    runs: dict[object, int] = {}
    above = 0
    for table, data in enumerate(tables):
        ordered = bool(np.all(np.isfinite(data.order)))
        rows = zip(data.velocity, data.condition, data.block, data.order, data.sweep, strict=True)
        for velocity, at, block, order, sweep in rows:
            key = tuple(sorted(data.conditions[at].items()))
            curve = tuple(each for each in key if each[0] != "drive.frequency")
            sort = (table, int(block), 0 if ordered else int(sweep), curve)
            setup = block + above if block >= 0 else -1
            trials.append((key, setup, runs.setdefault(sort, len(runs)), velocity, order, ordered))
        above += int(data.block.max()) + 1
    keys = sorted({each[0] for each in trials}, key=_rank)
    number = {key: k for k, key in enumerate(keys)}
    columns = np.array([(number[key], *others) for key, *others in trials], dtype=float)
    columns = columns[np.argsort(columns[:, 0], kind="stable")]
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


def _places(conditions: Conditions) -> Array | None:
    """Settings that vary, as numbers, shape (m, d); None where none does.

    The frequency by its logarithm; each mode and direction but the first by a column of 0 and 1.
    """
    columns = []
    for key in ("frequency", "peak", "hold", "base"):
        column = np.array([float(each[f"drive.{key}"]) for each in conditions])
        columns.append(np.log(column) if key == "frequency" else column)
    for key in ("drive.mode", "drive.direction"):
        words = np.array([str(each[key]) for each in conditions])
        columns += [(words == word).astype(float) for word in np.unique(words)[1:]]
    varying = [each for each in columns if np.ptp(each) > 0.0]
    return np.stack(varying, axis=1) if varying else None
