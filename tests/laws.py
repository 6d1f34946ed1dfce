"""Checks of a record: the laws of contact, and the balances of momentum and energy.

Between events the change of momentum and of energy is the integral of force and power, computed
anew from the positions. It is taken by the trapezium rule; the difference to that of every other
sample bounds its error, of which it is about three times.

Across an event the energy may fall, and never rises by more than the field's work. That work is
taken over displacements, which have no jump where velocities do.
"""

import numpy as np

from fine_record import CORNER_STICK, FACE_STICK
from stickslip import Coils

# In units of the tolerance of a step: forces follow from positions and velocities by factors of
# some tens (a stiff field), and an event is located to the same order.
_FORCE_FACTOR = 1e5
_SPEED_FACTOR = 1e3
_GAP_FACTOR = 1e2

# In units of a step's tolerance, relative to the natural momentum and energy: a stretch between two
# events has some tens of steps, and the dense output between them errs more than they do.
_TOLERANCE_FACTOR = 1e4
_ROUNDING = 1e-9

# m/s, of a face or a corner that comes to rest without an impulse: the core's own limit, by which
# each of three velocities may be off.
_CAPTURE = 1e-6

# Of the natural speed; a body that moves less has no energy to speak of.
_SLOW = 1e-3


def corner_heights(record):
    """Heights of the four corners above the surface, m, lowest first, shape (4, n)."""
    robot = record.scenario.robot
    a = 0.5 * robot.length * np.array([[1], [-1], [-1], [1]])
    b = 0.5 * robot.height * np.array([[-1], [-1], [1], [1]])
    return np.sort(record.z - a * np.sin(record.theta) + b * np.cos(record.theta), axis=0)


def contact_violations(record):
    """Violations of the laws of contact, motion and field, at the tolerance of the run."""
    rtol = record.scenario.solver.rtol
    gap = _GAP_FACTOR * rtol * record.radius + 1e-15  # with the rounding of positions
    found = violations(
        record,
        force=(_FORCE_FACTOR * rtol + 1e-9) * (record.force + np.abs(record.normal)),
        speed=(_SPEED_FACTOR * rtol + 1e-12) * record.fastest,
        gaps=(gap, gap, gap),
        # A body that cannot lie still has its first sample before it moves.
        start=np.nextafter(0.0, 1.0),
    )
    return found + _lines(_moving_laws(record), record.t > 0.0, record) + _wrong_field(record)


def violations(record, force, speed, gaps, start=0.0):
    """Violations of the laws of contact at the samples from `start` (s) on, one line each.

    force: N, and speed: m/s, of a slip against its mode's direction: tolerances. gaps: m, of a
    corner below the surface, of a touching corner, of a face that does not lie flat.
    """
    contact = record.scenario.contact
    heights, slip = corner_heights(record), np.nan_to_num(record.slip)
    flying, sticking, slipping = record.flying, record.sticking, record.slips != 0
    # A stick that is about to give way slips against its friction force.
    limit = contact.static_friction * record.normal * _place(record, -np.sign(record.friction))
    kinetic = kinetic_coefficient(record) * record.normal
    levers = record.omega * record.z
    rounding = 1e-12 * (np.abs(record.vx) + np.abs(levers)) + 1e-15
    below, touching, flat = gaps
    laws = {
        "a corner is below the surface": -heights[0] - below,
        "what touches is not at the surface": np.where(flying, -1, np.abs(heights[0]) - touching),
        "a face does not lie flat": np.where(record.on_face, heights[1] - flat, -1),
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
            slipping, record.friction * slip - force * (speed + np.abs(slip)), -1
        ),
        "the contact does not move with the body": np.where(
            flying, -1, np.abs(record.vx - levers - slip) - rounding
        ),
    }  # fmt: skip
    names = ("t", "x", "z", "theta", "vx", "vz", "omega", "normal", "friction", "bx", "bz")
    endless = [n for n in names if not np.all(np.isfinite(getattr(record, n)))]
    return [*_lines(laws, record.t >= start, record), *(f"{n} is not finite" for n in endless)]


