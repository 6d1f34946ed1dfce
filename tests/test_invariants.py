"""What holds at every instant of a run: contact laws, energy, kinematics."""

import numpy as np
import pytest

from free_shapes import shaped
from helpers import (
    FLIGHT,
    FORWARD,
    GRAVITY,
    INERTIA,
    MASS,
    MOMENT,
    NO_FIELD,
    ON_A_FACE,
    QUICK_COILS,
    STICKING,
    check_energy_balance,
    energy,
    is_mode,
    program,
    run,
    run_and_quiet_samples,
    violations,
    volts,
)
from stickslip import Coils, Waveform

CASES = {
    "IPP": {"mode": "IPP", "base": 0.5e-3},
    "IPP-up-fall": {
        "mode": "IPP",
        "base": 0.5e-3,
        "clamp": "up",
        "edge": "fall",
        "frequency": 30.0,
    },
    "IPP-on-end": {"mode": "IPP", "base": 0.0},
    "OPP-hops": {"mode": "OPP", "hold": 2.5e-3, "base": 0.0},
    "OPP-fall": {"mode": "OPP", "hold": 2.5e-3, "base": 0.5e-3, "edge": "fall", "frequency": 30.0},
    "OPP-turned": {"mode": "OPP", "hold": 1.5e-3, "base": 0.5e-3, "direction": "-x"},
}
KEYS = {
    "default": {},
    "equal friction": {"contact.static_friction": 0.3, "contact.kinetic_friction": 0.3},
    "low friction": {"contact.static_friction": 0.05, "contact.kinetic_friction": 0.035},
    "rebound": {"contact.restitution": 0.5},
    "tilt": {"effects.surface_tilt.angle": -0.1},
    "stribeck": {"effects.stribeck_friction.velocity": 1e-3},
}
cases = pytest.mark.parametrize("drive", CASES.values(), ids=CASES)


@cases
@pytest.mark.parametrize("keys", KEYS.values(), ids=KEYS)
@pytest.mark.parametrize("rate", ["events", 1e5])
def test_contact_laws_hold_at_every_sample(drive, keys, rate):
    # At a tight tolerance, so that no visit to a limit is too short to be seen.
    moving = run(keys, {"solver.rtol": 1e-10}, rate=rate, pulses=6, **drive)
    assert len(np.unique(moving.contact)) >= 3
    assert not violations(moving)


@cases
def test_contact_laws_hold_at_the_default_tolerance_too(drive):
    assert not violations(run(rate=1e5, pulses=6, **drive))


