"""Arrays of numbers, which of them are equal, and the door for data.

Every array of numbers or labels of a user is read here, once. What comes out is a copy: floats that
cannot be written to, or labels. A gap is what a mask hides, None, NaN, NA or NaT.
"""

from __future__ import annotations

import datetime
import functools
import math
import numbers as kinds_of_numbers
import os
import re
from collections.abc import Collection, Hashable, Iterable, Mapping, Sequence
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip._util.cells import LARGEST
from stickslip._util.messages import check_whole, refuse, shown, suggestion
from stickslip._util.note import Note
from stickslip._util.text import is_number
from stickslip._util.units import per_si, si_of, zero_of
from stickslip.errors import ScenarioError

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]


def root_mean_square(values: ArrayLike) -> float:
    """Root mean square of all numbers of an array, in their unit."""
    return float(np.sqrt(np.mean(np.square(values))))


RELATIVE = 1e-6
"""Part of their size, and of the spread of their column, by which equal settings differ at most.
Chosen: finer than any apparatus is set, and wider than the rounding of a table in seven digits."""

_ROUNDED, _LAST_PLACES = 1e-13, 4
"""Part of the spread, and units in the last place of a column's largest number, that are the same.
Chosen: what sums and products leave."""


def to_si(values: Array, per: float) -> Array:
    """Numbers in SI units; by an exact power of ten where there is one, so rounded once."""
    return values if per == 1.0 else values / per if per >= 1.0 else values * (1.0 / per)


def representatives(values: Iterable[float], kept: Collection[float] = ()) -> dict[float, float]:
    """A representative of each value of a column: one number for all that are the same setting.

    Two numbers are the same if they differ by at most 1e-6 of the spread of all and of their size.
    Size alone may be that of an offset, as in dates; the spread alone may be that of many decades.
    Values are grouped from the smallest up: a group takes what equals its first value. A value of
    `kept` stands for its group, else the one that is written shortest.
    """
    ordered = sorted({*values, *kept})
    if not ordered:
        return {}
    spread = ordered[-1] - ordered[0]
    largest = max(abs(ordered[0]), abs(ordered[-1]))
    rounding = max(_ROUNDED * spread, _LAST_PLACES * math.ulp(largest))
    groups: list[list[float]] = []
    for value in ordered:
        within = max(RELATIVE * min(spread, abs(value)), rounding)
        if groups and value - groups[-1][0] <= within:
            groups[-1].append(value)
        else:
            groups.append([value])
    names_of: dict[float, float] = {}
    for group in groups:
        best = min(group, key=lambda value: (value not in kept, len(repr(value)), value))
        names_of |= dict.fromkeys(group, best)
    return names_of


def distinct_rows(values: Array) -> tuple[Array, Indices]:
    """Rows of a matrix without repetitions, as they first come, and which of them each row is."""
    places = dict[bytes, int]()
    which = [places.setdefault(row.tobytes(), len(places)) for row in values]
    return values[np.unique(which, return_index=True)[1]], np.array(which, dtype=np.int64)


def worker_count(count: int | None, name: str) -> int:
    """`count` if it is given, else the number of processors that this process may use.

    A ScenarioError with the `name` says that it is not a whole number above zero.
    """
    if count is None:
        affinity = getattr(os, "sched_getaffinity", None)
        return len(affinity(0)) if affinity else os.cpu_count() or 1
    check_whole(name, count, 1)
    return int(count)


Elements = NDArray[Any]

_NUMBER, _TRUTH, _TEXT, _DATE, _DURATION = "number", "truth", "text", "date", "duration"
_KINDS = {"b": _TRUTH, "i": _NUMBER, "u": _NUMBER, "f": _NUMBER, "U": _TEXT, "M": _DATE,
          "m": _DURATION}  # fmt: skip
"""Kinds of values by the kind of a dtype; an array of objects is asked one by one."""
_CLASSES = {_TRUTH: bool | np.bool_, _TEXT: str, _DATE: datetime.date | np.datetime64,
            _DURATION: datetime.timedelta | np.timedelta64}  # fmt: skip