def _place(record, slips):
    """Factor on friction of all but the speed."""
    where = np.where(record.on_face, record.x, np.nan_to_num(record.contact_x)) * record.sign
    period = record.effect("friction_patches.period")
    patch = 1.0 + record.effect("friction_patches.amplitude") * np.sin(2 * np.pi * where / period)
    patch *= record.shape("free_friction_angle", record.tilt)
    patch *= record.shape("free_friction_age", record.t)
    patch *= record.shape("free_friction_load", record.normal)
    return patch * (1.0 + record.effect("friction_anisotropy.fraction") * slips)


def kinetic_coefficient(record):
    contact = record.scenario.contact
    speed = np.abs(np.nan_to_num(record.slip))
    coefficient = contact.kinetic_friction + record.effect("viscous_friction.coefficient") * speed
    stribeck = record.effect("stribeck_friction.velocity")
    if stribeck:
        falling = np.exp(-((speed / stribeck) ** 2))
        coefficient += (contact.static_friction - contact.kinetic_friction) * falling
    coefficient *= record.shape("free_friction_speed", speed)
    return coefficient * _place(record, record.slips)


def _moving_laws(record):
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


def _lines(laws, seen, record):
    found = []
    for what, amount in laws.items():
        bad = seen & ~(amount <= 0.0)
        if bad.any():
            worst = int(np.argmax(np.where(bad, amount, -np.inf)))
            found.append(
                f"{what}: {bad.sum()} of {len(bad)} samples, worst by {amount[worst]:.3g} at "
                f"t = {float(record.t[worst])!r} in mode {record.contact[worst]}"
            )
    return found