@cases
def test_accelerations_are_those_of_the_recorded_forces(drive):
    # Eqs. (10)-(12) along and across the surface, and about the centre of mass: central differences
    # against forces that are computed anew.
    rate = 1e6
    sign = -1.0 if drive.get("direction") == "-x" else 1.0
    period = 1.0 / drive.get("frequency", 100.0)
    drive = {**drive, "ramp": 0.01, "pulses": 2}
    edges = 0.01 + period * np.arange(3)
    seen, quiet = run_and_quiet_samples({"solver.rtol": 1e-11}, drive, rate, edges)
    chosen = np.flatnonzero(quiet)[::97]
    assert len(chosen) > 200
    points = np.column_stack([seen.x, np.zeros_like(seen.x), seen.z])[chosen]
    coils = Coils()
    field = coils.field(points, seen.current[chosen])
    slope = coils.gradient(points, seen.current[chosen])
    assert seen.bx[chosen] == pytest.approx(field[:, 0], rel=1e-8, abs=1e-12)
    assert seen.bz[chosen] == pytest.approx(field[:, 2], rel=1e-8, abs=1e-12)
    theta, omega = seen.theta[chosen], seen.omega[chosen]
    mx, mz = sign * MOMENT * np.cos(theta), -MOMENT * np.sin(theta)
    normal, friction = seen.normal_force[chosen], seen.friction_force[chosen]
    flying = seen.contact[chosen] == FLIGHT
    lying = is_mode(seen, ON_A_FACE)[chosen]
    adhesion = np.where(flying, 0.0, 0.22e-6)
    fx = mx * slope[:, 0, 0] + mz * slope[:, 2, 0] + friction - 1e-5 * seen.vx[chosen]
    fz = mx * slope[:, 0, 2] + mz * slope[:, 2, 2] + normal - 1e-5 * seen.vz[chosen]
    fz -= MASS * GRAVITY + adhesion
    # Lever of a single corner; a lying face has two, and does not turn.
    lever = np.nan_to_num(seen.contact_x[chosen] - points[:, 0])
    torque = mz * field[:, 0] - mx * field[:, 2]
    torque = sign * torque - 9e-17 * np.abs(omega) * omega
    torque -= sign * lever * (normal - adhesion) + sign * points[:, 2] * friction

    def rates(values):
        return ((values[2:] - values[:-2]) * rate / 2)[chosen - 1]

    # Third derivatives of a swing of up to 1000 Hz: (2 pi 1000 Hz us)^2 / 6 = 7e-6 of each part.
    scale = 9e-6
    assert MASS * rates(seen.vx) == pytest.approx(fx, abs=scale * MOMENT * 2.5e-3 / 1e-4)
    assert MASS * rates(seen.vz) == pytest.approx(fz, abs=scale * MOMENT * 2.5e-3 / 1e-4)
    torque[lying] = 0.0
    assert INERTIA * rates(seen.omega) == pytest.approx(torque, abs=scale * MOMENT * 2.5e-3)


def _steps(final):
    """Voltages that step at once and then stay, three times."""
    return sum((Waveform.hold(0.02, volts(*pair)) for pair in final[1:]),
               Waveform.hold(0.02, volts(*final[0])))  # fmt: skip


STEPS = [(2.5e-3, -1e-3), (0.5e-3, -2.5e-3), (2e-3, 1.5e-3)]


