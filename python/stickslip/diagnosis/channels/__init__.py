"""Kinds of measured data beside mean velocities, each with a forward model of its own."""

from __future__ import annotations

from stickslip.diagnosis.channels.channel import Channel, Sketch
from stickslip.diagnosis.channels.combined import Combined
from stickslip.measurement.reading import Measurement

__all__ = ["Channel", "Combined", "Sketch", "find_channels"]


def find_channels(measurement: Measurement, threads: int) -> list[Channel]:
    """Channels of all tables of a measurement but those of velocities."""
    return []
