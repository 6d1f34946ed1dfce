"""Kinds of measured data beside mean velocities, each with a forward model of its own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from stickslip.diagnosis.observables.angle import AngleObservable
from stickslip.diagnosis.observables.combined import Combined
from stickslip.diagnosis.observables.field import FieldObservable
from stickslip.diagnosis.observables.observable import Comparison, Observable
from stickslip.diagnosis.observables.tracking.film import find_films
from stickslip.errors import ScenarioError
from stickslip.measurement.reading import Measurement, Table

__all__ = ["Combined", "Comparison", "Observable", "find_observables"]


def find_observables(measurement: Measurement, threads: int) -> list[Observable]:
    """Observables of all tables of a measurement but those of velocities."""
    scenario = measurement.scenario
    observables: list[Observable] = [*find_films(measurement.tracking, threads)]
    try:
        for title, table in _titled("Static tilt, [[angle]]", measurement.angle):
            observables.append(AngleObservable(table, scenario, title))
        for title, table in _titled("Field calibration, [[field]]", measurement.field):
            observables.append(FieldObservable(table, scenario, title))
    except ScenarioError as error:
        raise ScenarioError(f"{measurement.path}: {error}") from None
    return observables


def _titled(title: str, tables: Sequence[Table]) -> Iterator[tuple[str, Table]]:
    """Tables of one kind with their titles, numbered if there are several."""
    for number, table in enumerate(tables, start=1):
        yield (title if len(tables) == 1 else f"{title} {number}"), table
