"""Causes in friction and adhesion: analytic slides, limits of sticking, and reactions at rest."""

import numpy as np
import pytest

from helpers import (
    ADHESION,
    FLIGHT,
    MASS,
    MOMENT,
    TIGHT,
    WEIGHT,
    program,
    run,
    slid,
    slip_angle,
    still_for,
    tilted,
    volts,
)
from stickslip import Coils, Waveform

STATIC, KINETIC, DRAG = 0.2, 0.145, 1e-5  # -, -, N s/m
FORCE = WEIGHT + ADHESION  # N, the scale of reactions


def pressing(angle):
    """Reaction (N) of a block that lies on a tilt."""
    return WEIGHT * np.cos(angle) + ADHESION


def facing(direction):
    """+1 where the robot's front points along +x of the world."""
    return 1.0 if direction == "+x" else -1.0


@pytest.mark.parametrize("downhill", [1, -1])
@pytest.mark.parametrize("coefficient", [2.0, 50.0])
def test_viscous_friction_of_a_sliding_block_is_a_drag(coefficient, downhill):
    # m dv/dt = W sin a - (mu_k + k v) N - c v: terminal velocity and time constant.
    angle = 0.6
    normal = pressing(angle)
    push = WEIGHT * np.sin(angle) - KINETIC * normal
    keys = {"effects.viscous_friction.coefficient": coefficient}
    of = run(still_for(0.02), tilted(downhill * angle), keys, TIGHT, rate=5e3)
    velocity, place = slid(of.t[1:], push, DRAG + coefficient * normal)
    # Some tens of steps, each within 1e-10 of 0.1 m/s and 0.1 mm.
    assert downhill * of.vx[1:] == pytest.approx(velocity, abs=1e-9)
    assert downhill * of.x[1:] == pytest.approx(place, abs=1e-12)


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("fraction", [0.4, -0.4])
@pytest.mark.parametrize("downhill", [1, -1])
def test_anisotropic_friction_breaks_at_one_angle_forward_and_another_back(
    downhill, fraction, direction
):
    factor = 1.0 + fraction * facing(direction) * downhill
    limit = slip_angle(STATIC * factor)
    keys = {"effects.friction_anisotropy.fraction": fraction, "drive.direction": direction}
    below = run(still_for(0.05), keys, tilted(downhill * limit * (1 - 1e-9)), rate=1e3)
    assert np.all(below.x == 0.0)
    # Beyond the limit the kinetic coefficient acts, scaled as the static one.
    angle = limit * (1 + 1e-9)
    above = run(still_for(0.05), keys, tilted(downhill * angle), TIGHT, rate=1e3)
    push = WEIGHT * np.sin(angle) - KINETIC * factor * pressing(angle)
    velocity, _ = slid(above.t[1:], push, DRAG)
    assert downhill * above.vx[1:] == pytest.approx(velocity, abs=1e-9)
    assert push > 1e-3 * DRAG


def tipped(strength, clamp):
    """A block at rest at some 45 degrees, nose down or up, on a sticky surface."""
    final = volts(in_plane=2.5e-3, clamp=clamp * 2.5e-3)
    keys = {
        "effects.angle_adhesion.strength": strength,
        "effects.rotational_drag.coefficient": 1e-12,
        "contact.static_friction": 50.0,
    }
    return run(program(Waveform.ramp(0.5, final) + Waveform.hold(1.5, final)), keys, rate=10.0)


@pytest.mark.parametrize("clamp", [1, -1])
@pytest.mark.parametrize("strength", [0.9, 0.3, -2.0])
def test_adhesion_of_a_tilted_block_falls_with_the_sine_squared(strength, clamp):
    of = tipped(strength, clamp)
    theta = of.theta[-1]
    assert -clamp * theta > 0.6
    moment = MOMENT * np.array([np.cos(theta), 0.0, -np.sin(theta)])
    lift = (Coils().gradient([of.x[-1], 0.0, of.z[-1]], of.current[-1]) @ moment)[2]
    adhesion = ADHESION * (1.0 - strength * np.sin(theta) ** 2)
    # The rest of the rocking, 1e-7 of the swing a step, turns inertia into 1e-6 of the force.
    assert of.normal_force[-1] == pytest.approx(WEIGHT + adhesion - lift, abs=1e-5 * FORCE)
    # It acts at the corner itself, so it does not change the angle.
    assert theta == pytest.approx(tipped(0.0, clamp).theta[-1], abs=1e-5)
    # Lying, it is all there.
    assert of.normal_force[0] == pytest.approx(FORCE, rel=1e-12)


@pytest.mark.parametrize(("rate", "time"), [(0.3, 1e-2), (2.0, 5.0)])
def test_adhesion_of_a_resting_block_grows_with_the_logarithm_of_time(rate, time):
    # Over stretches of voltage too, which it has nothing to do with.
    waveform = Waveform.hold(0.3, {}) + 5 * Waveform.sawtooth(0.1, {}, {"yp": 1e-3})
    keys = {"effects.adhesion_ageing.rate": rate, "effects.adhesion_ageing.time": time}
    of = run(program(waveform), keys, rate=200.0)
    expected = WEIGHT + ADHESION * (1.0 + rate * np.log(1.0 + of.t / time))
    # The coil's gradient pulls at the moment with 1e-16 N.
    assert of.normal_force == pytest.approx(expected, rel=1e-9)
    assert np.all(of.x == 0.0)


def test_sliding_block_is_stopped_by_the_ageing_of_its_adhesion():
    # It slides from the start, pressed by N(t): v' = g sin a - mu_k N(t) / m, whose integral is
    # closed. A slide is a contact that lasts.
    angle, rate, time = 0.45, 0.5, 1e-3
    keys = {
        "effects.adhesion_ageing.rate": rate,
        "effects.adhesion_ageing.time": time,
        "drag.linear": 0.0,
    }
    of = run(still_for(0.02), keys, tilted(angle), TIGHT, rate=1e4)
    t = of.t
    aged = t + rate * ((t + time) * np.log1p(t / time) - t)  # integral of 1 + k ln(1 + t/T)
    push = (WEIGHT * np.sin(angle) - KINETIC * WEIGHT * np.cos(angle)) * t
    velocity = (push - KINETIC * ADHESION * aged) / MASS
    slides = of.vx > 0.0
    assert slides.sum() > 10
    assert of.vx[slides] == pytest.approx(velocity[slides], abs=1e-9)


def test_ageing_starts_again_at_touch_down():
    keys = {"effects.adhesion_ageing.rate": 0.5, "effects.adhesion_ageing.time": 1e-3}
    hops = Waveform.opp(hold=2.5e-3, base=0.0, pulses=4, ramp_down=0.01)
    scenario = [program(hops + Waveform.hold(0.2, {})), keys]
    of, events = run(*scenario, rate=1e5), run(*scenario, rate="events")
    flew = of.t[of.contact == FLIGHT][-1]
    assert 0.05 < flew < 0.1
    downs = events.t[events.event == events.event_names.index("touch_down")]
    touched = downs[downs > flew][0]
    assert touched - flew < 2e-5
    still = (of.t > 0.25) & (of.contact == 4)
    age = of.t[still] - touched
    expected = WEIGHT + ADHESION * (1.0 + 0.5 * np.log(1.0 + age / 1e-3))
    # 130 ms after the last voltage the currents are at e^-18.
    assert of.normal_force[still] == pytest.approx(expected, rel=1e-6)
    assert still.sum() > 1000
