"""Helpers of the tests of the physics: Table II's robot, scenarios by key, and the invariants.

Positions and forces of a run are in the world's frame, theta and omega in the robot's own.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import laws
from fine_record import Record
from stickslip import Coils, Scenario, Waveform, _core, simulate, volts_per_tesla

# Table II, with the mass read as micrograms.
LENGTH, WIDTH, HEIGHT = 250e-6, 130e-6, 100e-6  # m
MASS = 25.6e-9  # kg
GRAVITY = 9.81  # m/s^2
WEIGHT = MASS * GRAVITY  # N
ADHESION = 0.22e-6  # N
RADIUS = np.hypot(LENGTH, HEIGHT) / 2  # m, from the centre of mass to a corner
INERTIA = MASS * (LENGTH**2 + HEIGHT**2) / 12  # kg m^2
MOMENT = LENGTH * WIDTH * HEIGHT * 5e5  # A m^2

needs_arkode = pytest.mark.skipif(not _core.has_arkode, reason="this build has no arkode")

FLIGHT = 0
STICKING = (1, 4)
ON_A_CORNER = (1, 2, 3)
ON_A_FACE = (4, 5, 6)

NO_FIELD = {"drive.peak": 0.0, "drive.base": 0.0, "drive.hold": 0.0, "drive.ramp": 0.0}

# Currents that follow their voltages within 0.1 us, for tests that need a field at once.
QUICK_COILS = {"coil.inductance": 1e-6}

# OPP with hops, and slips both ways on a corner.
HOPS = {"mode": "OPP", "hold": 2.5e-3, "base": 0.0, "pulses": 8}
TIGHT = {"solver.rtol": 1e-10}

# Pressed so hard to the surface that no field of these tests moves it.
HELD = {"contact.adhesion": 1e-3}
# All five coils, jumps, ramps, both signs; stretches short against the time constant.
BUSY = Waveform.from_points(
    [0.0, 1e-3, 1e-3, 2e-3, 3e-3, 3e-3, 4e-3],
    [[0, 0, 0, 0, 0], [30, 5, 8, -8, -20], [-10, 5, -8, 8, -20], [-10, -5, 4, -4, 30],
     [20, 0, 4, -4, -30], [0, 0, 0, 0, 10], [25, -25, -2, 2, 10]],
)  # fmt: skip


def scenario(*changes, **more):
    """The default scenario with values by dotted key; `mode=...` stands for `drive.mode`."""
    values = {key: value for change in changes for key, value in change.items()}
    return Scenario().replace({**values, **{f"drive.{k}": v for k, v in more.items()}})


def run(*changes, rate="none", **more):
    """Simulate `scenario(...)`, recorded at `rate`, and refuse any status but ok."""
    result = simulate(scenario(*changes, {"record.rate": rate}, **more))
    assert result.ok, result.message
    return result


def tilted(angle):
    """Keys of a surface that falls along +x by an angle, rad."""
    return {"effects.surface_tilt.angle": float(angle)}


def slip_angle(coefficient, adhesion=ADHESION, mass=MASS, share=1.0):
    """Tilt (rad) at which a lying block uses a part of its friction cone: Eq. (15) for alpha."""

    def balance(angle):
        holding = coefficient * (np.cos(angle) + adhesion / (mass * GRAVITY))
        return np.sin(angle) - share * holding

    return brentq(balance, 0.0, 1.57, xtol=1e-15)


def slid(t, push, drag):
    """Velocity and way (m/s, m) at times t of the block that a force pushes from rest."""
    slow = MASS / drag
    gone = 1.0 - np.exp(-t / slow)
    return push / drag * gone, push / drag * (t - slow * gone)


def torque_about_corner(angle, corner_x, current, weight=WEIGHT):
    """Torque of field, gradient and weight on the block on its corner at theta = angle > 0, N m."""
    lean = np.arctan2(HEIGHT, LENGTH)
    lever, height = RADIUS * np.cos(angle + lean), RADIUS * np.sin(angle + lean)
    centre = [corner_x - lever, 0.0, height]
    moment = MOMENT * np.array([np.cos(angle), 0.0, -np.sin(angle)])
    field, force = Coils().field(centre, current), Coils().gradient(centre, current) @ moment
    turning = moment[2] * field[0] - moment[0] * field[2]
    return turning + height * force[0] + lever * (force[2] - weight)


def program(waveform):
    """Keys of a drive that plays `waveform`."""
    return {"drive.mode": "program", "drive.program": waveform}


def friction(static, kinetic=None):
    kinetic = static if kinetic is None else kinetic
    return {"contact.static_friction": static, "contact.kinetic_friction": kinetic}


def still_for(seconds):
    """Keys of a drive that does nothing for so long."""
    return program(Waveform.hold(seconds, {}))


def volts(in_plane=0.0, clamp=0.0):
    """Voltages of the two coils of a sawtooth for fields at the centre in T."""
    return {"xp": in_plane * volts_per_tesla(), "clamp": clamp * volts_per_tesla()}


# The moment stands straight up and the clamp coil's field points down: the gradient lifts the
# block, and without friction nothing turns it. The balance is unstable with a rate of 8300 / s, so
# the rounding of a quarter turn, 6e-17, becomes no more than 1e-14 within the throw of 0.5 ms.
LAUNCHER = {
    "effects.misalignment.angle": -np.pi / 2,
    "contact.static_friction": 0.0,
    "contact.kinetic_friction": 0.0,
    "contact.adhesion": 0.0, "drag.linear": 0.0, "drag.rotational": 0.0, "environment.gravity": 0.5,
    **QUICK_COILS,
}  # fmt: skip
THROW = 5e-4  # s


def launched(seconds):
    """Keys of a drive that throws the block up and then does nothing for so long."""
    lift = Waveform.hold(THROW, volts(clamp=-6.5e-3))
    return {**LAUNCHER, **program(lift + Waveform.hold(seconds, {}))}


def is_mode(of, codes):
    return np.isin(of.contact, codes)


def violations(of, slack=1e-9, start=0.0, speed_slack=0.0, gap_slack=0.0):
    """Violations of mechanics in a recording, one line each; an empty list for a sound one.

    slack: of forces, relative to weight, adhesion and normal force. start: s, samples before it
    are not looked at. speed_slack: m/s, of a slip against its mode's direction. gap_slack: m, of
    heights.
    """
    weight = of.scenario.robot.mass * of.scenario.environment.gravity
    force = slack * (weight + of.scenario.contact.adhesion + np.abs(of.normal_force))
    # Rounding of heights is 1e-20 m, and angles of many turns add a little.
    gaps = (max(1e-12, gap_slack), max(1e-16, gap_slack), max(1e-16, gap_slack))
    return laws.violations(Record.of(of), force, speed_slack, gaps, start)


def energy(of):
    """Kinetic, of gravity and of the moment in the field, J; for the direction "+x"."""
    s = of.scenario
    mass, length, height = s.robot.mass, s.robot.length, s.robot.height
    inertia = mass * (length**2 + height**2) / 12
    moment = s.robot.magnetization * length * s.robot.width * height
    tilt = s.get("effects.surface_tilt.angle")
    weight = mass * s.environment.gravity
    angle = of.theta + s.get("effects.misalignment.angle")
    return (
        0.5 * mass * (of.vx**2 + of.vz**2)
        + 0.5 * inertia * of.omega**2
        + weight * (np.cos(tilt) * of.z - np.sin(tilt) * of.x)
        - moment * (np.cos(angle) * of.bx - np.sin(angle) * of.bz)
    )


def program_of(volts) -> Waveform:
    """The five voltages of the reference (`reference.heading`) as a program."""
    ends = np.append(volts.start[1:-1], volts.end)
    last = volts.level[:-1] + volts.slope[:-1] * (ends - volts.start[:-1])[:, None]
    times = np.stack([volts.start[:-1], ends], axis=1).ravel()
    return Waveform.from_points(times, np.stack([volts.level[:-1], last], axis=1).reshape(-1, 5))
