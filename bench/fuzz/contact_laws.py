"""The laws of contact at every sample of a record; each finding is a line of text."""

from __future__ import annotations

import numpy as np

from fuzz.record import CORNER_STICK, FACE_STICK, Array, Record, gains
from stickslip import Coils

# In units of the tolerance of a step: forces follow from positions and velocities by factors of
# some tens (a stiff field), and an event is located to the same order.
_FORCE_FACTOR = 1e5
_SPEED_FACTOR = 1e3
_GAP_FACTOR = 1e2

# Rounding of positions, m and of angles after many turns.
_ROUNDING = 1e-15


def corner_heights(record: Record) -> Array:
    """Heights of the four corners above the surface, m, lowest first, shape (4, n)."""
    robot = record.scenario.robot
    a = 0.5 * robot.length * np.array([[1], [-1], [-1], [1]])
    b = 0.5 * robot.height * np.array([[-1], [-1], [1], [1]])
    heights = record.z - a * np.sin(record.theta) + b * np.cos(record.theta)
    return np.sort(heights, axis=0)


def _place(record: Record, slips: Array) -> Array:
    """Factor on friction of where the contact is and which way it slips."""
    where = np.where(record.on_face, record.x, np.nan_to_num(record.contact_x)) * record.sign
    period = record.effect("friction_patches.period")
    patch = 1.0 + record.effect("friction_patches.amplitude") * np.sin(2 * np.pi * where / period)
    return patch * (1.0 + record.effect("friction_anisotropy.fraction") * slips)


def kinetic_coefficient(record: Record) -> Array:
    contact = record.scenario.contact
    speed = np.abs(np.nan_to_num(record.slip))
    coefficient = contact.kinetic_friction + record.effect("viscous_friction.coefficient") * speed
    stribeck = record.effect("stribeck_friction.velocity")
    if stribeck:
        falling = np.exp(-((speed / stribeck) ** 2))
        coefficient += (contact.static_friction - contact.kinetic_friction) * falling
    return coefficient * _place(record, record.slips)


def violations(record: Record) -> list[str]:
    """What in a record cannot be; empty for a sound one."""
    rtol = record.scenario.solver.rtol
    force = (_FORCE_FACTOR * rtol + 1e-9) * (record.force + np.abs(record.normal))
    gap = _GAP_FACTOR * rtol * record.radius + _ROUNDING
    speed = (_SPEED_FACTOR * rtol + 1e-12) * record.fastest
    heights = corner_heights(record)
    slip = np.nan_to_num(record.slip)
    flying, touching = record.flying, record.touching
    sticking, slipping = record.sticking, record.slips != 0
    # A stick that is about to give way slips against its friction force.
    limit = record.scenario.contact.static_friction * record.normal
    limit = limit * _place(record, -np.sign(record.friction))
    kinetic = kinetic_coefficient(record) * record.normal
    levers = record.omega * record.z
    rounding = 1e-12 * (np.abs(record.vx) + np.abs(levers)) + _ROUNDING
    laws = {
        "a corner is below the surface": -heights[0] - gap,
        "what touches is not at the surface": np.where(touching, np.abs(heights[0]) - gap, -1),
        "a face does not lie flat": np.where(record.on_face, heights[1] - gap, -1),
        "the surface pulls": -record.normal - force,
        "there is a force in flight": np.where(
            flying, np.abs(record.normal) + np.abs(record.friction), -1
        ),
        "a stick is outside the friction cone": np.where(
            sticking, np.abs(record.friction) - limit - force, -1
        ),
        "a stick slips": np.where(sticking, np.abs(slip), -1),
        "friction of a slip is not kinetic": np.where(
            slipping, np.abs(record.friction + record.slips * kinetic) - force, -1
        ),
        "a slip runs against its mode": np.where(slipping, -record.slips * slip - speed, -1),
        "friction drives the slip": np.where(
            slipping, record.friction * slip - force * speed - force * np.abs(slip), -1
        ),
        "the contact does not move with the body": np.where(
            touching, np.abs(record.vx - levers - slip) - rounding, -1
        ),
    }  # fmt: skip
    laws.update(_moving_laws(record))
    # A body that cannot lie still has its first sample before it moves.
    seen = record.t > 0.0
    found = [_line(what, amount, seen, record) for what, amount in laws.items()]
    return [line for line in (*found, *_not_finite(record), *_wrong_field(record)) if line]


def _moving_laws(record: Record) -> dict[str, Array]:
    """Laws of two samples that follow each other, put down at the later one."""
    smooth = ~record.after_event[1:]
    step = np.diff(record.t)
    corner = smooth & (record.contact[1:] == CORNER_STICK) & (record.contact[:-1] == CORNER_STICK)
    face = smooth & (record.contact[1:] == FACE_STICK) & (record.contact[:-1] == FACE_STICK)
    drift = np.where(corner, np.abs(np.diff(record.contact_x)), -1.0)
    creep = np.abs(np.diff(record.x)) + np.abs(np.diff(record.theta)) * record.radius
    # An impact may stop what moved at the fastest speed, so the travel is at most that much.
    travel = np.abs(np.diff(record.x)) + np.abs(np.diff(record.z))
    travel += record.radius * np.abs(np.diff(record.theta))
    most = 3.0 * record.fastest * step + 1e-9 * record.radius
    return {
        "a stick drifts": np.append(-1.0, np.where(drift > 0.0, drift, -1.0)),
        "a body at rest moves": np.append(-1.0, np.where(face & (creep > 0.0), creep, -1.0)),
        "the position jumps": np.append(-1.0, travel - most),
        "time runs back": np.append(-1.0, np.where(step < 0.0, -step, -1.0)),
    }


def _line(what: str, amount: Array, seen: Array, record: Record) -> str:
    bad = seen & ~(amount <= 0.0)
    if not bad.any():
        return ""
    worst = int(np.argmax(np.where(bad, amount, -np.inf)))
    return (
        f"{what}: {bad.sum()} of {len(bad)} samples, worst by {amount[worst]:.3g} at "
        f"t = {float(record.t[worst])!r} in mode {record.contact[worst]}"
    )


def _not_finite(record: Record) -> list[str]:
    names = ("t", "x", "z", "theta", "vx", "vz", "omega", "normal", "friction", "bx", "bz")
    return [f"{n} is not finite" for n in names if not np.all(np.isfinite(getattr(record, n)))]


def _wrong_field(record: Record) -> list[str]:
    """The field of an expansion about the robot against the sum of Eqs. (3)-(7)."""
    if record.effect("eddy_lag.time") != 0.0:
        return []
    some = slice(None, None, max(1, len(record.t) // 500))
    s = record.scenario
    coils = Coils.of(s)
    points = np.column_stack([record.sign * record.x, np.zeros_like(record.x), record.z])[some]
    field = coils.field(points, record.current[some] * gains(record))
    expected = field[:, 0] + record.effect("ambient_field.Bx")
    off = np.hypot(
        record.sign * record.bx[some] - expected,
        record.bz[some] - field[:, 2] - record.effect("ambient_field.Bz"),
    )
    # Currents of opposite sign cancel: what counts is what each of them makes alone.
    size = coils.centre_field_per_ampere * np.abs(record.current[some] * gains(record)).sum(axis=1)
    worst = float(np.max(off - 1e-7 * size - 1e-15))
    return [] if worst <= 0.0 else [f"the field is not that of the currents, by {worst:.3g} T"]
