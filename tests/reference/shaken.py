"""A surface that moves, and a mass on springs within the body.

The place of the surface is given; its velocity over a step is the way that it goes in it. The inner
mass moves by leapfrog as the body does: its place is known at the steps, its velocity in the body
half-way between them. It strikes its stops between two steps.
"""

from collections import namedtuple

import numpy as np
from numba import njit

from .contact import OPEN, STICK, solve_one, solve_two

# sine (m, 4): harmonic, phase, amplitudes along x and z in m. rests: whether the liquid does.
# inner (9,): mass kg, stiffness N/m, damping N s/m, angle rad, stops m (2), their restitution,
# duty, and whether there is one; force (n, 3): harmonic, phase, amplitude N. rates: Hz.
Shaken = namedtuple("Shaken", "sine rests rate inner force inner_rate")

MASS, STIFFNESS, DAMPING, ANGLE, LOW, HIGH, RESTITUTION, DUTY, EXISTS = range(9)

HARMONICS = (2, 3, 4)
SHAKE = {"frequency": 100.0, "amplitude_x": 0.0, "amplitude_z": 0.0, "phase": 0.0,
         "liquid": "moves",
         **{f"{what}_{k}_{axis}": 0.0 for what in ("harmonic", "phase") for k in HARMONICS
            for axis in "xz"}}  # fmt: skip
INNER = {"mass": 0.0, "stiffness": 0.0, "damping": 0.0, "direction": 0.0, "stop_low": -1.0,
         "stop_high": 1.0, "restitution": 0.0, "amplitude": 0.0,
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
    names = ("mass", "stiffness", "damping", "direction", "stop_low", "stop_high", "restitution",
             "duty")  # fmt: skip
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
    turn = 2.0 * np.pi * shaken.inner_rate * t
    if inner[DUTY] > 0.0:
        part = (turn + shaken.force[0, 1]) / (2.0 * np.pi)
        return total + (shaken.force[0, 2] if part - np.floor(part) < inner[DUTY] else 0.0)
    for k in range(shaken.force.shape[0]):
        total += shaken.force[k, 2] * np.sin(shaken.force[k, 0] * turn + shaken.force[k, 1])
    return total


@njit
def _struck(model, velocity, corners, way, impulse, touching, slip, offsets):
    """Velocities of the body and outcomes of its corners after a blow of a stop.

    velocity: vx, vz, omega; corners (2,): those that may touch, alone if they are the same; way
    (2,): of the impulse (N s), through the centre; offsets (2, 4): of the corners. A corner keeps
    at least the velocity at which it left the surface before.
    """
    im, ij = 1.0 / model.mass, 1.0 / model.inertia
    vx, vz, omega = velocity
    free_x, free_z = vx + im * impulse * way[0], vz + im * impulse * way[1]
    i, j = corners
    rx, rz = offsets
    if not touching[i] or way[1] > 1e-12:
        return (free_x, free_z, omega), (OPEN, OPEN)
    if way[1] > -1e-12:  # along the surface, which gives no impulse
        slides = 1 if free_x + rz[i] * omega > 0.0 else -1
        return (free_x, free_z, omega), (slides, slides)
    bound = model.mu_static if slip[i] == STICK else model.mu_kinetic
    leaves = vz - rx[i] * omega
    if i == j:
        s = solve_one(
            free_x, free_z, omega, rx[i], rz[i], leaves, im, ij, slip[i], bound, bound, model.lean
        )
    else:
        s = solve_two(
            free_x, free_z, omega, np.array([rx[i], rx[j]]), rz[i],
            np.array([leaves, vz - rx[j] * omega]), im, ij, np.array([slip[i], slip[j]]),
            np.array([bound, bound]), bound, model.lean,
        )  # fmt: skip
    return (s.vx, s.vz, s.omega), (s.outcome0, s.outcome1)


@njit
def strike(shaken, model, inner, velocity, corners, way, touching, slip, offsets, gain):
    """Body and inner mass after the blow of a stop, if it is beyond one and does not come back.

    inner: place and velocity; gain: what its velocity gained in the step, m/s, with which it rests
    at a stop. The impulse is looked for by bisection. Changes `touching` and `slip`; returns inner,
    velocity, and for how long (s) both were as they are after it.
    """
    place, speed = inner
    stop = shaken.inner[HIGH] if place > 0.0 else shaken.inner[LOW]
    end = 1.0 if place > 0.0 else -1.0
    over, speed = end * (place - stop), end * speed
    if over <= 0.0 or speed <= 0.0:
        return inner, velocity, 0.0
    rests = speed <= 1.5 * abs(gain)
    restitution = 0.0 if rests else shaken.inner[RESTITUTION]
    mass = shaken.inner[MASS]
    blow = (end * way[0], end * way[1])
    low, high = 0.0, (1.0 + restitution) * speed * mass
    after, outcome = velocity, (STICK, STICK)
    for _ in range(60):
        impulse = 0.5 * (low + high)
        after, outcome = _struck(model, velocity, corners, blow, impulse, touching, slip, offsets)
        gained = (after[0] - velocity[0]) * blow[0] + (after[1] - velocity[1]) * blow[1]
        if speed - impulse / mass - gained > -restitution * speed:
            low = impulse
        else:
            high = impulse
    for k in range(2):
        i = corners[k]
        if touching[i] and not rests:
            touching[i], slip[i] = outcome[k] != OPEN, outcome[k]
    since = 0.0 if rests else over / speed
    return (stop - end * restitution * over, -end * restitution * speed), after, since
