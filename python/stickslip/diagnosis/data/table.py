"""Readings of one kind with their settings: what the diagnosis asks of all data."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from stickslip._util.arrays import (
    RELATIVE,
    Array,
    Indices,
    Mask,
    check_indexes,
    column,
    columns_of,
    conversions,
    flat,
    labels,
    locked,
    numbers,
    representatives,
    row,
)
from stickslip._util.messages import known_arguments, refuse
from stickslip._util.note import Note
from stickslip._util.text import counted
from stickslip._util.units import unit_label
from stickslip.diagnosis.data.checks import ALONE, Check, all_zero, changed_readings
from stickslip.diagnosis.data.errors import estimate, no_finer_than_the_meter
from stickslip.diagnosis.data.settings import Settings
from stickslip.errors import ScenarioError

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from typing_extensions import Self

_FEWEST_RUNS = 3  # that are held out whole
_NAMED = 5  # rows that a note names; of more only the number is given


@known_arguments
class Table:
    """Readings at settings. Rows with equal settings are repeats of one condition.

    Numbers are equal within 1e-6 of their size and of the spread of their column. A row with a gap
    (masked, None, NaN) is left out, and a note says so. Arrays are copied.

    Parameters
    ----------
    settings : mapping, DataFrame or array_like
        Columns by name, each of shape (n,), or an array of shape (n,) or (n, columns): numbers,
        dates (s from the earliest), durations (s) or texts. Frames and structured arrays are read
        by columns.
    y : array_like, shape (n,)
        Readings.
    sd : float or array_like, shape (n,), optional
        Standard deviation of each reading; estimated from repeats, if not given.
    block : array_like, shape (n,), optional
        Block of each reading: readings of one block share an error. One without a label is a
        block of its own.
    run : array_like, shape (n,), optional
        Run of each reading: errors of neighbours in a run may be correlated, in the order of the
        rows.
    name, unit : str
        Of the table, and of its readings.

    Attributes
    ----------
    settings : dict of ndarray, or ndarray
        Columns by name, or an array, as it was given; read-only.
    y : ndarray, shape (n,)
    condition : ndarray of int, shape (n,)
        Of each reading, numbered in the order of their first rows.
    first : ndarray of int, shape (m,)
        First row of each condition.
    mean : ndarray, shape (m,)
        Mean of each condition.
    errors : Errors
        Of `mean`.
    run, order : ndarray, shape (m,), or None
        Run of each condition and its place in it, along which a discrepancy may be correlated. Of
        runs with the same conditions in one order these are the means.
    group : ndarray of int, shape (m,)
        Conditions that are held out together, numbered from 0.
    rows : ndarray of int, shape (n,)
        Numbers of the rows among those that were given.

    Raises
    ------
    ScenarioError
        If lengths or pandas indexes differ, a number is not finite, or an array carries a unit
        that is not converted to that of the readings.
    """

    run: Indices | None = None
    order: Array | None = None
    settings: Any
    whole: Table | None = None
    """The table that a model predicts, of which this one has the rows `kept`; this one, if None."""
    kept: Indices
    window: Sequence[int] = (0,)
    """Rows of the whole one, from that of a reading, of which it is the mean."""
    own_notes: tuple[Note, ...] = ()
    """Notes that do not depend on the errors."""
    side = ""
    """Which of two states it is of, where they are compared."""
    left_out: Sequence[Note] = ()
    """Notes on what was read and is not used."""
    inputs: Mapping[str, Array] = {}
    """Inputs by name; only a record has such."""
    less: tuple[Table, Indices] | None = None
    """A table and its conditions whose readings are taken off."""
    nominal: Array
    """Predictions of the stated model that `checks` look at, shape (m,)."""
    checks: tuple[Check, ...] = (changed_readings,)
    """Those of readings by themselves, in their order."""
    drawable = True
    """Whether its readings share a unit, so that they are drawn over a setting."""

    def __init__(
        self, settings: Any, y: ArrayLike, *, sd: ArrayLike | None = None,
        block: ArrayLike | None = None, run: ArrayLike | None = None, name: str = "",
        unit: str = "-",
    ) -> None:  # fmt: skip
        self.name, self.unit = str(name), unit
        at = self.at
        columns = columns_of(f"{at}settings", settings)
        beside = {"y": y, "sd": sd, "block": block, "run": run}
        check_indexes(at, {**beside, "settings": settings, **(columns or {})})
        notes: list[Note] = []
        readings = row(f"{at}y", y, unit=unit, gaps=True)
        count = len(readings)
        gap = np.isnan(readings)
        given = _of_array(f"{at}settings", settings, count) if columns is None else columns
        own = {str(key): (values, None) for key, values in given.items()}
        notes += conversions(at, {"y": (y, unit), "sd": (sd, unit), **own})
        read = {}
        for key, values in given.items():
            what = f"{at}settings {key}"
            read[key], missing = column(what, values, count)
            gap = gap | missing
        stated = None if sd is None else stated_errors(f"{at}sd", sd, count, unit)
        gap = gap if stated is None else gap | np.isnan(stated)
        blocks, runs = (
            None if values is None else labels(f"{at}{key}", values, count)[~gap]
            for key, values in (("block", block), ("run", run))
        )
        self.y = locked(readings[~gap])
        read = {key: locked(values[~gap]) for key, values in read.items()}
        self.settings = _as_array(f"{at}settings", settings, read) if columns is None else read
        notes += without_gaps(at, gap)
        same = [_equal(key, values, notes) for key, values in read.items()]
        keys = list(zip(*same, strict=True)) or [()] * len(self.y)
        number = {key: k for k, key in enumerate(dict.fromkeys(keys))}
        self.condition = np.array([number[key] for key in keys], dtype=np.int64)
        self.first = np.unique(self.condition, return_index=True)[1]
        self.group = np.arange(len(number), dtype=np.int64)
        stated = None if stated is None else stated[~gap]
        self.mean, self.errors = estimate(self.y, self.condition, sd=stated, run=runs, block=blocks)
        if sd is None:
            self.errors = no_finer_than_the_meter(self.y, self.condition, self.errors, unit)
        self.rows, self._labels = np.flatnonzero(~gap), {"sd": stated, "block": blocks, "run": runs}
        self.own_notes = tuple(notes)
        placed = None if runs is None else _along_runs(self.condition, runs)
        if placed is not None:
            self.run, self.order = placed
            if len(np.unique(self.run)) >= _FEWEST_RUNS:
                self.group = self.run  # a whole run is held out

    def __getitem__(self, column: str) -> Array:
        """A column of the settings, shape (n,), read-only."""
        return np.asarray(self.settings[column])

    def without(self, gone: Mask, why: str) -> Table:
        """The same without some conditions, and a note on their rows that ends with `why`."""
        kept = ~gone[self.condition]
        beside = {key: None if one is None else one[kept] for key, one in self._labels.items()}
        settings = self.settings
        if isinstance(settings, dict):
            settings = {key: values[kept] for key, values in settings.items()}
        else:
            settings = settings[kept]
        made = Table(settings, self.y[kept], **beside, name=self.name, unit=self.unit)
        return made._less(self, kept, why)

    def _less(self, whole: Table, kept: Mask, why: str) -> Self:
        """This table with the notes and the numbers of the rows of the whole one."""
        self._take_of(whole, np.flatnonzero(kept))
        self.rows, lost = whole.rows[kept], whole.rows[~kept]
        text = f"{whole.at}{rows_in_words(lost)}: {why}"
        self.own_notes = (*whole.own_notes, Note("rows-not-computed", text, len(lost)))
        return self

    def _take_of(self, whole: Table, kept: Indices) -> None:
        """A model predicts the whole one, or what that is a part of, of which these rows count."""
        self.whole = whole if whole.whole is None else whole.whole
        self.kept = kept if whole.whole is None else whole.kept[kept]

    @property
    def predicted(self) -> int:
        """How many readings a model has to predict of this table."""
        return len(self)

    def of_conditions(self, predict: Callable[[Table], Array]) -> Array:
        """Predictions of the conditions, (vectors, m), by those of a whole table, (vectors, n)."""
        if self.whole is None:
            return predict(self)[:, self.first]
        rows = self.kept[self.first, None] + self.window
        return np.asarray(predict(self.whole)[:, rows].mean(axis=2))

    @property
    def at(self) -> str:
        """The start of messages."""
        return f"table {self.name}: " if self.name else "table: "

    # ------------------------------------------------------------------ how it is told
    @property
    def notes(self) -> list[Note]:
        """On the rows, and on the errors."""
        return [*self.own_notes, *self.errors.notes]

    @property
    def title(self) -> str:
        """The name of its readings; "" where they have none."""
        return self.name

    @property
    def step(self) -> float | None:
        """Usual time between two readings of a record, s; None of what is no record."""
        return None

    @cached_property
    def named_settings(self) -> Settings:
        """The settings of the conditions as a reader sees them."""
        columns = self.settings
        if not isinstance(columns, dict):
            array = columns.reshape(len(columns), -1)
            names = [f"setting {k + 1}" for k in range(array.shape[1])]
            columns = dict(zip(names if len(names) > 1 else ["setting"], array.T, strict=True))
        shown = {
            str(name): (column[self.first].tolist(), self.setting_unit(str(name)))
            for name, column in columns.items()
        }
        return Settings(shown, len(self.first))

    def setting_unit(self, name: str) -> str:
        """The SI unit of a setting."""
        return "-"

    def elsewhere(self, condition: int, over: str, places: Array) -> Any:
        """Settings as of a condition, at other places of one of them; None if there are none."""
        if not isinstance(self.settings, dict):
            return None
        row, count = self.first[condition], len(places)
        same = {name: np.full(count, column[row]) for name, column in self.settings.items()}
        return same | {over: places}

    def unit_of(self, condition: int) -> str:
        """The SI unit of the readings of a condition."""
        return self.unit

    def shown_unit(self, condition: int) -> tuple[float, str]:
        """Factor from that unit to the one that is shown; readings of one's own keep theirs."""
        return 1.0, unit_label(self.unit_of(condition))

    def figure(
        self, names: Sequence[str], models: Mapping[str, tuple[str, Array]]
    ) -> Figure | None:
        """Its own picture, of a table that is not drawn over a setting; None without one.

        `models` are the recalibrated one first: by label the colour, and values of the parameters
        `names`.
        """
        return None

    # ------------------------------------------------------------------ what is wrong with it
    def data_fault(self, stated: Array, alone: bool = True) -> Note | None:
        """A fault of the readings, before any cause is blamed; None of sound ones.

        `stated` are predictions of the stated model, shape (m,). A table that is not `alone` may
        say little: others can tell causes apart.
        """
        table = self.having(nominal=stated)
        # A difference has no size or sign that could be wrong.
        checks = (all_zero, *(ALONE if alone else ()), *(() if self.less else self.checks))
        return next(filter(None, (check(table) for check in checks)), None)

    def parts(self) -> list[tuple[Indices | slice, str]]:
        """Conditions to compare, and what they are called."""
        return [(slice(None), "The table")]

    def changes(self, y: Array) -> Iterator[tuple[Array, str, str]]:
        """Readings as they may have been meant, with the code of the note and its words."""
        yield -y, "readings-reversed", "of the other sign"

    def having(self, **changes: Any) -> Self:
        """The same with other attributes."""
        made = copy.copy(self)
        vars(made).update(changes)
        return made

    def __len__(self) -> int:
        return len(self.y)

    def __repr__(self) -> str:
        return f"<Table {self.name}: {len(self.y)} readings, {len(self.mean)} conditions>"


