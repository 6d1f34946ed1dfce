"""Velocities that the simulator made, as measurements in memory."""

import numpy as np
import pandas as pd

from stickslip import Scenario, simulate_batch
from stickslip.diagnosis import Prior
from stickslip.walker.reading import Measurement

SCENARIO = Scenario().replace({"drive.base": 0.5e-3, "drive.pulses": 6, "solver.rtol": 1e-6})
FRICTION = {"contact.kinetic_friction": Prior("normal", 0.145, 0.01)}


def drives(frequencies=(25.0, 40.0, 60.0, 90.0), **others):
    """A row for each direction and frequency."""
    rows = [
        {"direction": way, "frequency": f, **others} for way in ("+x", "-x") for f in frequencies
    ]
    return pd.DataFrame(rows)


def velocities(table):
    """Velocities of the stated model at the rows of a table, m/s."""
    return np.array(
        [
            run.mean_velocity
            for run in simulate_batch(
                [
                    SCENARIO.replace({f"drive.{key}": value for key, value in row.items()})
                    for row in table.to_dict("records")
                ]
            )
        ]
    )


def trials(count=3, noise=0.02, seed=0, table=None):
    """Repeated rows with their velocities."""
    table = drives() if table is None else table
    random = np.random.default_rng(seed)
    repeated = pd.concat([table.assign(trial=k) for k in range(count)], ignore_index=True)
    true = np.tile(velocities(table), count)
    return repeated.assign(velocity=true * (1.0 + noise * random.standard_normal(len(true))))


def measurement(table, uncertain=FRICTION, **known):
    return Measurement.from_dataframe(table, SCENARIO, uncertain, **known)
