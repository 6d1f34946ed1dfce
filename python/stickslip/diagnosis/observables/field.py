"""Calibration of the coils' field: currents, places, and what a probe read there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.diagnosis.data.unit_check import magnitude_mismatch, refuse_larger
from stickslip.diagnosis.model.problem import Uncertain
from stickslip.diagnosis.observables.coil_field import CoilField
from stickslip.diagnosis.observables.field_noise import estimate, far_rows
from stickslip.diagnosis.observables.observable import ReportSection
from stickslip.diagnosis.observables.repeats import merge
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from stickslip.facts.sentences_of_data import mismatch
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.coils import COIL_NAMES

Array = NDArray[np.float64]

_STRONGEST, _FARTHEST = 1.0, 1.0
_PLACE = ("x", "y", "z")
_FIELD = ("Bx", "By", "Bz")


class FieldObservable:
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
    nuisance: tuple[Uncertain, ...] = ()

    def __init__(self, table: Mapping[str, Array], scenario: Scenario, title: str) -> None:
        self.title = title
        _refuse_units(table, title)
        settings = np.stack([table[key] for key in (*COIL_NAMES, *_PLACE)], axis=1)
        fields = np.stack([table[key] for key in _FIELD], axis=1)
        off = _off_wires(settings, scenario)
        if not off.any():
            raise ScenarioError(f"{title}: every probe lies on the wire of a coil")
        settings, fields = settings[off], fields[off]
        count = len(COIL_NAMES)
        shares = self._model(settings, scenario).nominal
        far = far_rows(shares, fields)
        _refuse_currents(settings[~far, :count], shares[~far], fields[~far], title)
        merged = merge(settings[~far], fields[~far])
        self.model = self._model(merged.settings, scenario)
        self.fields = merged.mean
        self.observed = merged.mean.reshape(-1)
        reading, note = estimate(self.model.nominal, merged)
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

    @staticmethod
    def _model(settings: Array, scenario: Scenario) -> CoilField:
        count = len(COIL_NAMES)
        return CoilField(settings[:, count:], settings[:, :count], scenario)

    def predict(self, names: Sequence[str], parameters: Array) -> Array:
        """Bx, By, Bz of each row one after another, T, shape (vectors, 3 m)."""
        return self.model(names, parameters).reshape(len(parameters), -1)

    def report_sections(
        self,
        names: Sequence[str],
        recalibrated: Array,
        extended: Array | None,
        held_out: NDArray[np.bool_],
    ) -> list[ReportSection]:
        """Fields of all rows, with both models."""
        from stickslip.diagnosis.report.figures import against_model

        before = self.predict(names, recalibrated[None, :])[0]
        after = None if extended is None else self.predict(names, extended[None, :])[0]
        held = held_out[::3]
        picture = against_model(
            np.arange(1, len(self.fields) + 1, dtype=float),
            self.observed * 1e3,
            self.sd * 1e3,
            before * 1e3,
            None if after is None else after * 1e3,
            held,
            ("row, by currents and place", "field (mT)"),
            _FIELD,
            joined=False,
        )
        error = [_rms(self.observed - before)]
        if after is not None:
            error.append(_rms(self.observed - after))
        missed = dict(zip(("recalibrated", "extended"), [*error, None], strict=False))
        largest = float(np.max(np.abs(self.observed)))
        numbers: dict[str, object] = {
            "currents": self.model.currents.tolist(),
            "place": self.model.points.tolist(),
            "field": self.fields.tolist(),
            "sd": self.sd.tolist(),
            "recalibrated": before.reshape(-1, 3).tolist(),
            "extended": None if after is None else after.reshape(-1, 3).tolist(),
            "held_out": held.tolist(),
            "rms_recalibrated": error[0],
            "rms_extended": error[1] if after is not None else None,
        }
        line = Fact(Code.FIELD_MISFIT, {**missed, "largest": largest})
        return [ReportSection(self.title, picture, (line,), numbers)]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


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
    read, made, most = map(_rms, (fields, shares.sum(axis=1), np.abs(shares).sum(axis=1)))
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


def _off_wires(settings: Array, scenario: Scenario) -> NDArray[np.bool_]:
    """Rows where the field of the nominal coils is finite."""
    coil = scenario.coil
    coils = _core.CoilSet(coil.side, coil.distance, coil.turns)
    count = len(COIL_NAMES)
    off = np.ones(len(settings), dtype=bool)
    for k, row in enumerate(settings):
        try:
            coils.field(row[None, count:], row[None, :count])
        except ValueError:
            off[k] = False
    return off
