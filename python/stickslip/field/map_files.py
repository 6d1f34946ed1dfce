"""Files of measured fields: CSV and netCDF, and the JSON that a fitted map is stored as."""

from __future__ import annotations

import json
import math
from array import array
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from stickslip._util.extras import naming_the_extra
from stickslip._util.files import NETCDF_SUFFIXES, read_bytes
from stickslip._util.numbers import Array
from stickslip.errors import ScenarioError, prefixed
from stickslip.field.field_map import FieldMap
from stickslip.scenario.csv_cells import read_cells
from stickslip.scenario.keys import meant, refuse
from stickslip.scenario.sections import COIL_NAMES

PLACE = ("x", "y", "z")
FIELD = ("Bx", "By", "Bz")

FORMAT_VERSION = 1

_UNITS = {**dict.fromkeys(PLACE, "m"), **dict.fromkeys(FIELD, "T/A")}
_COLUMNS = {name: _UNITS.get(name) for name in (*PLACE, "coil", *FIELD)}
_SAME_UNITS = {"m": ("m", "metre", "meter"), "T/A": ("T/A", "T A-1", "T A^-1", "T A**-1")}

_MOST_ROWS = 500_000  # chosen: a grid of 46 planes each way for five coils
_MOST_BYTES = _MOST_ROWS * 25 * len(_COLUMNS)
_MOST_JSON = 1 << 20
_SUFFIXES = (".csv", ".json", *NETCDF_SUFFIXES)


def read_map(path: str | PathLike[str]) -> FieldMap:
    """See `FieldMap.from_file`."""
    path = Path(path)
    suffix = path.suffix.lower()
    with prefixed(path):
        if suffix == ".json":
            return _stored(read_bytes(path, _MOST_JSON, "map of a scenario"))
        if suffix in NETCDF_SUFFIXES:
            return FieldMap.from_coils(_netcdf_samples(path), path.name)
        if suffix != ".csv":
            raise ScenarioError(f"allowed are names that end in {', '.join(_SUFFIXES)}")
        data = read_bytes(path, _MOST_BYTES, "field map")
        samples, lines = _csv_samples(data)
        return FieldMap.from_coils(samples, path.name, lines)


def map_text(field_map: FieldMap) -> str:
    """A fitted map as JSON, of which `stored_map` makes the same again to the last bit."""
    coils = {
        name: {
            "points": field_map.points[k],
            "field": field_map.field[k],
            "residual": field_map.residual[k],
            "coefficients": field_map.coefficients[k],
        }
        for k, name in enumerate(COIL_NAMES)
    }
    head = {"stickslip_map": FORMAT_VERSION, "source": field_map.source}
    return json.dumps({**head, "low": field_map.low, "high": field_map.high, "coils": coils})


def stored_map(text: str | bytes) -> FieldMap:
    """The map of which `map_text` gave the text.

    Another text is a ValueError, KeyError, TypeError or, where a number is beyond those of its
    kind, an OverflowError.
    """
    found: dict[str, Any] = json.loads(text)
    if found["stickslip_map"] != FORMAT_VERSION:
        raise ValueError("another version")
    coils = [found["coils"][name] for name in COIL_NAMES]
    return FieldMap(
        _numbers(found["low"], 3),
        _numbers(found["high"], 3),
        tuple(_numbers(each["coefficients"]) for each in coils),
        tuple(float(each["residual"]) for each in coils),
        tuple(float(each["field"]) for each in coils),
        tuple(int(each["points"]) for each in coils),
        str(found["source"]),
    )


def _numbers(values: Any, count: int | None = None) -> Any:
    numbers = tuple(float(each) for each in values)
    if count is not None and len(numbers) != count:
        raise ValueError("another number of coordinates")
    return numbers


def _stored(data: bytes) -> FieldMap:
    try:
        return stored_map(data)
    except ScenarioError:
        raise
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError):
        raise ScenarioError(
            "is no fitted map; allowed is the .json that a scenario was written with, or a "
            "measured map as .csv or .nc"
        ) from None


