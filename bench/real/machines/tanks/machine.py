"""Two cascaded tanks that overflow: `examples/cases/tanks` has the log, its source and licence."""

from cases.tanks import case
from real.score import Measured, Truth

TRUTH = Truth(("upper_overflow", "lower_overflow", "sensor_end"))

SETS = [Measured("tanks", (1.0, "V"), TRUTH, case.diagnosed)]