_FINITE = "finite numbers"
_DIFFERENCE = re.compile(r"^(?:delta[_ ]|Δ|∆)")


def numbers(
    what: str,
    values: object,
    allowed: str = _FINITE,
    *,
    unit: str | None = None,
    differences: bool = False,
    gaps: bool = False,
    finite: bool = True,
) -> Array:
    """The numbers that the values are: a read-only copy of the same shape.

    Dates become seconds from the earliest one, durations seconds, texts the numbers that they
    write.

    Parameters
    ----------
    what : str
        Name of the values in messages.
    values : array_like
    allowed : str
        What messages call allowed.
    unit : str, optional
        Unit to which values that carry one are converted. Without it they may carry none.
    differences : bool
        Whether the values are differences, so that 0.1 degC are 0.1 K.
    gaps : bool
        Whether gaps become NaN. They are refused otherwise.
    finite : bool
        Whether infinite numbers are refused.

    Raises
    ------
    ScenarioError
        If a value is no finite number, if the values are of several kinds, or if their unit cannot
        be converted.
    """
    plain, carried = without_unit(values)
    given, missing = _elements(what, plain, allowed)
    array = _as_floats(what, given, missing, allowed)
    if carried is not None:
        _, per, zero = conversion(what, carried, unit or "-", differences)
        if given.dtype.kind == "b":  # Some libraries keep the unit of what was compared.
            refuse(what, given, f"{allowed}: true and false have no unit")
        array = np.asarray(to_si(array, per) + zero)
    if not gaps:
        hidden = np.ma.isMaskedArray(plain)
        _refuse_any(what, np.full(given.shape, np.nan) if hidden else given, missing, allowed)
    if finite:
        _refuse_any(what, given, ~np.isfinite(array) & ~missing, allowed)
    return locked(array)


def in_columns(
    what: str,
    values: Any,
    names: Sequence[str],
    allowed: str = _FINITE,
    *,
    axes: int | None = None,
    absent: float | None = None,
    unit: str | None = None,
    gaps: bool = False,
    finite: bool = True,
) -> Array:
    """`numbers` with the columns `names` as the last of `axes`; columns with names in any order.

    `absent` is the value of a column that is not there; without it, all have to be.
    """
    is_row = hasattr(values, "index") and not hasattr(values, "columns")
    given = (_by_name(what, values, list(values.index)) if is_row and _is_of(values, "pandas")
             else columns_of(what, values))  # fmt: skip
    checked = functools.partial(numbers, allowed=allowed, unit=unit, gaps=gaps, finite=finite)
    if given is None or not all(isinstance(name, str) for name in given):
        array = checked(what, values)
    else:
        for name in given:
            if name not in names:
                raise ScenarioError(f"{what}: {shown(name)}: {suggestion(str(name), names)}")
        columns = []
        for name in names:
            if name not in given and absent is None:
                raise ScenarioError(f"{what}: no {name}; allowed are all of {', '.join(names)}")
            at, column = f"{what}: {name}", given.get(name, absent)
            if isinstance(column, str):  # one number, which no file wrote
                refuse(at, column, allowed)
            columns.append(checked(at, column))
        try:
            array = locked(np.stack(np.broadcast_arrays(*columns), axis=-1))
        except ValueError:
            refuse(what, values, f"{', '.join(names)} of the same length")
    if array.shape[-1:] != (len(names),) or axes not in (None, array.ndim):
        shape = {None: "(..., {})", 1: "({},)", 2: "(n, {})"}[axes].format(len(names))
        text = f"allowed is shape {shape}, {', '.join(names)}: {allowed}"
        raise ScenarioError(f"{what} of shape {array.shape}: {text}")
    return array


def flat(array: Elements) -> Elements:
    """A matrix of one row or one column, as MATLAB stores each vector, as a vector."""
    return array.reshape(-1) if array.ndim == 2 and 1 in array.shape else array