def _csv_samples(data: bytes) -> tuple[list[tuple[Array, Array]], list[Sequence[int]]]:
    """Points and fields of each coil in a file's rows, and the lines of these."""
    found = {name: (array("d"), array("q")) for name in COIL_NAMES}
    for count, (line, (coil,), values) in enumerate(read_cells(data, _COLUMNS)):
        if coil not in found:
            _refuse_coil(f"row {line}, column coil", coil)
        if count == _MOST_ROWS:
            raise ScenarioError(f"row {line}: allowed are at most {_MOST_ROWS} rows")
        numbers, lines = found[coil]
        numbers.extend(values)
        lines.append(line)
    width = len(PLACE) + len(FIELD)
    tables = [np.frombuffer(own).reshape(-1, width) for own, _ in found.values()]
    samples = [(table[:, :3].copy(), table[:, 3:].copy()) for table in tables]
    return samples, [lines for _, lines in found.values()]


def _refuse_coil(where: str, coil: object) -> None:
    refuse(where, coil, "one of " + ", ".join(COIL_NAMES) + meant(coil, COIL_NAMES))


def _netcdf_samples(path: Path) -> list[tuple[Array, Array]]:
    """The same of the grid of a netCDF file, without places whose field is not a number."""
    with naming_the_extra("a netCDF file"):
        import xarray

    try:
        with xarray.open_dataset(path) as file:
            _check_variables(file)
            data = file[list(FIELD)].load()
    except (ScenarioError, MemoryError):
        raise
    except OSError as error:
        raise ScenarioError(f"cannot be read: {error.strerror or error}") from None
    except Exception:  # whatever HDF5 and its readers raise for another file
        raise ScenarioError("is no netCDF file") from None
    coils = [
        each.decode() if isinstance(each, bytes) else str(each) for each in data["coil"].values
    ]
    for coil in coils:
        if coil not in COIL_NAMES:
            _refuse_coil("coil", coil)
    axes = np.meshgrid(*(data[name].values.astype(float) for name in PLACE), indexing="ij")
    points = np.stack([each.ravel() for each in axes], axis=1)
    samples = []
    for name in COIL_NAMES:
        if coils.count(name) != 1:
            raise ScenarioError(f"coil {name} is there {coils.count(name)} times: allowed is once")
        own = data.isel(coil=coils.index(name)).transpose(*PLACE)
        fields = np.stack([own[each].values.ravel().astype(float) for each in FIELD], axis=1)
        measured = ~np.isnan(fields).all(axis=1)
        samples.append((points[measured], fields[measured]))
    return samples


def _check_variables(file: Any) -> None:
    """Refuse a file that is no map, or too large, before its values are read."""
    dimensions = (*PLACE, "coil")
    for name in (*dimensions, *FIELD):
        _check_variable(file, name, (name,) if name in dimensions else dimensions)
    sizes = [int(file.sizes[name]) for name in dimensions]
    if math.prod(sizes) > _MOST_ROWS:
        said = " x ".join(map(str, sizes))
        raise ScenarioError(
            f"has {said} values over x, y, z and coil: allowed are at most {_MOST_ROWS}"
        )


def _check_variable(data: Any, name: str, dimensions: tuple[str, ...]) -> None:
    """Refuse a variable that is not there, has other dimensions, or a unit that is not SI."""
    if name not in data.variables:
        raise ScenarioError(
            f"the variable {name} is missing: allowed are coordinates {', '.join(PLACE)} and coil, "
            f"and over them {', '.join(FIELD)}"
        )
    found = data[name]
    if set(found.dims) != set(dimensions):
        had = ", ".join(map(str, found.dims)) or "none"
        raise ScenarioError(f"{name} has the dimensions {had}: allowed are {', '.join(dimensions)}")
    if name == "coil":
        return
    if found.dtype.kind not in "iuf":
        raise ScenarioError(f"{name} has values of type {found.dtype}: allowed are numbers")
    unit = found.attrs.get("units")
    # An attribute of netCDF can be a number or an array too.
    if unit is not None and str(unit) not in _SAME_UNITS[_UNITS[name]]:
        refuse(f"units of {name}", unit, f'"{_UNITS[name]}", or no such attribute')
