"""Measured data: the measurement file, its tables, and which rows were left out, with reasons."""

from __future__ import annotations

from stickslip.measurement.read_tracking import TrackingRun
from stickslip.measurement.read_velocity import VelocityData
from stickslip.measurement.reading import Measurement, read_measurement
from stickslip.scenario.uncertain import Prior

__all__ = ["Measurement", "Prior", "TrackingRun", "VelocityData", "read_measurement"]