def row(
    what: str,
    values: object,
    count: int | None = None,
    *,
    unit: str | None = None,
    gaps: bool = False,
) -> Array:
    """`numbers` of shape (n,), not empty; of shape (count,) where a count is given."""
    allowed = "one row of finite numbers"
    array = flat(numbers(what, values, allowed, unit=unit, gaps=gaps))
    if array.ndim != 1 or not len(array):
        refuse(what, values, allowed)
    if np.any(np.abs(array) > LARGEST):
        refuse(what, values, f"numbers up to {LARGEST:g}, as in files")
    if count is not None and len(array) != count:
        raise ScenarioError(f"{what}: {len(array)} values; allowed are {count}")
    return array


def column(what: str, values: object, count: int) -> tuple[Elements, Mask]:
    """A column of settings, shape (count,), and its gaps.

    It holds floats, with NaN in gaps, or texts or truths, which are labels, empty or False in gaps.
    """
    allowed = "numbers or texts"
    plain, carried = without_unit(values)
    given, missing = map(flat, _elements(what, plain, allowed))
    if given.shape != (count,):
        raise ScenarioError(f"{what}: allowed are {count} rows, one for each reading")
    kind = _kind_of_all(what, given, missing, allowed)
    if kind == _TEXT:
        words = ["" if gap else str(value) for value, gap in zip(given, missing, strict=True)]
        return locked(np.array(words)), missing
    if kind == _TRUTH:
        return locked(np.where(missing, False, given).astype(bool)), missing
    si = None if carried is None else si_of(carried)
    return flat(numbers(what, values, allowed, unit=si, gaps=True)), missing


def labels(what: str, values: object, count: int) -> Indices:
    """Numbers of the different labels, from 0, shape (count,); a gap is like no other."""
    given, missing = _elements(what, without_unit(values)[0], "labels")
    if given.shape != (count,):
        raise ScenarioError(f"{what}: allowed is one for each of {count} readings")
    plain = given.tolist()
    texts = any(isinstance(value, str) for value in plain)
    gaps = enumerate(zip(plain, missing.tolist(), strict=True))
    keys = [(k,) if gap else str(one) if texts else one for k, (one, gap) in gaps]
    places = dict[Hashable, int]()
    return np.array([places.setdefault(key, len(places)) for key in keys], dtype=np.int64)


def columns_of(what: str, table: Any) -> dict[Any, Any] | None:
    """Columns of a mapping, a frame, a structured array or a list of rows; None of other arrays."""
    if isinstance(table, Mapping):
        return dict(table)
    if isinstance(table, Sequence) and table and isinstance(table[0], Mapping):
        names = list(table[0])
        if any(not isinstance(row, Mapping) or row.keys() != table[0].keys() for row in table):
            raise ScenarioError(f"{what}: allowed are rows with the same names")
        return {name: [row[name] for row in table] for name in names}
    fields: Any = getattr(getattr(table, "dtype", None), "names", None)
    return _by_name(what, table, list(fields or getattr(table, "columns", ()))) or None


def _by_name(what: str, table: Any, names: Sequence[Any]) -> dict[Any, Any]:
    """Columns by name; one that is there twice is refused."""
    for k, name in enumerate(names):
        if name in names[:k]:
            raise ScenarioError(f"{what}: column {shown(name)} is there twice; allowed is once")
    return {name: table[name] for name in names}


def check_indexes(at: str, given: Mapping[str, Any]) -> None:
    """Refuse pandas objects whose indexes differ: by position other rows would meet."""
    indexes = {
        name: values.index
        for name, values in given.items()
        if _is_of(values, "pandas") and hasattr(values, "index")
    }
    first = next(iter(indexes), "")
    for name, index in indexes.items():
        if not index.equals(indexes[first]):
            raise ScenarioError(
                f"{at}{name} has another index than {first}: allowed are equal indexes, or arrays"
            )


def _is_of(values: object, *libraries: str) -> bool:
    return type(values).__module__.partition(".")[0] in libraries


def are_times(values: object) -> bool:
    """Whether values are dates or durations."""
    return _kind_of(next(iter(np.asarray(values).flat), None)) in (_DATE, _DURATION)


