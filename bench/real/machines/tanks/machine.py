"""Two cascaded tanks that overflow: `examples/cases/tanks` has the log, its source and licence."""

from cases.tanks import case
from real.sets import Measured, Truth

TRUTH = Truth(("upper_overflow", "lower_overflow", "sensor_end"))

SETS = [Measured("tanks", TRUTH, case.diagnosed)]
