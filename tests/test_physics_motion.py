"""Frequencies, flight, rebound and energy against closed forms."""

import numpy as np
import pytest
from scipy.optimize import brentq

from free_shapes import shaped
from helpers import (
    FLIGHT,
    HEIGHT,
    INERTIA,
    LAUNCHER,
    MASS,
    MOMENT,
    ON_A_FACE,
    QUICK_COILS,
    RADIUS,
    THROW,
    energy,
    launched,
    program,
    run,
    torque_about_corner,
    volts,
)
from stickslip import Coils, Waveform

# 842 and 421 Hz are the frequencies of a block of 24.05 ug, density times volume; with the mass of
# Table II it turns more slowly by 3 %.
masses = pytest.mark.parametrize(("mass", "scale"), [(24.05e-9, 1.0), (MASS, 0.96926)])

NO_MOTION = {"contact.adhesion": 1.0}


def frequency_of(t, wave):
    """Hz, from the zero crossings of a wave about its mean over whole periods."""
    wave = wave - 0.5 * (wave.max() + wave.min())
    before = np.flatnonzero((wave[:-1] < 0.0) & (wave[1:] >= 0.0))
    share = wave[before] / (wave[before] - wave[before + 1])
    crossing = t[before] + share * (t[before + 1] - t[before])
    return (len(crossing) - 1) / (crossing[-1] - crossing[0])


def damped_frequency_of(wave, rate):
    """Hz and 1/s, of a damped sine about some level, sampled at `rate` (Hz), without noise."""
    # Any such wave obeys y(n) = 2 q cos(a) y(n - k) - q^2 y(n - 2k) + constant.
    k = 60  # samples, about a quarter of a period: the best condition
    terms = np.column_stack([wave[k:-k], wave[: -2 * k], np.ones(len(wave) - 2 * k)])
    first, second, _ = np.linalg.lstsq(terms, wave[2 * k :], rcond=None)[0]
    decay = np.sqrt(-second)
    return np.arccos(first / (2 * decay)) * rate / k / (2 * np.pi), -np.log(decay) * rate / k


def test_free_fall_is_a_parabola():
    fall = run(launched(0.02), rate=1e4)
    flying = (fall.contact == FLIGHT) & (fall.t > THROW + 1e-4)  # the coil's current is gone
    assert flying.sum() > 100
    t, z = fall.t[flying], fall.z[flying]
    assert np.ptp(z) > 1e-6
    fit = np.polynomial.Polynomial.fit(t, z, 2)
    assert fit.convert().coef[2] == pytest.approx(-0.5 / 2, rel=1e-6)
    assert np.abs(fit(t) - z).max() < 1e-13
    # Eq. (8): the throw itself, by the gradient that Coils gives where the block lies.
    current = fall.current[int(THROW * 1e4) - 1]
    pull = MOMENT * Coils().gradient([[0.0, 0.0, HEIGHT / 2]], current)[0, 2, 2]
    speed = (pull / MASS - 0.5) * THROW
    # The current needs 0.1 us of 500 us, and the gradient falls by 1e-4 over the first micrometre.
    assert fit.deriv()(THROW) == pytest.approx(speed, rel=1e-3)


def test_flat_block_that_is_pulled_straight_up_leaves_with_both_ends_at_once():
    # The uniform field holds the block upright. Friction is there, but nothing for it to do.
    keys = {
        "contact.static_friction": 0.2,
        "contact.kinetic_friction": 0.145,
        "effects.ambient_field.Bz": 0.02,
    }
    flight = run(launched(0.005), keys, rate=1e3)
    assert flight.summary()["events"]["lift_off"] == 1
    assert flight.contact[-1] == FLIGHT
    assert np.abs(flight.x).max() < 1e-12
    assert np.abs(flight.theta).max() < 1e-9


@pytest.mark.parametrize("restitution", [0.3, 0.5, 0.9])
def test_bounce_heights_fall_by_the_square_of_the_restitution(restitution):
    keys = {"contact.restitution": restitution}
    bounce = run(launched(0.2), keys, rate="events")
    impacts = bounce.event == bounce.event_names.index("touch_down")
    count = 4
    speed, t = bounce.vz[impacts][:count], bounce.t[impacts][:count]
    assert speed.min() > 1e-5
    assert speed[1:] / speed[:-1] == pytest.approx(restitution, rel=1e-6)
    # A hop lasts 2 v / g and rises v^2 / 2g.
    assert np.diff(t) == pytest.approx(2 * speed[:-1] / 0.5, rel=1e-6)
    fine = run(launched(0.2), keys, rate=1e5)
    for k in range(count - 1):
        hop = (fine.t > t[k]) & (fine.t < t[k + 1])
        top = fine.z[hop].max() - HEIGHT / 2
        # The highest sample misses the top by less than g (5 us)^2 / 2.
        assert top == pytest.approx(speed[k] ** 2 / (2 * 0.5), abs=0.25 * 5e-6**2 + 1e-12)


def test_without_restitution_a_landing_ends_all_motion():
    fall = run(launched(0.2), rate="events")
    assert fall.summary()["events"]["touch_down"] == 1
    assert (fall.z[-1], fall.vz[-1], fall.omega[-1]) == (HEIGHT / 2, 0.0, 0.0)