def conversions(at: str, given: Mapping[str, tuple[Any, str | None]]) -> list[Note]:
    """A note on columns that carry another unit than is wanted, which is SI where it is None.

    Some libraries keep a unit in arithmetic that changes it; so a reader has to see it.
    """
    made = {}
    for name, (values, unit) in given.items():
        carried = without_unit(values)[1]
        if carried is not None:
            wanted, *change = conversion(name, carried, unit, name == "sd")
            if change != [1.0, 0.0]:
                made[name] = f"from {carried} to {wanted or 'no unit'}"
    return converted(at, made)


def converted(at: str, made: Mapping[str, str]) -> list[Note]:
    """A note on conversions by the name of the column, if there are any."""
    text = ", ".join(f"{name} {change}" for name, change in made.items())
    note = Note("converted", f"{at}converted as their units say: {text}.", len(made))
    return [note] if made else []


def without_unit(values: Any) -> tuple[Any, str | None]:
    """Values without what other libraries put around them, and the unit that these carry.

    A mask stays: of an array that hides it, it becomes one of NumPy's.
    """
    if hasattr(values, "datetime64"):  # astropy's Time
        return values.datetime64, None
    if _is_of(values, "pandas"):
        # An Index of dates has a `unit`, its resolution, and a Series that of a label.
        quantity = getattr(getattr(values, "array", None), "quantity", None)
        return (values, None) if quantity is None else without_unit(quantity)
    unit = getattr(values, "units", getattr(values, "unit", None))
    carried = None if unit is None else str(unit)
    if _is_of(values, "xarray"):  # which may hold an array with a unit of its own
        inner, own = without_unit(values.data)
        return inner, carried if own is None else own
    plain = values
    if hasattr(values, "set_auto_mask"):  # a variable of netCDF4, which is read as it says
        plain = values[...]
    elif _is_of(values, "scipp"):
        plain = values.values
    elif carried is not None:
        names = ("magnitude", "value", "values")
        plain = next((getattr(values, name) for name in names if hasattr(values, name)), values)
    if isinstance(getattr(plain, "unmasked", None), np.ndarray):  # astropy's Masked
        plain = np.ma.MaskedArray(np.asarray(plain.unmasked), np.asarray(plain.mask))
    hidden = getattr(values, "masks", None)
    if _is_of(values, "scipp") and hidden:
        mask = np.any([each.values for each in hidden.values()], axis=0)
        plain = np.ma.MaskedArray(plain, mask)
    return plain, carried


def conversion(
    what: str, carried: str, unit: str | None, differences: bool = False
) -> tuple[str, float, float]:
    """A wanted unit, how many of the carried one are one of it, and what is added to the quotient.

    A ScenarioError says that it cannot be. None is any: the SI unit. Of `differences`, ``degC`` and
    ``K`` are the same.
    """
    wanted = si_of(carried) if unit is None else unit
    wanted = "" if wanted in ("-", "1") else wanted
    one = _DIFFERENCE.sub("", carried)
    allowed = f"numbers in {wanted}" if wanted else "numbers without a unit"
    refusal = f"{what} is in {carried}: allowed are {allowed}"
    if one != carried and not differences:
        raise ScenarioError(f"{refusal}; {carried} is a unit of differences")
    try:
        if one == wanted or (wanted == "rad" and one in ("", "1", "dimensionless")):
            return wanted, 1.0, 0.0
        si = si_of(wanted or "-")
        zero = 0.0 if differences else zero_of(one) - zero_of(wanted)
        return wanted, per_si(one, si) / per_si(wanted or "-", si), zero
    except ValueError as error:
        hint = "".join(str(error).partition("; Hz")[1:])
        raise ScenarioError(f"{refusal}{hint}") from None


def _elements(what: str, values: Any, allowed: str) -> tuple[Elements, Mask]:
    """Values without a unit in an array of their own, and which of them are gaps."""
    try:
        given = np.array(np.ma.getdata(values) if np.ma.isMaskedArray(values) else values)
        if given.dtype.kind in "USM" and not hasattr(values, "dtype"):
            given = np.array(values, dtype=object)  # numbers beside texts would be texts
    except (TypeError, ValueError, OverflowError):  # rows of several lengths
        refuse(what, values, allowed)
    if given.dtype.kind == "O":
        missing = np.array([_is_gap(one) for one in given.flat], dtype=bool).reshape(given.shape)
    elif given.dtype.kind in "fcmM":
        missing = np.asarray(np.isnat(given) if given.dtype.kind in "mM" else np.isnan(given))
    else:
        missing = np.zeros(given.shape, dtype=bool)
    return given, missing | np.ma.getmaskarray(values) if np.ma.isMaskedArray(values) else missing


