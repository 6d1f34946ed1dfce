"""A model of a log as a compiled loop: a joint that sticks, by numba (pip install numba).

python compiled_joint.py
"""

from pathlib import Path

import numpy as np
from numba import njit

from stickslip import Cause, Parameter, Prior, Series, diagnose_model

PARTS = 20  # of the time between two readings


@njit
def speeds(t, torque, inertia, viscous, coulomb):
    """Speeds, rad/s, shape (sets, readings), of torques of the same shape."""
    made = np.zeros(torque.shape)
    for k in range(len(inertia)):
        v = 0.0
        for n in range(len(t) - 1):
            step = (t[n + 1] - t[n]) / PARTS
            kept = np.exp(-viscous[k] / inertia[k] * step)
            for _ in range(PARTS):
                way = np.sign(v) if v != 0.0 else np.sign(torque[k, n])
                pull = torque[k, n] - coulomb[k] * way
                if v == 0.0 and pull * way <= 0.0:
                    break  # it sticks until the torque changes
                last = pull / viscous[k]
                v = last + (v - last) * kept
                if v * way < 0.0:
                    v = 0.0
            made[k, n + 1] = v
    return made


def joint(record, p):
    """The same for a record, whose torque is one row unless a cause acts on it."""
    sets = len(p["inertia"])
    torque = np.broadcast_to(record["torque"], (sets, len(record)))
    return speeds(record.t, torque, p["inertia"][:, 0], p["viscous"][:, 0], p["coulomb"][:, 0])


if __name__ == "__main__":
    path = Path(__file__).with_name("joint.csv")
    t, torque, speed = np.loadtxt(path, delimiter=",", skiprows=1).T
    log = Series(t, speed, {"torque": torque}, unit="rad/s")
    uncertain = [
        Parameter("inertia", Prior("normal", 0.0118, 0.0005), "kg m^2", low=0.005),
        Parameter("viscous", Prior("normal", 0.025, 0.005), "N m s/rad", low=0.005),
    ]
    friction = Parameter("coulomb", unit="N m", low=0.0, high=0.1, size=0.01)
    result = diagnose_model(joint, log, uncertain, [Cause("dry friction", friction)])
    value, sd = result.params.loc["coulomb", ["value", "sd"]]
    print(f"{result.verdict.kind} {value:.3f} N m")
