"""One step of the cuboid on its corners: drift, push, contact, drift.

The body drifts for half of the step, takes forces where it then is, and drifts on with its new
velocity (position Verlet). Corners push at their places in the middle, and what they must not move
is their places at the end, which the old spin foretells: so contact is of second order too, and
does no work where it should not.
"""

from collections import namedtuple

import numpy as np

from .cone import eliminate, largest
from .corner_contact import (
    ROUNDS,
    UNSOLVED,
    begin_contact,
    coupling,
    drop_leaving,
    land,
    remember,
    settle_friction,
    solve_corners,
)
from .near_field import field_at
from .rigid_body import CORNERS, applied, corner_places, in_world, inner, record, rotation, turned

# SI. half_sizes (3,), inertia (3,) about the body's axes; moment A m^2 along its x axis. reach m: a
# corner that is no higher lands together with another, as roughness has it.
Block = namedtuple(
    "Block",
    "half_sizes mass inertia moment mu_static mu_kinetic adhesion restitution drag_linear "
    "drag_rotational gravity reach",
)


def new_motion(place=(0.0, 0.0, 0.0), quaternion=(1.0, 0.0, 0.0, 0.0)):
    """Position (3,) m, quaternion (4,), and at rest: velocity (3,) m/s, spin (3,) rad/s, momentum
    (3,) N m s, the angular one about the centre of mass. All in the world's frame."""
    motion = record(
        {"position": (3,), "quaternion": (4,), "velocity": (3,), "spin": (3,), "momentum": (3,)}
    )
    motion["position"], motion["quaternion"] = place, quaternion
    return motion


def new_trial():
    """Room for a trial of a step.

    Rotations (3, 3): middle, foretold (at the end, by the old spin), final (as it comes out).
    inertia (3, 3) at the foretold end; turning: its inverse, with drag. free, free_spin (3,): what
    the body would do without contact. half_place (3,), quaternion (4,): half-way. places (8, 3),
    heights (8,) m of the corners at the end; rebound (8,) m/s. The rest is room to work in.
    """
    square = ("middle", "foretold", "final", "inertia", "turning")
    triple = ("free", "free_spin", "torque", "half_place")
    return record(
        {
            **dict.fromkeys(square, (3, 3)), **dict.fromkeys(triple, (3,)), "quaternion": (4,),
            "places": (8, 3), "heights": (8,), "rebound": (8,),
        }
    )  # fmt: skip


@inner
def copy_motion(source, target):
    """Make `target` what `source` is."""
    for i in range(4):
        target.quaternion[i] = source.quaternion[i]
    for i in range(3):
        target.position[i] = source.position[i]
        target.velocity[i] = source.velocity[i]
        target.spin[i] = source.spin[i]
        target.momentum[i] = source.momentum[i]


@inner
def _push(block, now, trial, near, length):
    """Velocity and spin that forces alone would leave the body with, into trial.free, free_spin.

    Force grad(m . B) and torque m x B at the middle of the step, weight, and drag, which acts on
    the mean of the velocities at the step's ends and so damps at any length. Returns 1 / mass with
    drag, 1/kg.
    """
    size = np.sqrt(now.spin[0] ** 2 + now.spin[1] ** 2 + now.spin[2] ** 2)
    drag = 0.5 * length * block.drag_linear
    twist = 0.5 * length * block.drag_rotational * size
    lightness = 1.0 / (block.mass + drag)
    mx, my, mz = (
        block.moment * trial.middle[0, 0], block.moment * trial.middle[1, 0],
        block.moment * trial.middle[2, 0],
    )  # fmt: skip
    bx, by, bz = near.total[0], near.total[1], near.total[2]
    slope, momentum = near.slope, now.momentum
    for j in range(3):
        force = mx * slope[0, j] + my * slope[1, j] + mz * slope[2, j]
        if j == 2:
            force -= block.mass * block.gravity
        trial.free[j] = lightness * ((block.mass - drag) * now.velocity[j] + length * force)
        trial.torque[j] = momentum[j] - twist * now.spin[j]
    trial.torque[0] += length * (my * bz - mz * by)
    trial.torque[1] += length * (mz * bx - mx * bz)
    trial.torque[2] += length * (mx * by - my * bx)
    for i in range(3):
        trial.heights[i] = 1.0 / (block.inertia[i] + twist)
    in_world(trial.foretold, trial.heights, trial.turning)
    applied(trial.turning, trial.torque, trial.free_spin)
    return lightness


@inner
def kinetic_energy(block, velocity, spin, momentum):
    """Kinetic energy in J; momentum: the angular one."""
    energy = 0.0
    for j in range(3):
        energy += 0.5 * (block.mass * velocity[j] * velocity[j] + spin[j] * momentum[j])
    return energy


@inner
def _impact_gains(block, now, trial, after):
    """Whether an impact raises the kinetic energy; forces do nothing in so short a step."""
    applied(trial.inertia, after.spin, after.momentum)
    begin = kinetic_energy(block, now.velocity, now.spin, now.momentum)
    return kinetic_energy(block, after.velocity, after.spin, after.momentum) > begin


