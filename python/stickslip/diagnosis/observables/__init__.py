"""Kinds of measured data beside mean velocities, each with a forward model of its own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from stickslip.diagnosis.observables.angle import AngleChannel
from stickslip.diagnosis.observables.observable import Channel, Sketch
from stickslip.diagnosis.observables.combined import Combined
from stickslip.diagnosis.observables.field import FieldChannel
from stickslip.diagnosis.observables.tracking.film import find_tracking
from stickslip.errors import ScenarioError
from stickslip.measurement.reading import Measurement, Table

__all__ = ["Channel", "Combined", "Sketch", "find_channels"]


def find_channels(measurement: Measurement, threads: int) -> list[Channel]:
    """Channels of all tables of a measurement but those of velocities."""
    scenario = measurement.scenario
    channels: list[Channel] = [*find_tracking(measurement.tracking, threads)]
    try:
        for title, table in _titled("Static tilt, [[angle]]", measurement.angle):
            channels.append(AngleChannel(table, scenario, title))
        for title, table in _titled("Field calibration, [[field]]", measurement.field):
            channels.append(FieldChannel(table, scenario, title))
    except ScenarioError as error:
        raise ScenarioError(f"{measurement.path}: {error}") from None
    return channels


def _titled(title: str, tables: Sequence[Table]) -> Iterator[tuple[str, Table]]:
    """Tables of one kind with their titles, numbered if there are several."""
    for number, table in enumerate(tables, start=1):
        yield (title if len(tables) == 1 else f"{title} {number}"), table
