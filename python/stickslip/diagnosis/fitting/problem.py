"""A problem: tables of data, a forward model of all their rows, its constants and causes."""

from __future__ import annotations

import itertools
import math
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import solve_triangular
from scipy.stats import chi2 as chi2_law
from scipy.stats import f as f_law

from stickslip._util.arrays import Array, Indices, Mask
from stickslip._util.text import OneLine
from stickslip.diagnosis.data.errors import Errors
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.fitting.options import JUMPING, SMOOTH, Effort
from stickslip.diagnosis.fitting.rivals import Forward, Rivals
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.diagnosis.terms.words import Vocabulary

Model = Callable[[Array], Array]
"""From physical parameters, shape (vectors, size), to predictions of all rows, (vectors, n)."""

RELAXED = (10.0, 100.0)
"""Standard deviations of the coordinate of a constant whose prior is relaxed; its evidence is the
mean over them. Chosen: an error of several stated standard deviations does not surprise, nor does a
slip of the pen."""

FAR_OFF = 10.0
"""Coordinate beyond which a stated constant is wrong. Chosen: no estimate is as far off."""

LOST = 1e3
"""Residual, in errors, of a row that the model cannot compute. Chosen: far beyond any residual of a
usable model, and its square still leaves ten digits to the other rows."""

FINE = 0.25
"""Fineness up to which a coordinate is looked through in a scan, such as the time of an event or a
period. Chosen."""

_FAR_OUT, _UNLIKELY = 4.5, 3.0
"""Largest coordinate that a scan reaches: of an amplitude beyond the largest error that is
searched, of a shape where its prior leaves out one in 400. Chosen."""

HUGE, HUGE_SINGLE = 1e100, 1e30
"""Size of a prediction beyond which it is as good as none, as its square overflows, and in single
precision, where slopes do."""

MANY = 4000
"""Readings from which on a record is long: time and memory count. Chosen."""

_MOST_PREDICTED = 1 << 20  # numbers of predictions at once: 8 MiB; chosen

# Numbers that the cache of predictions keeps, 16 MiB: those of some hundred fits of a large table.
_MOST_CACHED = 1 << 21


class Part(NamedTuple):
    """A table of a problem, its rows, and what it and its readings are called."""

    table: Table
    rows: slice
    name: str
    title: str
    errors: Errors