@inner
def _drift(block, trial, after, length):
    """Second half of the step with the new velocity: after's place, trial.final, places, heights.

    trial.half_place: of the centre of mass in the middle, m; trial.quaternion: orientation there.
    """
    half, spin = 0.5 * length, after.spin
    for j in range(3):
        after.position[j] = trial.half_place[j] + half * after.velocity[j]
    turned(trial.quaternion, half * spin[0], half * spin[1], half * spin[2], after.quaternion)
    rotation(after.quaternion, trial.final)
    corner_places(trial.final, block.half_sizes, trial.places)
    for c in range(CORNERS):
        trial.heights[c] = after.position[2] + trial.places[c, 2]


@inner
def _resolve(block, now, trial, after, step, memory, lightness, length, longest, shortest, counts):
    """Find the velocities at the end of the step and what the corners do.

    Returns whether the step counts: one in which a corner changes its state must be of the shortest
    length. Nothing but `after` and `step` is changed.
    """
    for c in range(CORNERS):
        trial.rebound[c] = 0.0
    # A hop that is shorter than the longest step stays down, else there is no end of them.
    slowest = 0.5 * longest * (block.gravity + block.adhesion / block.mass)
    impact = False
    begin_contact(step, memory, length, block.mu_static, block.mu_kinetic)
    for _ in range(ROUNDS):
        solve_corners(
            step, memory, trial.free, trial.free_spin, after.velocity, after.spin, lightness,
            trial.turning, length * block.adhesion, trial.rebound, counts,
        )  # fmt: skip
        if drop_leaving(step):
            if not shortest:
                return False
            continue
        verdict = settle_friction(
            step, memory, after.velocity, after.spin, impact, block.mu_static, block.mu_kinetic
        )
        if verdict > 0 and not shortest:
            return False
        if verdict == 2:
            continue
        _drift(block, trial, after, length)
        landed = land(
            step, memory, trial.heights, block.reach, after.velocity, after.spin,
            block.restitution, slowest, block.mu_kinetic, trial.rebound,
        )  # fmt: skip
        if landed == 0:
            if not (impact and largest(trial.rebound, CORNERS) > 0.0):
                return True
            if not _impact_gains(block, now, trial, after):
                return True
            # Newton's law would create energy: the largest restitution that does not, to 2 %.
            for c in range(CORNERS):
                trial.rebound[c] *= 0.98
            continue
        if not shortest:
            return False
        impact = True
    counts[UNSOLVED] += 1
    return True


@inner
def _close_gaps(block, trial, after, step, memory):
    """Move the body by the little that brings the touching corners' gaps to zero."""
    n = 0
    for c in range(CORNERS):
        if memory.touching[c]:
            step.corner[n] = c
            for j in range(3):
                step.end[c, j] = step.middle[c, j] = trial.places[c, j]
            n += 1
    if n == 0:
        return
    step.active[0] = n
    coupling(step, 1.0 / block.mass, trial.turning)
    for i in range(n):
        for j in range(n):
            step.matrix[i, j] = step.w[3 * i + 2, 3 * j + 2]
        step.right[i] = -trial.heights[step.corner[i]]
    eliminate(step.matrix, step.right, n)
    trial.torque[0] = trial.torque[1] = trial.torque[2] = 0.0
    for i in range(n):
        place = trial.places[step.corner[i]]
        after.position[2] += step.right[i] / block.mass
        trial.torque[0] += place[1] * step.right[i]
        trial.torque[1] -= place[0] * step.right[i]
    applied(trial.turning, trial.torque, trial.free_spin)
    turn = trial.free_spin
    turned(after.quaternion, turn[0], turn[1], turn[2], trial.quaternion)
    for j in range(4):
        after.quaternion[j] = trial.quaternion[j]


@inner
def try_step(
    block, wires, amperes, near, now, after, trial, step, memory, length, longest, shortest, counts
):
    """One step of `length` s from `now` into `after`; returns whether it counts, see `_resolve`.

    amperes (5,): currents in the middle of the step. longest s: length of a step without events.
    """
    half, spin = 0.5 * length, now.spin
    turned(now.quaternion, length * spin[0], length * spin[1], length * spin[2], trial.quaternion)
    rotation(trial.quaternion, trial.foretold)
    corner_places(trial.foretold, block.half_sizes, step.end)
    in_world(trial.foretold, block.inertia, trial.inertia)
    turned(now.quaternion, half * spin[0], half * spin[1], half * spin[2], trial.quaternion)
    rotation(trial.quaternion, trial.middle)
    corner_places(trial.middle, block.half_sizes, step.middle)
    half_place = trial.half_place
    for j in range(3):
        half_place[j] = now.position[j] + half * now.velocity[j]
    field_at(wires, half_place, amperes, near)
    lightness = _push(block, now, trial, near, length)
    if not _resolve(
        block, now, trial, after, step, memory, lightness, length, longest, shortest, counts
    ):
        return False
    applied(trial.inertia, after.spin, after.momentum)
    remember(step, memory, after.velocity, after.spin, trial.rebound, length, counts)
    _close_gaps(block, trial, after, step, memory)
    return True