def _along_runs(condition: Indices, run: Indices) -> tuple[Indices, Array] | None:
    """Run and place in it of each condition, shape (m,); `condition` and `run` are of readings.

    Runs that share conditions are repeats of one. None if they do not have them in one order: what
    a model misses along them is then no run.
    """
    rows, count = np.argsort(run, kind="stable"), int(condition.max()) + 1
    follows = np.diff(run[rows]) == 0
    pairs = condition[rows][:-1][follows].tolist(), condition[rows][1:][follows].tolist()
    links = csr_array((np.ones(len(pairs[0])), pairs), shape=(count, count))
    whole = connected_components(links, directed=False)[1].astype(np.int64)
    before: dict[int, set[int]] = {k: set() for k in range(count)}
    for one, other in zip(*pairs, strict=True):
        before[other].add(one)
    try:
        order = np.array(list(TopologicalSorter(before).static_order()))
    except CycleError:
        return None
    order = order[np.argsort(whole[order], kind="stable")]
    steps = zip(order[:-1].tolist(), order[1:].tolist(), np.diff(whole[order]) == 0, strict=True)
    if any(same and one not in before[other] for one, other, same in steps):
        return None  # another order would do as well
    return whole, np.argsort(order).astype(float)


def stated_errors(what: str, sd: ArrayLike, count: int, unit: str) -> Array:
    """The stated error of each reading, shape (count,); NaN in gaps."""
    values = flat(numbers(what, sd, unit=unit, differences=True, gaps=True))
    if values.shape not in ((), (count,)) or not np.all(np.isnan(values) | (values > 0.0)):
        refuse(what, sd, f"a number above 0, or {count} of them")
    return np.broadcast_to(values, (count,))


