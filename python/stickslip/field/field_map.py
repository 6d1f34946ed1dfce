"""The measured field of a user's coils, in place of the formula of square coils."""

from __future__ import annotations

import dataclasses
import json
import math
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from stickslip import _core
from stickslip._util.arrays import Array, in_columns, numbers
from stickslip._util.columns import read_table
from stickslip._util.files import read_bytes, text_writer, write_together
from stickslip._util.messages import known_arguments, meant, refuse
from stickslip._util.recipes import Recipe
from stickslip.errors import ScenarioError, prefixed
from stickslip.field.arrangement import check_arrangement
from stickslip.field.map_fit import fit_coils

_PLACE, _FIELD = ("x", "y", "z"), ("Bx", "By", "Bz")

_RECIPE = Recipe.of(
    {**dict.fromkeys(_PLACE, "m"), "coil": None, **dict.fromkeys(_FIELD, "T/A")}, exact=True
)

_MOST_JSON = 1 << 20  # bytes; chosen: ten times those of a map of the highest degree


@known_arguments
@dataclass(frozen=True)
class FieldMap:
    """Field of the five coils per ampere in a box, as harmonics that were fitted to a measured map.

    Without a current in the box the field is the gradient of a potential that obeys Laplace's
    equation, so that each coil is a sum of regular solid harmonics; see the page on the theory of
    the field. Made by `from_file` or `from_points`. Two maps are equal if they give the same field.

    Parameters
    ----------
    low, high : tuple of float
        Corners of the box, x, y and z, m.
    coefficients : tuple of tuple of float
        Of the harmonics of each coil in the order of `COIL_NAMES`, T/A; l (l + 2) numbers for those
        up to degree l, in the order of ``cpp/stickslip/field/field_map.hpp``.
    residual : tuple of float
        Root mean square residual of each coil's fit, T/A for each of Bx, By and Bz.
    field : tuple of float
        The same of the map itself, T/A.
    points : tuple of int
        Points of each coil.
    source : str
        The file's name, or "" for none.

    Raises
    ------
    ScenarioError
        If the map cannot be simulated: its box does not hold x = y = z = 0, the centre to which the
        drive refers, or a coil is missing.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    coefficients: tuple[tuple[float, ...], ...]
    residual: tuple[float, ...] = dataclasses.field(compare=False)
    field: tuple[float, ...] = dataclasses.field(compare=False)
    points: tuple[int, ...] = dataclasses.field(compare=False)
    source: str = dataclasses.field(default="", compare=False)

    def __post_init__(self) -> None:
        for name in ("coefficients", "residual", "field", "points"):
            _check_count(name, getattr(self, name))
        core = _core.Scenario()
        core.set_map(self.to_core())

    @classmethod
    def from_file(cls, path: str | PathLike[str]) -> FieldMap:
        """Read and fit a CSV file, or read a ``.json`` that a scenario was stored with.

        The columns are x, y, z (m), coil, and Bx, By, Bz (T/A), a row for each point and coil.
        Headings may state other units, such as ``x (mm)``.

        Raises
        ------
        ScenarioError
            If the file cannot be read, a column, coil or value is not allowed, or no field of coils
            fits the values; the message names the file.
        """
        path = Path(path)
        if path.suffix.lower() == ".json":
            with prefixed(path):
                return cls.from_json(read_bytes(path, _MOST_JSON, "map of a scenario"))
        table = read_table(path, _RECIPE)
        places, fields = (
            np.stack([table.columns[name].values for name in names], axis=1)
            for names in (_PLACE, _FIELD)
        )
        coils, lines = table.columns["coil"].texts, table.lines
        names = _core.coil_names
        with prefixed(path):
            for line, coil in zip(lines, coils, strict=True):
                if coil not in names:
                    allowed = f"one of {', '.join(names)}{meant(coil, names)}"
                    refuse(f"row {line}, column coil", coil, allowed)
            chosen = [np.flatnonzero(np.array(coils) == name) for name in names]
            samples = [(places[rows], fields[rows]) for rows in chosen]
            numbers = [[int(lines[row]) for row in rows.tolist()] for rows in chosen]
            return cls._of_coils(samples, path.name, numbers)

    @classmethod
    def from_points(cls, points: ArrayLike, fields: ArrayLike, source: str = "") -> FieldMap:
        """Fit fields that were measured at the same points for all five coils.

        Parameters
        ----------
        points : array_like, shape (n, 3)
            x, y and z, m; in any order, 8 or more.
        fields : array_like, shape (n, 5, 3)
            Bx, By and Bz of each coil in the order of `COIL_NAMES`, T/A.

        Raises
        ------
        ScenarioError
            If a shape or a number is not allowed, or no field of coils fits the values.
        """
        places = in_columns("points", points, _PLACE, axes=2, unit="m")
        values = numbers("fields", fields, unit="T/A")
        shape = (len(places), len(_core.coil_names), len(_FIELD))
        if values.shape != shape:
            raise ScenarioError(f"fields of shape {values.shape}: allowed is shape {shape}")
        return cls._of_coils([(places, of_coil) for of_coil in values.swapaxes(0, 1)], source)

    @classmethod
    def _of_coils(
        cls,
        samples: Sequence[tuple[Array, Array]],
        source: str,
        lines: Sequence[Sequence[int]] | None = None,
    ) -> FieldMap:
        """Fit points, shape (n, 3), m, and fields at them, T/A, of each coil, in a common box.

        `lines` are those of the points in a file, which messages name.
        """
        low, high, fits = fit_coils(samples, lines)
        check_arrangement(samples, lines, fits)
        return cls(
            tuple(low.tolist()),
            tuple(high.tolist()),
            tuple(tuple(fit.coefficients.tolist()) for fit in fits),
            tuple(fit.residual for fit in fits),
            tuple(fit.field for fit in fits),
            tuple(fit.points for fit in fits),
            source,
        )

    def to_json(self) -> str:
        """The fitted map as JSON, from which `from_json` makes the same bits."""
        content = dataclasses.asdict(self)
        return json.dumps({**content, "crc32": _checksum(content)})

    def write(self, path: str | PathLike[str]) -> None:
        """Write the JSON file that `from_file` reads."""
        write_together({Path(path): text_writer(self.to_json())})

    @classmethod
    def from_json(cls, text: str | bytes) -> FieldMap:
        """The map of a text from `to_json`; a ScenarioError for another text."""
        try:
            parts = json.loads(text)
            # A file of an earlier version has no checksum, and a damaged one may have another key.
            if parts.pop("crc32", None) not in (None, _checksum(parts)) or {*parts} != _FIELDS:
                raise ValueError("damaged")
            (x0, y0, z0), (x1, y1, z1) = map(_floats, (parts["low"], parts["high"]))
            return cls(
                (x0, y0, z0),
                (x1, y1, z1),
                tuple(map(_floats, parts["coefficients"])),
                _floats(parts["residual"]),
                _floats(parts["field"]),
                tuple(int(count) for count in parts["points"]),
                str(parts["source"]),
            )
        except ScenarioError:
            raise
        except (AttributeError, KeyError, TypeError, ValueError, OverflowError, RecursionError):
            raise ScenarioError(
                "is no fitted map, or a damaged one; allowed is the .json that a scenario was "
                "written with, or a measured map as .csv"
            ) from None

    @property
    def degrees(self) -> tuple[int, ...]:
        """Highest degree of the harmonics of each coil."""
        return tuple(round((len(block) + 1) ** 0.5) - 1 for block in self.coefficients)

    @property
    def relative_residual(self) -> tuple[float, ...]:
        """`residual` over `field`, 0 for a coil without a field."""
        pairs = zip(self.residual, self.field, strict=True)
        return tuple(left / field if field else 0.0 for left, field in pairs)

    def to_core(self) -> _core.FieldMap:
        """The map for the compiled core."""
        return _core.FieldMap(self.low, self.high, self.coefficients)

    def __str__(self) -> str:
        worst = int(np.argmax(self.relative_residual))
        box = ", ".join(
            f"{axis} {1e3 * low:.3g} to {1e3 * high:.3g}"
            for axis, low, high in zip("xyz", self.low, self.high, strict=True)
        )
        strength = math.sqrt(3.0)  # of the vector, where `field` and `residual` are of a component
        left = strength * self.residual[worst]
        # What a unit that slipped would show.
        sizes = ", ".join(
            f"{name} {1e3 * strength * size:.3g}"
            for name, size in zip(_core.coil_names, self.field, strict=True)
        )
        return (
            f"{self.source or 'a map'} (harmonics up to degree {max(self.degrees)}; rms residual "
            f"{left:.2g} T/A, {self.relative_residual[worst]:.2g} of the field, at most, "
            f"coil {_core.coil_names[worst]}; {box} mm; rms strength of the field {sizes} mT/A)"
        )

    def __repr__(self) -> str:
        return f"<FieldMap: {self}>"


_FIELDS = {field.name for field in dataclasses.fields(FieldMap)}


def _checksum(content: dict[str, Any]) -> int:
    return zlib.crc32(json.dumps(content).encode())


def _floats(values: Iterable[Any]) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def _check_count(name: str, given: Sequence[object]) -> None:
    if len(given) != len(_core.coil_names):
        raise ScenarioError(
            f"{name} of {len(given)} coils: allowed is one for each of {len(_core.coil_names)}"
        )