def _wrong_field(record):
    """The field of an expansion about the robot against the sum of Eqs. (3)-(7)."""
    if record.effect("eddy_lag.time") != 0.0:
        return []
    some = slice(None, None, max(1, len(record.t) // 500))
    s = record.scenario
    coils = Coils.of(s)
    points = np.column_stack([record.sign * record.x, np.zeros_like(record.x), record.z])[some]
    sources = record.sources(record.current)[some]
    field = coils.field(points, sources)
    expected = field[:, 0] + record.effect("ambient_field.Bx")
    off = np.hypot(
        record.sign * record.bx[some] - expected,
        record.bz[some] - field[:, 2] - record.effect("ambient_field.Bz"),
    )
    # Currents of opposite sign cancel: what counts is what each of them makes alone.
    size = np.sum(coils.centre_field_per_ampere * np.abs(sources), axis=1)
    worst = float(np.max(off - 1e-7 * size - 1e-15))
    return [] if worst <= 0.0 else [f"the field is not that of the currents, by {worst:.3g} T"]


def unbalanced(record):
    """Violated balances of momentum and energy; empty for a sound record, and for a coarse one.

    The balances are those of one plane, so that a robot that leaves it is not looked at.
    """
    if not record.fine or record.scenario.whole_plane:
        return []
    load, unsure = record.magnetic_load, np.abs(record.magnetic_force(record.unsure))
    return [
        line for line in (*_momenta(record, load, unsure), *_energies(record, load, unsure)) if line
    ]


def stretches(record):
    """First and last sample of each stretch between events that has five samples or more."""
    starts = np.flatnonzero(record.after_event)
    starts = starts if len(starts) and starts[0] == 0 else np.append(0, starts)
    ends = np.append(starts[1:] - 1, len(record.t) - 1)
    return [(int(a), int(b)) for a, b in zip(starts, ends, strict=True) if b - a >= 4]


def _drag(record):
    """Coefficients of the drag force, N s/m, and torque, N m s, at each sample; Eqs. (18), (19)."""
    drag = record.scenario.drag
    linear = drag.linear * (1.0 + record.effect("angle_drag.strength") * np.cos(record.theta) ** 2)
    speed, spin = np.hypot(record.vx, record.vz), np.abs(record.omega)
    rate = record.shape("free_drag_rate", spin)
    shape = rate * record.shape("free_drag_angle", record.tilt)
    return (
        (linear + record.effect("quadratic_drag.coefficient") * speed)
        * (shape * record.shape("free_drag_speed", speed)),
        (record.effect("rotational_drag.coefficient") + drag.rotational * spin) * rate,
    )


def _gravity(record):
    """m/s^2 along the surface and across it, robot's frame."""
    tilt = record.sign * record.effect("surface_tilt.angle")
    gravity = record.scenario.environment.gravity
    return gravity * np.sin(tilt), -gravity * np.cos(tilt)


def _momenta(record, load, unsure):
    """Eqs. (10)-(12)."""
    mass, (drag, turning) = record.scenario.robot.mass, _drag(record)
    gx, gz = _gravity(record)
    fx = load[0] + mass * gx - drag * record.vx + record.friction
    momentum = mass * record.fastest
    found = [_unbalanced("momentum along x", record, mass * record.vx, fx, momentum, unsure[0])]
    adhesion = record.adhesion
    fz = load[1] + mass * gz - drag * record.vz + record.normal - adhesion
    found.append(_unbalanced("momentum across", record, mass * record.vz, fz, momentum, unsure[1]))
    lever = np.nan_to_num(record.contact_x - record.x)
    torque = load[2] - turning * record.omega
    torque -= lever * (record.normal - adhesion) + record.z * record.friction
    # A face has two corners, whose shares are not recorded; it does not turn.
    torque[record.on_face] = 0.0
    spin = momentum * record.radius
    found.append(_unbalanced("spin", record, record.inertia * record.omega, torque, spin))
    return found


def kinetic_and_weight(record):
    """Energy of the motion and of gravity, J."""
    mass, (gx, gz) = record.scenario.robot.mass, _gravity(record)
    kinetic = 0.5 * mass * (record.vx**2 + record.vz**2) + 0.5 * record.inertia * record.omega**2
    return kinetic - mass * (gx * record.x + gz * record.z)


def _energies(record, load, unsure):
    energy = kinetic_and_weight(record)
    scale = _natural_energy(record)
    if scale == 0.0:
        return []
    drag, turning = _drag(record)
    power = load[0] * record.vx + load[1] * record.vz + load[2] * record.omega
    power -= drag * (record.vx**2 + record.vz**2) + turning * record.omega**2
    power += record.friction * np.nan_to_num(record.slip)
    unsure = unsure[0] * np.abs(record.vx) + unsure[1] * np.abs(record.vz)
    unbalanced = _unbalanced("energy", record, energy, power, scale, unsure)
    return [unbalanced, _gained(record, energy, load, scale)]


def _natural_energy(record):
    """The error of a velocity is relative to the natural one, and the energy's is that by it."""
    return record.scenario.robot.mass * record.fastest * float(np.max(record.pace))


def _unbalanced(name, record, content, rate, scale, unsure=0.0):
    """A line for the stretch in which `content` changes most against the integral of `rate`.

    unsure: of the rate, at each sample.
    """
    floor = _relative(record) * scale
    worst, line = 0.0, ""
    for first, last in stretches(record):
        t, r = record.t[first : last + 1], rate[first : last + 1]
        # An event may lie close before a sample: pairs from the second sample on are even.
        error = max(_rule_error(t, r), _rule_error(t[1:], r[1:]))
        error += _trapezium(t, np.broadcast_to(unsure, rate.shape)[first : last + 1]).sum()
        off = abs(content[last] - content[first] - _trapezium(t, r).sum()) - error - floor
        if not off <= worst:
            worst = off
            line = (
                f"{name} is not balanced from t = {float(t[0])!r} to {float(t[-1])!r} in "
                f"mode {record.contact[first]}: off by {off / scale:.3g} of the natural size"
            )
    return line


def _relative(record):
    return _TOLERANCE_FACTOR * record.scenario.solver.rtol + _ROUNDING


def _rule_error(t, rate):
    """Sum over pairs of steps of what the rule makes of them and of the two as one."""
    pairs = 2 * ((len(t) - 1) // 2)
    fine = _trapezium(t[: pairs + 1], rate[: pairs + 1]).reshape(-1, 2).sum(axis=1)
    return float(np.abs(fine - _trapezium(t[: pairs + 1 : 2], rate[: pairs + 1 : 2])).sum())


def _trapezium(t, rate):
    return 0.5 * (rate[1:] + rate[:-1]) * np.diff(t)


def _gained(record, energy, load, scale):
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


def _gain_line(record, gain, scale):
    if not len(gain) or gain.max() <= 0.0:
        return ""
    worst = int(np.argmax(gain))
    return (
        f"energy is gained across an event at t = {float(record.t[worst + 1])!r}: "
        f"{gain[worst] / scale:.3g} of the natural size, {np.sum(gain > 0.0)} times"
    )
