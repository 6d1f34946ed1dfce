"""Calibration of the coils' field: currents, places, and what a probe read there."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array, Mask, root_mean_square
from stickslip._util.note import Note
from stickslip.diagnosis.data.errors import FEWEST
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import COIL_NAMES
from stickslip.scenario.scenario import Scenario
from stickslip.walker.instruments import of_fields
from stickslip.walker.outliers import far_from_a_fit
from stickslip.walker.simulated import SimulatedTable, of_readings

_READING, _RELATIVE = 5e-7, 1e-3
"""Smallest error of a probe's reading, in T and in the field's root mean square. Chosen: 1 % of the
Earth's field; a probe is at best placed to 0.1 mm and turned to 2 degrees, some 1e-3 each."""

_PLACE, _FIELD = ("x", "y", "z"), ("Bx", "By", "Bz")


class FieldTable(SimulatedTable):
    """A table of fields, with the five coils' Biot-Savart field, or their map, as its model.

    `table` has columns xp, xm, yp, ym, clamp (A), x, y, z (m), Bx, By, Bz (T), of shape (n,).
    `scenario` is what no parameter sets. Each component of a field is a reading. Without repeats
    their error is what free gains of the coils, a free uniform field and a free turn of the probe
    leave over. A ScenarioError is raised if every probe is on a wire, or one outside of the field
    map.
    """

    words, section = "fields", "Field calibration, [[field]]"

    def __init__(self, table: Mapping[str, Array], scenario: Scenario, number: int = 0) -> None:
        self.number, self._base, self.left_out = number, scenario.to_core(), []
        currents, points, fields = (
            np.stack([table[key] for key in keys], axis=1) for keys in (COIL_NAMES, _PLACE, _FIELD)
        )
        coils = self._base.coils()
        _refuse_outside(coils.box, points, self.at)
        # Fields of each coil alone, T.
        shares = coils.shares(points, currents)
        used = self._off_wires(shares)
        used[used] = self._near(currents[used], fields[used], shares[used])
        currents, points, fields, shares = (
            array[used] for array in (currents, points, fields, shares)
        )
        settings = dict(zip((*COIL_NAMES, *_PLACE), np.hstack([currents, points]).T, strict=True))
        columns = {key: np.repeat(values, 3) for key, values in settings.items()}
        columns["component"] = np.tile(_FIELD, len(fields))
        smallest = _smallest(fields)
        super().__init__(columns, fields.reshape(-1), sd=smallest, name="field", unit="T")
        self.group //= 3
        rows = self.first[::3] // 3
        self.currents, self.points = currents[rows], points[rows]
        self.errors = of_readings(self.y, _design(shares), self.condition, smallest, "T")
        self.instruments = of_fields(self.mean)

    def setting_unit(self, name: str) -> str:
        return "m" if name in _PLACE else "A"

    def physics(self, names: Sequence[str], values: Array) -> Array:
        """Bx, By, Bz of each condition one after another, T.

        NaN for a geometry that puts a wire on a probe.
        """
        seen = _core.probe_readings(self._base, list(names), values, self.points, self.currents)
        seen = seen.reshape(len(values), -1)
        seen[np.isnan(seen).any(axis=1)] = np.nan
        return seen

    def changes(self, y: Array) -> Iterator[tuple[Array, str, str]]:
        yield from super().changes(y)
        vectors = y.reshape(-1, 3)
        for order in itertools.permutations(range(3)):
            for sign in (1.0, -1.0):
                exchanged = sign * vectors[:, order]
                yield exchanged.ravel(), "readings-exchanged", "one with its components exchanged"
        for k, name in enumerate("xyz"):
            mirrored = vectors * np.where(np.arange(3) == k, -1.0, 1.0)
            yield mirrored.ravel(), "readings-reversed", f"one with the other sign of B{name}"

    def _off_wires(self, shares: Array) -> Mask:
        """Rows whose probe lies on no wire, where there is no field."""
        off = np.asarray(np.isfinite(shares).all(axis=(1, 2)))
        if not off.any():
            raise ScenarioError(f"{self.at}every probe lies on the wire of a coil")
        if not off.all():
            count = int(np.sum(~off))
            text = f"Rows whose probe lies on the wire of a coil are not used; {count} left out."
            self.left_out.append(Note("probes-on-wire", text, count))
        return off

    def _near(self, currents: Array, fields: Array, shares: Array) -> Mask:
        """Rows that some gains, uniform field and turn bring near the others."""
        smallest = _smallest(fields)

        def left_by(rows: Mask) -> Array | None:
            design, y = _design(shares[rows]), fields[rows].reshape(-1)
            solution, _, rank, _ = np.linalg.lstsq(design, y, rcond=None)
            few = len(y) - int(rank) < FEWEST
            return None if few else (y - design @ solution).reshape(-1, 3)

        far = far_from_a_fit(left_by, len(fields), smallest)
        for field, amperes in zip(fields[far], currents[far], strict=True):
            text = (
                f"A reading of {_numbers(field)} T with currents {_numbers(amperes)} A is far from "
                "what any gain of the coils gives."
            )
            self.left_out.append(Note("far-field", text, float(np.max(np.abs(field)))))
        return ~far


def _numbers(values: Array) -> str:
    return f"({', '.join(f'{value:.4g}' for value in values)})"


def _design(shares: Array) -> Array:
    """A basis of fields without noise, shape (3 n, columns), from shares, shape (n, 5, 3).

    A probe that is turned a little reads the field and a share of it across: that is no noise.
    """
    driven = np.any(shares != 0.0, axis=(0, 2))
    gains = np.moveaxis(shares[:, driven], 1, 2).reshape(-1, int(driven.sum()))
    made = shares.sum(axis=1)
    turns = np.stack([np.cross(axis, made) for axis in np.eye(3)], axis=-1).reshape(-1, 3)
    return np.hstack([gains, np.tile(np.eye(3), (len(shares), 1)), turns])


def _smallest(fields: Array) -> float:
    """Smallest error of a reading that is believed, T."""
    return max(_READING, _RELATIVE * root_mean_square(fields))


def _refuse_outside(box: tuple[Array, Array] | None, places: Array, at: str) -> None:
    """Refuse places, shape (n, 3), m, outside of the box of a field map."""
    if box is None:
        return
    outside = np.any((places < box[0]) | (places > box[1]), axis=1)
    if outside.any():
        first = ", ".join(f"{place:g}" for place in places[int(np.argmax(outside))])
        raise ScenarioError(
            f"{at}{int(outside.sum())} of {len(places)} probes lie outside of coil.map, the "
            f"first at ({first}) m: allowed are probes in the box of the map"
        )
