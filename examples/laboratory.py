"""A simulated laboratory, so that the answer of a diagnosis is known: its surface is tilted."""

import numpy as np
import pandas as pd

from stickslip import Scenario, simulate

HIDDEN = {
    "contact.kinetic_friction": 0.151,  # believed: 0.145
    "drag.linear": 1.3e-5,  # N s/m, known only in range
}
SCATTER = 0.02  # of a trial, relative
random = np.random.default_rng(1)


def measure(stated: Scenario, drives: pd.DataFrame, tilt: float = 0.03) -> pd.DataFrame:
    """Three trials of each row of settings of `[drive]`: the rows, ``trial``, ``velocity`` (m/s).

    The surface is tilted by `tilt` (rad), which the `stated` scenario does not know. Columns that
    are no setting are passed over.
    """
    robot = stated.replace(HIDDEN | {"effects.surface_tilt.angle": tilt})
    rows, settings = [], [name for name in drives if hasattr(stated.drive, name)]
    for drive in drives[settings].to_dict("records"):
        changes = {f"drive.{name}": value for name, value in drive.items()}
        level = simulate(robot.replace(changes)).mean_velocity
        for trial in (1, 2, 3):
            velocity = level * (1 + SCATTER * random.standard_normal())
            rows.append({**drive, "trial": trial, "velocity": velocity})
    return pd.DataFrame(rows)
