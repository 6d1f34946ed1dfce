"""Calibration of the coils' field: currents, places, and what a probe read there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip._util.root_mean_square import root_mean_square
from stickslip.diagnosis.data.unit_check import magnitude_mismatch, refuse_larger
from stickslip.diagnosis.observables.field_noise import estimate, far_rows
from stickslip.diagnosis.observables.observable import TableObservable
from stickslip.diagnosis.observables.repeats import merge
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.facts.sentences import mismatch
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import COIL_NAMES

Array = NDArray[np.float64]

_STRONGEST, _FARTHEST = 1.0, 1.0
"""Field (T) and place (m) that no table of this kind has; beyond them a unit is wrong."""

_PLACE = ("x", "y", "z")
_FIELD = ("Bx", "By", "Bz")


class FieldObservable(TableObservable):
    """A table of fields, with the five coils' Biot-Savart field as its model.

    Parameters
    ----------
    table : mapping of ndarray, shape (n,)
        Columns xp, xm, yp, ym, clamp (A), x, y, z (m), Bx, By, Bz (T).
    scenario : Scenario
        What no parameter sets.
    title : str
        Of the table, in messages and in the report.

    Raises
    ------
    ScenarioError
        If a column is in another unit, or no probe is off the wires.
    """

    name = "field"
    components = 3

    def __init__(self, table: Mapping[str, Array], scenario: Scenario, title: str) -> None:
        self.title = title
        _refuse_units(table, title)
        self._base = scenario.to_core()
        coil = scenario.coil
        coils = _core.CoilSet(coil.side, coil.distance, coil.turns)
        settings = np.stack([table[key] for key in (*COIL_NAMES, *_PLACE)], axis=1)
        fields = np.stack([table[key] for key in _FIELD], axis=1)
        count = len(COIL_NAMES)
        shares = coils.shares(settings[:, count:], settings[:, :count])
        off = np.asarray(np.isfinite(shares).all(axis=(1, 2)))
        if not off.any():
            raise ScenarioError(f"{title}: every probe lies on the wire of a coil")
        settings, fields, shares = settings[off], fields[off], shares[off]
        far = far_rows(shares, fields)
        _refuse_currents(settings[~far, :count], shares[~far], fields[~far], title)
        merged = merge(settings[~far], fields[~far])
        self.currents, self.points = merged.settings[:, :count], merged.settings[:, count:]
        self.settings = {"currents": self.currents, "place": self.points}
        self.fields = merged.mean
        self.observed = merged.mean.reshape(-1)
        reading, note = estimate(coils.shares(self.points, self.currents), merged)
        self.sd = np.repeat(reading / np.sqrt(merged.count), 3)
        self.covariance = np.diag(self.sd**2)
        self.group = np.repeat(np.arange(len(merged.mean)), 3)
        self.notes: tuple[Fact, ...] = (note.of(table=title),)
        left_out = []
        if not off.all():
            on_wire = {"table": title, "count": int((~off).sum())}
            left_out.append(Fact(Code.PROBES_ON_WIRE, on_wire))
        left_out += [
            Fact(Code.FAR_FIELD, {"table": title, "field": value, "currents": row[:count]})
            for row, value in zip(settings[far].tolist(), fields[far].tolist(), strict=True)
        ]
        self.left_out = tuple(left_out)

    def predict(self, names: Sequence[str], parameters: Array) -> Array:
        """Bx, By, Bz of each row one after another, T, shape (vectors, 3 m).

        NaN for a geometry that puts a wire on a probe.
        """
        fields = _core.probe_readings(
            self._base, list(names), parameters, self.points, self.currents
        ).reshape(len(parameters), -1)
        fields[np.isnan(fields).any(axis=1)] = np.nan
        return fields


def _refuse_units(table: Mapping[str, Array], title: str) -> None:
    strongest = max(float(np.max(np.abs(table[key]))) for key in _FIELD)
    refuse_larger(title, "field", strongest, _STRONGEST, "T")
    farthest = max(float(np.max(np.abs(table[key]))) for key in _PLACE)
    refuse_larger(title, "place", farthest, _FARTHEST, "m")


def _refuse_currents(currents: Array, shares: Array, fields: Array, title: str) -> None:
    """Refuse currents that could not make such fields in coils like the stated ones.

    Parameters
    ----------
    currents : ndarray, shape (n, 5)
        A.
    shares : ndarray, shape (n, 5, 3)
        Field of each coil with them, T.
    fields : ndarray, shape (n, 3)
        T.
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
