"""What changed for a walker whose surface was cleaned? Prints what two measurements tell.

Both are simulated, at the same drives with three trials each. The surface is tilted in both, which
nobody knows; cleaning lowers the friction of sliding from 0.165 to 0.135.
"""

import numpy as np
import pandas as pd

from stickslip import Measurement, Prior, Scenario, diagnose, simulate_batch

stated = Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 6})
uncertain = {
    "contact.kinetic_friction": Prior("normal", 0.15, 0.02),
    "drag.linear": Prior("log-uniform", 3e-6, 3e-5),
}
drives = [(way, f) for way in ("+x", "-x") for f in (20.0, 30.0, 45.0, 60.0, 80.0, 100.0)]


def measured(friction: float, seed: int) -> Measurement:
    """Velocities with an error of 1 %."""
    true = stated.replace(
        {"contact.kinetic_friction": friction, "effects.surface_tilt.angle": 0.01}
    )
    runs = simulate_batch(
        [true.replace({"drive.direction": way, "drive.frequency": f}) for way, f in drives]
    )
    random = np.random.default_rng(seed)
    rows = [
        {"direction": way, "frequency": f, "trial": k,
         "velocity": run.mean_velocity * (1.0 + 0.01 * random.standard_normal())}
        for (way, f), run in zip(drives, runs, strict=True) for k in range(3)
    ]  # fmt: skip
    return Measurement.from_dataframe(pd.DataFrame(rows), stated, uncertain)


result = diagnose(measured(0.135, seed=2), against=measured(0.165, seed=1))
print(result.summary())