def test_bounces_that_die_out_come_to_rest():
    end = run(launched(0.2), {"contact.restitution": 0.3}, rate=1e3)
    assert end.contact[-1] in ON_A_FACE
    assert (end.z[-1], end.vz[-1], end.omega[-1]) == (HEIGHT / 2, 0.0, 0.0)
    # Speeds fall from 3.6 mm/s to below 1 um/s: ln(3600) / ln(1 / 0.3) = 6.8 impacts.
    assert end.summary()["events"]["touch_down"] == 7


@masses
def test_turning_frequency_in_flight(mass, scale):
    # Thrown up without gravity the block flies on in the uniform field along its moment, and a
    # small field across makes it swing about the sum of the two.
    field, across = 2.5e-3, 0.01
    keys = {
        "robot.mass": mass,
        "environment.gravity": 0.0,
        "effects.ambient_field.Bz": field,
        "solver.rtol": 1e-9,
    }
    throw = Waveform.hold(2e-4, volts(clamp=-2e-3))
    swing = Waveform.hold(0.05, volts(in_plane=across * field))
    flight = run({**LAUNCHER, **keys, **program(throw + swing)}, rate=1e5)
    late = flight.t > 1e-3
    assert np.all(flight.contact[late] == FLIGHT)
    expected = np.sqrt(MOMENT * field / (INERTIA * mass / MASS)) / (2 * np.pi)
    assert expected == pytest.approx(842.0 * scale, abs=0.6)
    # A swing of 0.01 rad is slower by 0.01^2 / 16, and the sum of the fields longer by 0.01^2 / 2.
    measured = frequency_of(flight.t[late], flight.theta[late])
    assert measured == pytest.approx(expected, rel=1e-4)
    assert np.ptp(flight.theta[late]) > across


@masses
@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_rocking_frequency_pinned_at_a_corner(gravity, mass, scale):
    # Adhesion holds the corner and exerts no torque about it. The block is brought to 45 degrees
    # slowly and with damping, then the clamp's field steps by a little.
    field, damping = 2.5e-3, 1e-13
    component = field / np.sqrt(2)
    keys = {
        "robot.mass": mass,
        "environment.gravity": gravity,
        "contact.adhesion": 1e-6,
        "contact.static_friction": 10.0,
        "contact.kinetic_friction": 10.0,
        "drag.linear": 0.0,
        "drag.rotational": 0.0,
        "effects.rotational_drag.coefficient": damping,
        **QUICK_COILS,
    }
    end, stepped = volts(component, -component), volts(component, -1.01 * component)
    waveform = Waveform.ramp(0.3, end) + Waveform.hold(0.5, end) + Waveform.hold(0.05, stepped)
    rock = run(keys, program(waveform), rate=1e5)
    late = rock.t > 0.8001
    assert np.all(rock.contact[late] == rock.contact_names.index("corner_stick"))
    theta = rock.theta[late]
    # Torque about the corner at the angle theta: that of the moment, the weight's, and that of the
    # coils' gradients, whose slope with theta is the stiffness; taken here by differences.
    at = rock.contact_x[late][-1], rock.current[late][-1], mass * gravity

    def torque(angle):
        return torque_about_corner(angle, *at)

    middle = brentq(torque, 0.5, 1.0)
    stiffness = -(torque(middle + 1e-4) - torque(middle - 1e-4)) / 2e-4
    about_corner = (INERTIA / MASS + RADIUS**2) * mass
    slowing = damping / (2 * about_corner)
    expected = np.sqrt(stiffness / about_corner - slowing**2) / (2 * np.pi)
    ideal = np.sqrt(MOMENT * field / about_corner) / (2 * np.pi)
    assert ideal == pytest.approx(421.0 * scale, abs=0.6)
    # Weight and gradients change the stiffness by up to 2 %.
    assert expected == pytest.approx(ideal, rel=0.02)
    # The amplitude of 0.005 rad makes the swing slower by 2e-6.
    frequency, decay = damped_frequency_of(theta, 1e5)
    assert frequency == pytest.approx(expected, rel=2e-5)
    assert decay == pytest.approx(slowing, rel=1e-3)


@pytest.mark.parametrize("edge", ["rise", "fall"])
def test_first_harmonic_of_100_hz_reaches_the_field_with_a_gain_of_0_22(edge):
    # 1 / sqrt(1 + (2 pi 100 Hz 7 ms)^2) = 0.2217. The sawtooth's first harmonic is its height / pi.
    teeth = run(NO_MOTION, edge=edge, base=0.5e-3, pulses=20, rate=1e5)
    period = teeth.t >= teeth.t[-1] - 0.01 + 0.5e-5  # 1000 samples, transients are e^-20 of it
    assert period.sum() == 1000
    field = teeth.bx[period]
    harmonic = 2.0 * np.abs(np.mean(field * np.exp(-2j * np.pi * np.arange(1000) / 1000)))
    gain = harmonic / (2.0e-3 / np.pi)
    # The field is 50 um above the centre, where it differs by 1e-6.
    assert gain == pytest.approx(0.2217, rel=1e-3)


def test_peak_names_the_field_that_a_voltage_would_reach():
    steady = run(NO_MOTION, base=2.5e-3, pulses=20, rate=1e3)
    assert steady.bx[-1] == pytest.approx(2.5e-3, rel=1e-5)
    assert steady.bz[-1] == pytest.approx(-1e-3, rel=1e-3)  # 50 um above the centre: 18.6 / m
    assert steady.current[-1, 0] == pytest.approx(2.5e-3 / 0.96258e-3, rel=1e-4)


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
