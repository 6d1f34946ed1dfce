"""The robot as a client of the diagnosis: its measured data, effects, experiments and verdicts."""

from __future__ import annotations

from stickslip._util.prior import Prior
from stickslip.walker.read_tracking import TrackingRun
from stickslip.walker.read_velocity import VelocityData
from stickslip.walker.reading import Measurement, read_measurement

__all__ = ["Measurement", "Prior", "TrackingRun", "VelocityData", "read_measurement"]
