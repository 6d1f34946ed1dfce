"""Kinds of measured data beside mean velocities, each with a forward model of its own."""

from __future__ import annotations

from stickslip.diagnosis.observables.angle import AngleObservable
from stickslip.diagnosis.observables.combined import Combined
from stickslip.diagnosis.observables.field import FieldObservable
from stickslip.diagnosis.observables.observable import Comparison, Observable
from stickslip.diagnosis.observables.tracking.film import FilmObservable
from stickslip.errors import ScenarioError
from stickslip.measurement.reading import Measurement

__all__ = ["Combined", "Comparison", "Observable", "find_observables"]


def find_observables(measurement: Measurement, threads: int) -> list[Observable]:
    """Observables of all tables of a measurement but those of velocities.

    Tables of one kind are numbered in their titles if there are several.
    """
    observables: list[Observable] = [
        FilmObservable(run, number, threads)
        for number, run in enumerate(measurement.tracking, start=1)
    ]
    kinds = (
        ("Static tilt, [[angle]]", AngleObservable, measurement.angle),
        ("Field calibration, [[field]]", FieldObservable, measurement.field),
    )
    try:
        for title, kind, tables in kinds:
            for number, table in enumerate(tables, start=1):
                numbered = title if len(tables) == 1 else f"{title} {number}"
                observables.append(kind(table, measurement.scenario, numbered))
    except ScenarioError as error:
        raise ScenarioError(f"{measurement.path}: {error}") from None
    return observables
