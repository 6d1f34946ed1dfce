"""An axis of a machine tool: `examples/cases/axis` has the log, its source and licence.

Known is the second fit of its document, with a friction that depends on the direction: half the
difference is 36.9 +- 0.9 N s/m.
"""

from cases.axis import case
from real.sets import Measured, Truth

TRUTH = Truth(("viscous_asymmetry",), values={"viscous_asymmetry.half": (36.86, 0.87)})

SETS = [
    Measured(f"axis, {how}", TRUTH, diagnosed)
    for how, diagnosed in (("ten segments", case.diagnosed), ("20 Hz", case.diagnose_in_time),
                           ("four repeats", case.diagnose_repeats))
]  # fmt: skip