@pytest.mark.parametrize("restitution", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("friction", [0.0, 0.2, 1.0])
@pytest.mark.parametrize("drag", [0.0, 1e-5])
@pytest.mark.parametrize("knots", [(0.0,) * 5, (0.2, -0.15, 0.1, 0.2, -0.1)], ids=["", "beside"])
def test_energy_never_grows_in_constant_currents(knots, drag, friction, restitution):
    # Adhesion does no work: it holds what does not rise, is gone the moment that this leaves, and
    # acts again only on what has landed. What is left are conservative forces and losses, also
    # where the contact lies beside the corner, and rolls.
    keys = {
        **shaped("free_contact_place", knots),
        "contact.static_friction": friction,
        "contact.kinetic_friction": 0.7 * friction,
        "contact.restitution": restitution,
        "drag.linear": drag,
        "drag.rotational": 0.0,
        "solver.rtol": 1e-11,
        **QUICK_COILS,
    }
    moving = run(keys, program(_steps(STEPS)), rate=1e5)
    scale = MOMENT * 2.5e-3
    inside = (moving.t % 0.02 > 2e-5) & (moving.t % 0.02 < 0.02 - 1.5e-5)
    gain = np.diff(energy(moving))[inside[1:] & inside[:-1]]
    assert gain.max() < 1e-9 * scale
    if drag or (friction and restitution < 0.9):
        assert gain.sum() < -1e-3 * scale
    elif friction or restitution < 1.0:
        assert gain.sum() < 0.0  # a corner that sticks may rebound at the bound, without loss
    else:
        assert np.mean(moving.contact == FLIGHT) > 0.1
        assert np.abs(gain).max() < 1e-9 * scale


@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize("drag", [0.0, 1e-5])
def test_a_body_that_tumbles_in_flight_lands_as_it_is(drag, friction, restitution):
    # Thrown about by fields that step, it makes more than half a turn. The angle may not jump: at
    # most 1e4 rad/s within a microsecond.
    keys = {
        "contact.static_friction": friction,
        "contact.kinetic_friction": friction,
        "contact.restitution": restitution,
        "contact.adhesion": 0.0,
        "drag.linear": drag,
        "drag.rotational": 0.0,
        **QUICK_COILS,
    }
    moving = run(keys, program(_steps([*STEPS, (-3e-3, 1e-3), (1e-3, 5e-3)])), rate=1e6)
    assert np.ptp(moving.theta) > np.pi
    fastest = np.abs(moving.omega).max()
    assert fastest < 2e4
    assert np.abs(np.diff(moving.theta)).max() < 2e-6 * fastest
    assert not violations(moving, slack=1e-2, speed_slack=1e-4, gap_slack=1e-9)


@cases
def test_energy_balance_with_the_work_of_the_changing_field(drive):
    # dE/dt = -m . dB/dt at a fixed place, less what drag and friction take, in every mode.
    drive = {**drive, "direction": "+x", "ramp": 0.01, "pulses": 3}
    rate = 5e5
    edges = 0.01 + np.arange(4) / drive.get("frequency", 100.0)
    seen, quiet = run_and_quiet_samples({"solver.rtol": 1e-11}, drive, rate, edges)
    points = np.column_stack([seen.x, np.zeros_like(seen.x), seen.z])
    per_ampere = np.array([Coils().field(points, np.eye(5)[k]) for k in (0, 4)])  # (2, n, 3)
    change = np.gradient(seen.current[:, [0, 4]], 1 / rate, axis=0)
    bx_rate = (change.T * per_ampere[:, :, 0]).sum(axis=0)
    bz_rate = (change.T * per_ampere[:, :, 2]).sum(axis=0)
    mx, mz = MOMENT * np.cos(seen.theta), -MOMENT * np.sin(seen.theta)
    power = -(mx * bx_rate + mz * bz_rate)
    power -= 1e-5 * (seen.vx**2 + seen.vz**2) + 9e-17 * np.abs(seen.omega) ** 3
    power += seen.friction_force * np.nan_to_num(seen.slip_velocity)
    check_energy_balance(seen, power, quiet, rate)


def test_modes_say_what_the_slip_velocity_says():
    seen = run(rate=1e5, base=0.5e-3, pulses=10)
    slip, flying = seen.slip_velocity, seen.contact == FLIGHT
    assert np.array_equal(np.isnan(slip), flying)
    assert np.array_equal(np.isnan(seen.contact_x), flying)
    sticking, forward = is_mode(seen, STICKING), is_mode(seen, FORWARD)
    backward = ~flying & ~sticking & ~forward
    for mode in (sticking, forward, backward):
        assert mode.any()
    assert np.all(slip[sticking] == 0.0)
    assert np.all(slip[forward] >= 0.0)
    assert np.all(slip[backward] <= 0.0)
    assert np.all(seen.friction_force[forward] <= 0.0)
    assert np.all(seen.friction_force[backward] >= 0.0)


def test_slip_of_the_summary_is_that_of_the_recording():
    seen = run({"solver.rtol": 1e-10}, rate=1e6, base=0.5e-3, pulses=6)
    window = (seen.t >= 0.08) & (seen.t <= 0.11)
    slip = np.nan_to_num(seen.slip_velocity)[window] * (seen.contact[window] < 4)
    rising = seen.omega[window] > 0
    summary = seen.summary()
    # Sums over samples of 1 us against slips of 1 ms and more.
    scale = np.abs(slip).mean()
    assert summary["slip_up"] == pytest.approx((slip * rising).mean(), abs=2e-3 * scale)
    assert summary["slip_down"] == pytest.approx((slip * ~rising).mean(), abs=2e-3 * scale)


def test_a_block_without_field_on_the_level_does_nothing():
    still = run(NO_FIELD, rate=1e3, pulses=4)
    assert np.all(still.x == 0.0)
    assert sum(still.summary()["events"].values()) == 0
