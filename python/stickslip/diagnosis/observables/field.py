"""Calibration of the coils' field: currents, places, and what a probe read there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from stickslip import _core
from stickslip._util.arrays import Array, Mask
from stickslip._util.root_mean_square import root_mean_square
from stickslip.diagnosis.data.plausibility import magnitude_mismatch, refuse_larger
from stickslip.diagnosis.observables.observable import TableObservable
from stickslip.diagnosis.observables.reading_errors import of_fields
from stickslip.diagnosis.observables.reading_noise import FEWEST, merge, reading_noise
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.facts.sentences import mismatch
from stickslip.measurement.outliers import far_from_a_fit
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import COIL_NAMES

_STRONGEST, _FARTHEST = 1.0, 1.0
"""Largest field (T) and place (m) that are accepted. Chosen: these coils make millitesla within
decimetres, so beyond them a unit is wrong."""

_READING = 5e-7
"""Smallest error of a probe's reading that is believed, T. Chosen: 1 % of the Earth's field."""

_RELATIVE = 1e-3
"""The same relative to the field's root mean square. Chosen: a probe is placed to 0.1 mm and turned
to 2 degrees at the best, which is some 1e-3 each."""

_PLACE = ("x", "y", "z")
_FIELD = ("Bx", "By", "Bz")


class FieldObservable(TableObservable):
    """A table of fields, with the five coils' Biot-Savart field, or their map, as its model.

    The columns are xp, xm, yp, ym, clamp (A), x, y, z (m), Bx, By, Bz (T). `scenario` has what no
    parameter sets. Columns in another unit, and probes that all lie on wires, are refused.
    """

    name = "field"

    def __init__(self, table: Mapping[str, Array], scenario: Scenario, title: str) -> None:
        for what, columns, most, unit in (
            ("field", _FIELD, _STRONGEST, "T"),
            ("place", _PLACE, _FARTHEST, "m"),
        ):
            largest = max(float(np.max(np.abs(table[key]))) for key in columns)
            refuse_larger(title, what, largest, most, unit)
        self._base = scenario.to_core()
        coils = self._base.coils()
        settings = np.stack([table[key] for key in (*COIL_NAMES, *_PLACE)], axis=1)
        fields = np.stack([table[key] for key in _FIELD], axis=1)
        count = len(COIL_NAMES)
        _refuse_outside(coils.box, settings[:, count:], title)
        shares = coils.shares(settings[:, count:], settings[:, :count])
        off = np.asarray(np.isfinite(shares).all(axis=(1, 2)))
        if not off.any():
            raise ScenarioError(f"{title}: every probe lies on the wire of a coil")
        left_out = []
        if not off.all():
            on_wire = {"table": title, "count": int((~off).sum())}
            left_out.append(Fact(Code.PROBES_ON_WIRE, on_wire))
        settings, fields, shares = settings[off], fields[off], shares[off]
        far = _far_rows(shares, fields)
        left_out += [
            Fact(Code.FAR_FIELD, {"table": title, "field": value, "currents": row[:count]})
            for row, value in zip(settings[far].tolist(), fields[far].tolist(), strict=True)
        ]
        _refuse_currents(settings[~far, :count], shares[~far], fields[~far], title)
        merged = merge(settings[~far], fields[~far])
        self.currents, self.points = merged.settings[:, :count], merged.settings[:, count:]
        self.fields = merged.mean
        left, dof = _free_fit(coils.shares(self.points, self.currents), self.fields)
        sd = math.sqrt(float(np.sum(left**2)) / dof) if dof else math.nan
        noise = reading_noise(merged, "free-fit", sd, dof, _smallest_error(self.fields), "T")
        self._set_readings(title, self.fields, merged.count, noise, left_out)
        self.suspects = of_fields(self.fields)
        self.settings = {"currents": self.currents, "place": self.points}

    def physics(self, names: Sequence[str], parameters: Array) -> Array:
        """Bx, By, Bz of each row one after another, T, shape (vectors, 3 m).

        NaN for a geometry that puts a wire on a probe.
        """
        fields = _core.probe_readings(
            self._base, list(names), parameters, self.points, self.currents
        ).reshape(len(parameters), -1)
        fields[np.isnan(fields).any(axis=1)] = np.nan
        return fields


def _refuse_outside(box: tuple[Array, Array] | None, places: Array, title: str) -> None:
    """Refuse places, shape (n, 3), m, that a field map does not know."""
    if box is None:
        return
    outside = np.any((places < box[0]) | (places > box[1]), axis=1)
    if outside.any():
        first = ", ".join(f"{each:g}" for each in places[int(np.argmax(outside))])
        raise ScenarioError(
            f"{title}: {int(outside.sum())} of {len(places)} probes lie outside of coil.map, the "
            f"first at ({first}) m: allowed are probes in the box of the map"
        )


def _free_fit(shares: Array, fields: Array) -> tuple[Array, int]:
    """Residual of free gains of the driven coils, a uniform field and a turn, shape (n, 3), T.

    And its degrees of freedom. `shares`, shape (n, 5, 3), are the fields of each coil, T. A probe
    that is turned a little reads the field and a share of it across: that is no noise.
    """
    driven = np.any(shares != 0.0, axis=(0, 2))
    gains = np.moveaxis(shares[:, driven], 1, 2).reshape(-1, int(driven.sum()))
    made = shares.sum(axis=1)
    turns = np.stack([np.cross(axis, made) for axis in np.eye(3)], axis=-1).reshape(-1, 3)
    design = np.hstack([gains, np.tile(np.eye(3), (len(fields), 1)), turns])
    solution, _, rank, _ = np.linalg.lstsq(design, fields.reshape(-1), rcond=None)
    return fields - (design @ solution).reshape(-1, 3), fields.size - int(rank)


def _far_rows(shares: Array, fields: Array) -> Mask:
    """Rows that no gain and no uniform field bring near the others, if they are few."""

    def left_by(rows: Mask) -> Array | None:
        left, dof = _free_fit(shares[rows], fields[rows])
        return None if dof < FEWEST else left

    return far_from_a_fit(left_by, len(fields), _smallest_error(fields))


def _smallest_error(fields: Array) -> float:
    """Error of a reading below which none is taken, T."""
    return max(_READING, _RELATIVE * root_mean_square(fields))


def _refuse_currents(currents: Array, shares: Array, fields: Array, title: str) -> None:
    """Refuse currents, shape (n, 5), A, that could not make such fields, shape (n, 3), T.

    `shares`, shape (n, 5, 3), are the fields of each of the stated coils with them, T.
    """
    read, made, most = map(
        root_mean_square, (fields, shares.sum(axis=1), np.abs(shares).sum(axis=1))
    )
    # Coils that are stronger than stated, or wound the other way, could make as much as `most`.
    usual = float(np.clip(read, made, most))
    far = magnitude_mismatch(read, usual, "T")
    if far is not None:
        strongest = int(np.argmax(np.max(np.abs(shares), axis=(0, 2))))
        largest = float(np.max(np.abs(currents[:, strongest])))
        raise ScenarioError(
            f"{title}: with currents of up to {largest:.4g} A in column {COIL_NAMES[strongest]} "
            f"the fields are {mismatch(far, 'what the stated coils make of them')}"
        )