def without_gaps(at: str, gap: Mask) -> list[Note]:
    """A note on the rows that have a gap, if there are any; not all of them may."""
    rows = np.flatnonzero(gap)
    if not len(rows):
        return []
    which = rows_in_words(rows)
    if len(rows) == len(gap):
        raise ScenarioError(f"{at}{which}: every row has a gap; allowed are rows of numbers")
    text = f"{at}{which}: {len(rows)} of {len(gap)} rows have a gap and are left out."
    return [Note("gaps", text, len(rows))]


def rows_in_words(rows: Indices) -> str:
    """``row 3`` or ``rows 3, 5``; of many the first."""
    named = ", ".join(map(str, rows[:_NAMED].tolist()))
    return f"{'row' if len(rows) == 1 else 'rows'} {named}{', ...' if len(rows) > _NAMED else ''}"


def _of_array(what: str, settings: Any, count: int) -> dict[Any, Any]:
    """Columns of an array of settings, shape (n,) or (n, columns), by number."""
    # Rows of a list may have numbers beside texts, and an array a unit.
    array = settings if hasattr(settings, "dtype") else np.array(settings, dtype=object)
    if not 1 <= np.ndim(array) <= 2 or len(array) != count:
        raise ScenarioError(f"{what}: allowed are {count} rows, one for each reading")
    return dict(enumerate(array.T)) if np.ndim(array) == 2 else {0: settings}


def _as_array(what: str, settings: Any, columns: Mapping[Any, Array]) -> Array:
    """The columns as an array of the dimensions that were given."""
    if len({values.dtype.kind == "U" for values in columns.values()}) > 1:
        raise ScenarioError(f"{what}: texts beside numbers: allowed are columns by name")
    several = np.ndim(settings) == 2
    return locked(np.stack(list(columns.values()), axis=1)) if several else columns[0]


def _equal(key: Any, values: Array, notes: list[Note]) -> list[Any]:
    """A representative of each value of a column, the same for equal settings."""
    if values.dtype.kind != "f":
        return list(values)
    same = representatives(values.tolist())
    merged = sum(value != one for value, one in same.items())
    if merged:
        text = f"{key} has {counted(merged, 'value')} within {RELATIVE:g} of another one; "
        notes.append(Note("equal-settings", f"{text}they count as the same setting.", merged))
    return [same[value] for value in values.tolist()]