def _is_gap(value: Any) -> bool:
    if value is None or value is np.ma.masked or type(value).__name__ in ("NAType", "NaTType"):
        return True
    return isinstance(value, kinds_of_numbers.Number | Decimal | np.generic) and value != value


def _kind_of(value: Any) -> str | None:
    """Kind of an object; None of one that has no place here, such as a complex number."""
    if is_number(value) or isinstance(value, Decimal):
        return _NUMBER
    return next((kind for kind, classes in _CLASSES.items() if isinstance(value, classes)), None)


def _kind_of_all(what: str, given: Elements, missing: Mask, allowed: str) -> str:
    """The kind of all elements but gaps; truths among numbers are numbers."""
    if given.dtype.kind != "O":
        if given.dtype.kind not in _KINDS:
            refuse(what, given, allowed)
        return _KINDS[given.dtype.kind]
    kinds = [_kind_of(value) for value in given[~missing]]
    if set(kinds) == {_TRUTH, _NUMBER}:
        return _NUMBER
    wrong = np.zeros(given.shape, dtype=bool)
    usual = next((kind for kind in kinds if kind != _TEXT), _TEXT)
    wrong[~missing] = [kind is None or kind != usual for kind in kinds]
    _refuse_any(what, given, wrong, allowed)
    return kinds[0] or _NUMBER if kinds else _NUMBER


def _as_floats(what: str, given: Elements, missing: Mask, allowed: str) -> Array:
    """Elements of one kind as numbers, NaN in gaps."""
    kind = _kind_of_all(what, given, missing, allowed)
    if given.dtype.kind == "f":
        result = given.astype(np.float64)
        result[missing] = np.nan
        return result
    result = np.full(given.shape, np.nan)
    sound = ~missing
    if kind in (_DATE, _DURATION):
        result[sound] = _seconds(what, given[sound], kind, allowed)
    elif given.dtype.kind in "biu":
        result[sound] = given[sound]
    else:
        for index in map(tuple, np.argwhere(sound)):
            try:
                result[index] = float(given[index])
            except (TypeError, ValueError, OverflowError):
                wrong = np.zeros(given.shape, dtype=bool)
                wrong[index] = True
                _refuse_any(what, given, wrong, allowed)
    return result


def _seconds(what: str, given: Elements, kind: str, allowed: str) -> Array:
    """Durations, or dates from the earliest one, s, shape (n,)."""
    try:
        if given.dtype.kind == "O":
            zoned = [getattr(value, "tzinfo", None) is not None for value in given]
            exact = [value.astimezone(datetime.timezone.utc).replace(tzinfo=None) if zone else value
                     for value, zone in zip(given, zoned, strict=True)]  # fmt: skip
            given = np.array(exact, dtype="M8[us]" if kind == _DATE else "m8[us]")
        if kind == _DATE:
            if np.datetime_data(given.dtype)[0] in "YM":
                given = given.astype("M8[D]")
            given = given - (given.min() if len(given) else given)
        if np.datetime_data(given.dtype)[0] == "generic":  # NumPy takes them for seconds.
            raise ValueError
        return np.asarray(given / np.timedelta64(1, "s"), dtype=np.float64)
    except (TypeError, ValueError, OverflowError):  # months, or dates of which some have a zone
        refuse(what, given, allowed)


def _refuse_any(what: str, given: Elements, wrong: Mask, allowed: str) -> None:
    """Refuse the first of the wrong elements, if there are any."""
    if wrong.any():
        index = np.argwhere(wrong)[0].tolist()
        where = f": row {index[0]}" if len(index) == 1 else f"{index}" if index else ""
        refuse(f"{what}{where}", given[tuple(index)], allowed)


def locked(array: Elements) -> Elements:
    """The array, which can no longer be written to."""
    array.flags.writeable = False
    return array
