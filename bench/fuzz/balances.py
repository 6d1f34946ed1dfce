"""Momentum and energy of a record against the forces that act, computed anew.

Between events the change of momentum and of energy is the integral of force and power. It is taken
by the trapezium rule; the difference to that of every other sample bounds its error, of which it is
about three times.

Across an event the energy may fall, and never rises by more than the field's work. That work is
taken over displacements, which have no jump where velocities do.
"""

from __future__ import annotations

import numpy as np

from fuzz.record import Array, Record, at_events, magnetic_load

# In units of a step's tolerance, relative to the natural momentum and energy: a stretch between two
# events has some tens of steps, and the dense output between them errs more than they do.
_TOLERANCE_FACTOR = 1e4
_ROUNDING = 1e-9

# m/s, of a face or a corner that comes to rest without an impulse: the core's own limit, by which
# each of three velocities may be off.
_CAPTURE = 1e-6

# Of the natural speed; a body that moves less has no energy to speak of.
_SLOW = 1e-3


def violations(record: Record) -> list[str]:
    """What in a record no force can have done; empty for a sound one, and for a coarse one.

    The balances are those of one plane, so that a robot that leaves it is not looked at.
    """
    if not record.fine or record.scenario.turns:
        return []
    load = magnetic_load(record)
    return [line for line in (*_momenta(record, load), *_energies(record, load)) if line]


def gained(record: Record) -> list[str]:
    """Energy that no field has given, across an event; the last part of `violations`."""
    if not record.fine or record.scenario.turns:
        return []
    record = at_events(record)
    energy, load = kinetic_and_weight(record), magnetic_load(record)
    line = _gained(record, energy, load, _natural_energy(record))
    return [line] if line else []


def stretches(record: Record) -> list[tuple[int, int]]:
    """First and last sample of each stretch between events that has five samples or more."""
    starts = np.flatnonzero(record.after_event)
    starts = starts if len(starts) and starts[0] == 0 else np.append(0, starts)
    ends = np.append(starts[1:] - 1, len(record.t) - 1)
    return [(int(a), int(b)) for a, b in zip(starts, ends, strict=True) if b - a >= 4]


def _drag(record: Record) -> tuple[Array, Array]:
    """Coefficients of the drag force, N s/m, and torque, N m s, at each sample; Eqs. (18), (19)."""
    drag = record.scenario.drag
    linear = drag.linear * (1.0 + record.effect("angle_drag.strength") * np.cos(record.theta) ** 2)
    speed = np.hypot(record.vx, record.vz)
    return (
        linear + record.effect("quadratic_drag.coefficient") * speed,
        record.effect("rotational_drag.coefficient") + drag.rotational * np.abs(record.omega),
    )


def _gravity(record: Record) -> tuple[float, float]:
    """m/s^2 along the surface and across it, robot's frame."""
    tilt = record.sign * record.effect("surface_tilt.angle")
    gravity = record.scenario.environment.gravity
    return gravity * np.sin(tilt), -gravity * np.cos(tilt)


def _adhesion_is_known(record: Record) -> bool:
    return not (record.effect("angle_adhesion.strength") or record.effect("adhesion_ageing.rate"))


def _momenta(record: Record, load: tuple[Array, Array, Array]) -> list[str]:
    """Eqs. (10)-(12)."""
    mass, (drag, turning) = record.scenario.robot.mass, _drag(record)
    gx, gz = _gravity(record)
    fx = load[0] + mass * gx - drag * record.vx + record.friction
    momentum = mass * record.fastest
    found = [_unbalanced("momentum along x", record, mass * record.vx, fx, momentum)]
    if not _adhesion_is_known(record):
        return found
    adhesion = np.where(record.flying, 0.0, record.scenario.contact.adhesion)
    fz = load[1] + mass * gz - drag * record.vz + record.normal - adhesion
    found.append(_unbalanced("momentum across", record, mass * record.vz, fz, momentum))
    lever = np.nan_to_num(record.contact_x - record.x)
    torque = load[2] - turning * record.omega
    torque -= lever * (record.normal - adhesion) + record.z * record.friction
    # A face has two corners, whose shares are not recorded; it does not turn.
    torque[record.on_face] = 0.0
    spin = momentum * record.radius
    found.append(_unbalanced("spin", record, record.inertia * record.omega, torque, spin))
    return found


