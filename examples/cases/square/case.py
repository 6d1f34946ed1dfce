"""Drops of a real square: how well does a body with three constants of impact predict them?"""

from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import minimize

from stickslip import STATE_COLUMNS, Drive, Robot, Scenario, Waveform, rollout

drops = pd.read_csv(Path(__file__).with_name("drops.csv")).to_numpy()
begin = np.zeros((len(drops), len(STATE_COLUMNS)))
begin[:, :6], later = drops[:, 1:7], drops[:, 7:]

side, mass, drag, spin_drag = 49.58e-3, 1.0, 0.49, 0.56  # m, kg, 1/s
still = Drive(mode="program", program=Waveform.hold(1.0, {}))
square = Scenario(
    robot=Robot(length=side, width=side, height=side, mass=mass, magnetization=0.0),
    drive=still,
).replace(
    {
        "contact.adhesion": 0.0,
        "drag.linear": mass * drag,
        "drag.rotational": 0.0,
        "effects.rotational_drag.coefficient": mass * side**2 / 6 * spin_drag,
        "effects.surface_tilt.angle": -3.9e-3,  # gravity against the plate
        "solver.rtol": 1e-6,
    }
)


def errors(constants, which):
    """Predicted minus measured x, z (m) and theta (rad) after 13 frames."""
    restitution, friction, tangential = constants
    plate = square.replace(
        {
            "contact.restitution": restitution,
            "contact.tangential_restitution": tangential,
            "contact.static_friction": friction,
            "contact.kinetic_friction": friction,
        }
    )
    silent = np.zeros((13, 5))
    found = rollout(plate, begin[which], silent, 4e-3, record=("x", "z", "theta"))
    return found.states[:, -1] - later[which]


def loss(constants, which):
    """Drops that went another way count by a logarithm."""
    inside = min(constants) >= 0.0 and max(constants) <= 1.0
    scaled = errors(constants, which) / [5e-3, 4e-3, 0.25] if inside else np.inf
    return np.mean(np.log1p(np.sum(np.square(scaled), axis=-1)))


def shown(error):
    x, z, theta = np.median(np.abs(error), axis=0)
    return f"{1e3 * x:.1f} mm, {1e3 * z:.1f} mm, {theta:.2f} rad"


even = np.arange(len(drops)) % 2 == 0
first = np.array([0.5, 0.1, 0.5])
corners = first + np.vstack([np.zeros(3), np.diag([0.05, 0.03, 0.15])])
fit = minimize(
    loss, first, args=(even,), method="Nelder-Mead", options={"initial_simplex": corners}
)
print("without a bounce:", shown(errors([0.0, 0.0, 0.0], ~even)))
print("fitted:          ", shown(errors(fit.x, even)))
print("held out:        ", shown(errors(fit.x, ~even)))
