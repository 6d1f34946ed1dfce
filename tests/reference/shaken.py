"""A surface that moves, and a mass on springs within the body.

The place of the surface is given; its velocity over a step is the way that it goes in it. The inner
mass moves by leapfrog as the body does: its place is known at the steps, its velocity in the body
half-way between them.
"""

from collections import namedtuple

import numpy as np
from numba import njit

# sine (m, 4): harmonic, phase, amplitudes along x and z in m. rests: whether the liquid does.
# inner (10,): mass kg, stiffness N/m, damping N s/m, angle rad, stops m (2), their stiffness and
# damping, duty, and whether there is one; force (n, 3): harmonic, phase, amplitude N. rates: Hz.
Shaken = namedtuple("Shaken", "sine rests rate inner force inner_rate")

MASS, STIFFNESS, DAMPING, ANGLE, LOW, HIGH, STOP, STOP_DAMPING, DUTY, EXISTS = range(10)

HARMONICS = (2, 3, 4)
SHAKE = {"frequency": 100.0, "amplitude_x": 0.0, "amplitude_z": 0.0, "phase": 0.0,
         "liquid": "moves",
         **{f"{what}_{k}_{axis}": 0.0 for what in ("harmonic", "phase") for k in HARMONICS
            for axis in "xz"}}  # fmt: skip
INNER = {"mass": 0.0, "stiffness": 0.0, "damping": 0.0, "direction": 0.0, "stop_low": 0.0,
         "stop_high": 0.0, "stop_stiffness": 0.0, "stop_damping": 0.0, "amplitude": 0.0,
         "frequency": 100.0, "phase": 0.0, "duty": 0.0,
         **{f"{what}_{k}": 0.0 for what in ("harmonic", "phase") for k in HARMONICS}}  # fmt: skip


def shaken_of(shake, inner, mirror) -> Shaken:
    """From complete dictionaries with the keys of the sections."""
    along, up = mirror * shake["amplitude_x"], shake["amplitude_z"]
    sine = [(1.0, 0.0, along, 0.0), (1.0, shake["phase"], 0.0, up)]
    force = [(1.0, inner["phase"], inner["amplitude"])]
    for k in HARMONICS:
        sine += [
            (k, shake[f"phase_{k}_x"], along * shake[f"harmonic_{k}_x"], 0.0),
            (k, shake[f"phase_{k}_z"], 0.0, up * shake[f"harmonic_{k}_z"]),
        ]
        force.append((k, inner[f"phase_{k}"], inner["amplitude"] * inner[f"harmonic_{k}"]))
    names = ("mass", "stiffness", "damping", "direction", "stop_low", "stop_high", "stop_stiffness",
             "stop_damping", "duty")  # fmt: skip
    numbers = [*(inner[name] for name in names), float(inner["mass"] > 0.0)]
    return Shaken(
        np.array(sine), float(shake["liquid"] == "rests"), float(shake["frequency"]),
        np.array(numbers), np.array(force), float(inner["frequency"]),
    )  # fmt: skip


@njit
def surface(shaken, t):
    """Place (m) of the surface along x and z at t, s."""
    x = z = 0.0
    for k in range(shaken.sine.shape[0]):
        harmonic, phase, along, up = shaken.sine[k]
        angle = 2.0 * np.pi * shaken.rate * harmonic * t
        moved = np.sin(angle + phase) - np.sin(phase)
        x += along * moved
        z += up * moved
    return x, z


@njit
def inner_force(shaken, place, velocity, t):
    """Force (N) on the inner mass along its line."""
    inner = shaken.inner
    total = -inner[STIFFNESS] * place - inner[DAMPING] * velocity
    if inner[STOP] > 0.0 and place > inner[HIGH]:
        total -= max(0.0, inner[STOP] * (place - inner[HIGH]) + inner[STOP_DAMPING] * velocity)
    if inner[STOP] > 0.0 and place < inner[LOW]:
        total += max(0.0, inner[STOP] * (inner[LOW] - place) - inner[STOP_DAMPING] * velocity)
    turn = 2.0 * np.pi * shaken.inner_rate * t
    if inner[DUTY] > 0.0:
        part = (turn + shaken.force[0, 1]) / (2.0 * np.pi)
        return total + (shaken.force[0, 2] if part - np.floor(part) < inner[DUTY] else 0.0)
    for k in range(shaken.force.shape[0]):
        total += shaken.force[k, 2] * np.sin(shaken.force[k, 0] * turn + shaken.force[k, 1])
    return total