@dataclass(frozen=True, repr=False, eq=False)
class Problem(OneLine):
    """Tables, the model that is to explain them, and what may be added to it.

    Attributes
    ----------
    tables : tuple of Table
    model : callable
        Its columns are the constants and then the parameters of all causes, in their order.
    constants : tuple of Parameter
    causes : tuple of Cause
    low_fidelity : callable, optional
        A cheaper model for searches from afar, where errors are taken as too large.
    laws : callable, optional
        ``laws(problem, x)`` are laws of a free shape as causes, for constants at the coordinates
        `x`: where no listed cause explains the data.
    unlisted : callable, optional
        ``unlisted(problem, x)`` are effects that nobody listed, which compete and are not claimed.
    wider : callable, optional
        ``wider(problem, causes)`` is the problem with further, last causes.
    forward : callable, optional
        ``forward(conditions, values)`` predicts readings at new conditions.
    words : Vocabulary
        What causes and constants are called.
    rivals : Rivals
        What else can be measured.
    errors : tuple of Errors
        Of the tables.
    simulator_noise : ndarray, shape (n,)
        Scatter of the model itself, in the units of the rows, as a further independent error.
    finer : dict of float
        Fineness as measured, by name of the parameter; empty for simulations.
    shortened : callable, optional
        Of a long record, ``shortened(problem)`` is the problem of its beginning.
    """

    tables: tuple[Table, ...]
    model: Model
    constants: tuple[Parameter, ...]
    causes: tuple[Cause, ...] = ()
    low_fidelity: Model | None = None
    laws: Callable[[Problem, Array], Sequence[Cause]] | None = field(default=None, repr=False)
    wider: Callable[[Problem, Sequence[Cause]], Problem] | None = field(default=None, repr=False)
    unlisted: Callable[[Problem, Array], Sequence[Cause]] | None = field(default=None, repr=False)
    forward: Forward | None = field(default=None, repr=False)
    words: Vocabulary = field(default_factory=Vocabulary, repr=False)
    rivals: Rivals = field(default_factory=Rivals, repr=False)
    errors: tuple[Errors, ...] = ()
    simulator_noise: Array | None = None
    finer: Mapping[str, float] = field(default_factory=dict, repr=False)
    shortened: Callable[[Problem], Problem] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if not self.errors:
            object.__setattr__(self, "errors", tuple(table.errors for table in self.tables))

    @property
    def short(self) -> Problem:
        """The problem in which a search begins: of fewer readings, or this one."""
        # A cached `self` would be a cycle, which holds all predictions until it is collected.
        return self if self.shortened is None else self._beginning

    @cached_property
    def _beginning(self) -> Problem:
        assert self.shortened is not None
        return self.shortened(self)

    # ------------------------------------------------------------------ parameters
    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The constants and then the parameters of all causes."""
        return (*self.constants, *(p for cause in self.causes for p in cause.parameters))

    @property
    def names(self) -> list[str]:
        """Names of `parameters`."""
        return [parameter.name for parameter in self.parameters]

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.parameters)

    @cached_property
    def limits(self) -> Array:
        """Lowest and highest coordinates, shape (2, size)."""
        return np.array([p.limits for p in self.parameters], dtype=float).reshape(-1, 2).T

    @cached_property
    def fineness(self) -> Array:
        """Share of each coordinate's unit over which predictions change, shape (size,)."""
        return np.array([min(p.fineness, self.finer.get(p.name, 1.0)) for p in self.parameters])

    @property
    def at_once(self) -> int:
        """Points whose predictions are asked for at once, at most."""
        return max(_MOST_PREDICTED // max(len(self.y), 1), 1)

    @property
    def is_long(self) -> bool:
        return len(self.y) >= MANY

    @property
    def effort(self) -> Effort:
        """A simulation has a cheaper model: its predictions jump, and cost much."""
        return SMOOTH if self.low_fidelity is None else JUMPING

    @property
    def kept(self) -> Any:
        """Float type of stored effects and slopes: single precision for a long record."""
        return np.float32 if self.is_long else np.float64

    @cached_property
    def nulls(self) -> dict[int, Any]:
        """Recalibrated models by seed, as `starts.recalibrated` finds them."""
        return {}

    @cached_property
    def oscillatory(self) -> Mask:
        """Coordinates that a closer search follows, shape (size,): measured, and fine.

        Simulations are never measured: they jump, and cost too much.
        """
        measured = np.array([parameter.name in self.finer for parameter in self.parameters])
        return measured & (self.fineness <= FINE)

    @cached_property
    def scanned(self) -> Array:
        """Ends between which a coordinate is looked through, shape (2, size)."""
        far = [_FAR_OUT if one.is_amplitude else _UNLIKELY for one in self.parameters]
        return np.clip(self.limits, -np.array(far), far)

    def columns(self, causes: Sequence[Cause]) -> Indices:
        """Coordinates of the parameters of some causes."""
        chosen = {parameter.name for cause in causes for parameter in cause.parameters}
        places = enumerate(self.names[len(self.constants) :], len(self.constants))
        return np.array([k for k, name in places if name in chosen], dtype=np.int64)

    def at(self, cause: Cause) -> int:
        """Coordinate of the constant that a cause frees."""
        return self.names.index(str(cause.frees))

    def free(self, causes: Sequence[Cause]) -> Indices:
        """Coordinates that a model with these causes fits: the constants, and the causes' own."""
        return np.concatenate([np.arange(len(self.constants)), self.columns(causes)])

    def precisions(self, causes: Sequence[Cause]) -> list[Array]:
        """Inverse covariances of the prior of the free coordinates.

        A model's evidence is the mean over them, of which there are several where a constant is
        relaxed or a cause is a law: see `Curve`.
        """
        at, parts = len(self.constants), [np.eye(len(self.free(causes)))]
        for cause in causes:
            if cause.frees is not None:
                index = self.at(cause)
                widths: tuple[float, ...] = RELAXED
                if cause.curve:  # a form has a level, which may be the stated one
                    widths = RELAXED[:1] if cause.has_knots else (1.0, RELAXED[0])
                parts = [_with_block(part, slice(index, index + 1), np.array(width**-2))
                         for part in parts for width in widths]  # fmt: skip
        for cause in sorted(causes, key=lambda law: self.causes.index(law)):
            end = at + len(cause.parameters)
            if cause.curve is not None and cause.has_knots:
                blocks = cause.curve.precisions()
                parts = [_with_block(part, slice(at, end), one) for part in parts for one in blocks]
            at = end
        return parts

    def physical(self, x: Array) -> Array:
        """Values of the parameters at coordinates, shape (vectors, size)."""
        values = np.tile([one.middle for one in self.parameters], (len(x), 1))
        for k in np.flatnonzero(x.any(axis=0)).tolist():  # most causes are absent
            values[:, k] = self.parameters[k].value(x[:, k])
        return values

    # ------------------------------------------------------------------------ rows
    @property
    def table_names(self) -> list[str]:
        """Names of the tables, with their numbers where others are called the same."""
        names = [table.name for table in self.tables]
        return [
            f"{name or 'table'} {k}" if names.count(name) > 1 or not name else name
            for k, name in enumerate(names, start=1)
        ]

    @property
    def titles(self) -> list[str]:
        """Names of the readings of each table."""
        return [table.title or f"table {k}" for k, table in enumerate(self.tables, start=1)]

    @property
    def parts(self) -> list[Part]:
        """Each table with its rows and what it is called."""
        columns = self.tables, self.rows, self.table_names, self.titles, self.errors
        return list(itertools.starmap(Part, zip(*columns, strict=True)))

    @cached_property
    def y(self) -> Array:
        """Means of all conditions of all tables, shape (n,)."""
        return np.concatenate([table.mean for table in self.tables])

    @cached_property
    def rows(self) -> list[slice]:
        """Rows of each table."""
        ends = np.cumsum([0, *(len(table.mean) for table in self.tables)]).tolist()
        return [slice(*pair) for pair in itertools.pairwise(ends)]

    @cached_property
    def group(self) -> Indices:
        """Rows that are held out together, shape (n,), numbered over all tables.

        A stretch of one record and the same of the others are held out together, so that each fit
        has a part of every record.
        """
        records = [isinstance(table, Series) for table in self.tables]
        ends = [int(table.group.max()) + 1 for table in self.tables]
        first = max(itertools.compress(ends, records), default=0)
        groups = []
        for table, is_record, end in zip(self.tables, records, ends, strict=True):
            groups.append(table.group + (0 if is_record else first))
            first += 0 if is_record else end
        return np.concatenate(groups)

    @cached_property
    def dof(self) -> Array:
        """Degrees of freedom of each table's errors."""
        return np.array([errors.dof if errors.dof > 0 else math.inf for errors in self.errors])

    @property
    def freedom(self) -> float:
        """Those of all tables together, by the variance of the sum of their chi-squares."""
        counts = np.array([part.stop - part.start for part in self.rows], dtype=float)
        finite = np.isfinite(self.dof)
        spread = float(np.sum(counts[finite] ** 2 / self.dof[finite]))
        return float(np.sum(counts)) ** 2 / spread if spread else math.inf

    @cached_property
    def sd(self) -> Array:
        """Standard deviation of each row, with the simulator's own noise, shape (n,)."""
        sd = np.concatenate([errors.sd for errors in self.errors])
        return sd if self.simulator_noise is None else np.hypot(sd, self.simulator_noise)

    def covariance(self, table: int) -> Array | None:
        """Covariance of a table's rows; None where they are independent."""
        known = self.errors[table].covariance
        if known is None or self.simulator_noise is None:
            return known
        return np.asarray(known + np.diag(self.simulator_noise[self.rows[table]] ** 2))

    @cached_property
    def _lower(self) -> list[Array | None]:
        covariances = [self.covariance(k) for k in range(len(self.tables))]
        return [None if one is None else np.asarray(np.linalg.cholesky(one)) for one in covariances]

    @cached_property
    def log_det(self) -> float:
        """Logarithm of the determinant of the errors' covariance of all rows."""
        sizes = (self.sd[part] if lower is None else np.diag(lower)
                 for part, lower in zip(self.rows, self._lower, strict=True))  # fmt: skip
        return sum(2.0 * float(np.sum(np.log(size))) for size in sizes)

    def whitened(self, columns: Array) -> Array:
        """Columns, shape (n, k), in which the stated errors are independent and of size 1."""
        result = columns / self.sd[:, None]
        for part, lower in zip(self.rows, self._lower, strict=True):
            if lower is not None:
                result[part] = solve_triangular(lower, columns[part], lower=True)
        return result

    def chi2_of_tables(self, residual: Array) -> Array:
        """Chi-square of each table, shape (tables, vectors), of residuals (vectors, n)."""
        squares = self.whitened(residual.T) ** 2
        return np.stack([np.sum(squares[part], axis=0) for part in self.rows])

    def with_tables(self, tables: Iterable[Table]) -> Problem:
        """The same with other errors of its tables, or readings that the model predicts alike."""
        return replace(self, tables=tuple(tables), errors=())

    def with_shared_errors_at(self, level: Array) -> Problem:
        """The same where errors that conditions share follow the predictions `level`, (n,)."""
        level = np.where(np.isfinite(level), level, self.y)
        moved = [one.at(level[part]) for one, part in zip(self.errors, self.rows, strict=True)]
        return replace(self, errors=tuple(moved))

    # ----------------------------------------------------------------- predictions
    def residuals(self, x: Array, cheap: bool = False) -> Array:
        """Data less predictions at coordinates, shape (vectors, n); `LOST` errors where none."""
        model = self.low_fidelity if cheap and self.low_fidelity is not None else self.model
        with np.errstate(over="ignore", invalid="ignore"):
            predicted = model(self.physical(x))
            lost = ~(np.abs(predicted) < (HUGE_SINGLE if self.is_long else HUGE))
            residual = np.subtract(self.y, predicted, out=predicted)
        return np.where(lost, LOST * self.sd, residual) if lost.any() else residual


def _with_block(whole: Array, part: slice, block: Array) -> Array:
    result = whole.copy()
    result[part, part] = block
    return result


def lack_of_fit(problem: Problem, chi2: float, free: int) -> float:
    """Probability of a larger chi-square of `free` degrees of freedom by the errors alone."""
    if free <= 0:
        return 1.0
    if math.isinf(problem.freedom):
        return float(chi2_law.sf(chi2, free))
    return float(f_law.sf(chi2 / free, free, problem.freedom))


class Cached:
    """A model whose predictions are kept: fits begin where others have ended."""

    def __init__(self, model: Model) -> None:
        self.anew = model
        self._rows: OrderedDict[bytes, Array] = OrderedDict()

    def __call__(self, values: Array) -> Array:
        keys = [row.tobytes() for row in np.ascontiguousarray(values)]
        new = {key: row for key, row in zip(keys, values, strict=True) if key not in self._rows}
        if new:
            made = np.asarray(self.anew(np.stack(list(new.values()))), dtype=float)
            if len(new) == len(keys) and made.size > _MOST_CACHED // 4:
                return np.ascontiguousarray(made)  # they would displace all others
            # A row by itself, as a view would keep all rows of its call.
            self._rows |= {key: row.copy() for key, row in zip(new, made, strict=True)}
        every = len(new) == len(keys)
        rows = np.ascontiguousarray(made) if every else np.stack([self._rows[k] for k in keys])
        for key in dict.fromkeys(keys):
            self._rows.move_to_end(key)
        while len(self._rows) * rows.shape[1] > _MOST_CACHED and len(self._rows) > len(keys):
            self._rows.popitem(last=False)
        return rows