def kinetic_and_weight(record: Record) -> Array:
    """Energy of the motion and of gravity, J."""
    mass, (gx, gz) = record.scenario.robot.mass, _gravity(record)
    kinetic = 0.5 * mass * (record.vx**2 + record.vz**2) + 0.5 * record.inertia * record.omega**2
    return kinetic - mass * (gx * record.x + gz * record.z)


def _energies(record: Record, load: tuple[Array, Array, Array]) -> list[str]:
    energy = kinetic_and_weight(record)
    scale = _natural_energy(record)
    if scale == 0.0:
        return []
    drag, turning = _drag(record)
    power = load[0] * record.vx + load[1] * record.vz + load[2] * record.omega
    power -= drag * (record.vx**2 + record.vz**2) + turning * record.omega**2
    power += record.friction * np.nan_to_num(record.slip)
    unbalanced = _unbalanced("energy", record, energy, power, scale)
    return [unbalanced, _gained(record, energy, load, scale)]


def _natural_energy(record: Record) -> float:
    """The error of a velocity is relative to the natural one, and the energy's is that by it."""
    return record.scenario.robot.mass * record.fastest * float(np.max(record.pace))


def _unbalanced(name: str, record: Record, content: Array, rate: Array, scale: float) -> str:
    """A line for the stretch in which `content` changes most against the integral of `rate`."""
    floor = _relative(record) * scale
    worst, line = 0.0, ""
    for first, last in stretches(record):
        t, r = record.t[first : last + 1], rate[first : last + 1]
        # An event may lie close before a sample: pairs from the second sample on are even.
        error = max(_rule_error(t, r), _rule_error(t[1:], r[1:]))
        off = abs(content[last] - content[first] - _trapezium(t, r).sum()) - error - floor
        if not off <= worst:
            worst = off
            line = (
                f"{name} is not balanced from t = {float(t[0])!r} to {float(t[-1])!r} in "
                f"mode {record.contact[first]}: off by {off / scale:.3g} of the natural size"
            )
    return line


def _relative(record: Record) -> float:
    return _TOLERANCE_FACTOR * record.scenario.solver.rtol + _ROUNDING


def _rule_error(t: Array, rate: Array) -> float:
    """Sum over pairs of steps of what the rule makes of them and of the two as one."""
    pairs = 2 * ((len(t) - 1) // 2)
    fine = _trapezium(t[: pairs + 1], rate[: pairs + 1]).reshape(-1, 2).sum(axis=1)
    return float(np.abs(fine - _trapezium(t[: pairs + 1 : 2], rate[: pairs + 1 : 2])).sum())


def _trapezium(t: Array, rate: Array) -> Array:
    return 0.5 * (rate[1:] + rate[:-1]) * np.diff(t)


def _gained(record: Record, energy: Array, load: tuple[Array, Array, Array], scale: float) -> str:
    """A line for the sample at which energy appears that no field has given."""
    work, error = np.zeros(len(energy) - 1), np.zeros(len(energy) - 1)
    places = ((record.x, record.vx), (record.z, record.vz), (record.theta, record.omega))
    for force, (place, rate) in zip(load, places, strict=True):
        step = np.diff(place)
        work += 0.5 * (force[1:] + force[:-1]) * step
        # Exact for a force that rises or falls all the way along the step, whose way may be forth
        # and back.
        fastest = np.maximum(np.abs(rate[1:]), np.abs(rate[:-1]))
        change = np.abs(np.diff(force)) if record.follows_currents else np.max(np.abs(force))
        error += 0.5 * change * np.maximum(np.abs(step), fastest * np.diff(record.t))
    # What a torque does that turns within the step.
    natural = record.scenario.robot.mass * record.fastest
    error = 3.0 * error + natural * record.fastest * np.abs(np.diff(record.theta)) ** 3 / 12.0
    pace = np.maximum(record.pace[1:], record.pace[:-1])
    floor = _relative(record) * natural * (pace + _SLOW * record.fastest)
    floor += 3.0 * _CAPTURE * record.scenario.robot.mass * pace
    gain = np.diff(energy) - work - error - floor
    return _gain_line(record, np.where(record.after_event[1:], gain, -1.0), scale)


def _gain_line(record: Record, gain: Array, scale: float) -> str:
    if not len(gain) or gain.max() <= 0.0:
        return ""
    worst = int(np.argmax(gain))
    return (
        f"energy is gained across an event at t = {float(record.t[worst + 1])!r}: "
        f"{gain[worst] / scale:.3g} of the natural size, {np.sum(gain > 0.0)} times"
    )
