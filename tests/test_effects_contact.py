"""Causes in friction and adhesion: analytic slides, limits of sticking, and reactions at rest."""

import numpy as np
import pytest

from helpers import (
    ADHESION,
    FLIGHT,
    FORWARD,
    HEIGHT,
    HOPS,
    MASS,
    MOMENT,
    ON_A_CORNER,
    ON_A_FACE,
    QUICK_COILS,
    STICKING,
    TIGHT,
    WEIGHT,
    is_mode,
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


# What each cause makes of the kinetic (or, at no velocity, static) coefficient. way: +1 for a slip
# to the robot's front; x: in the world.
LAWS = {
    "viscous": (
        {"effects.viscous_friction.coefficient": 20.0},
        lambda mu, way, speed, x: mu + 20.0 * speed,
    ),
    "anisotropy": (
        {"effects.friction_anisotropy.fraction": 0.3},
        lambda mu, way, speed, x: mu * (1.0 + 0.3 * way),
    ),
    "patches": (
        {"effects.friction_patches.amplitude": 0.4, "effects.friction_patches.period": 50e-6},
        lambda mu, way, speed, x: mu * (1.0 + 0.4 * np.sin(2.0 * np.pi * x / 50e-6)),
    ),
    "all": (
        {
            "effects.viscous_friction.coefficient": 20.0,
            "effects.friction_anisotropy.fraction": -0.3,
            "effects.friction_patches.amplitude": 0.4,
            "effects.friction_patches.period": 50e-6,
        },
        lambda mu, way, speed, x: (
            (mu + 20.0 * speed) * (1.0 - 0.3 * way) * (1.0 + 0.4 * np.sin(2.0 * np.pi * x / 50e-6))
        ),
    ),
}


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("name", LAWS)
def test_driven_corner_is_held_by_the_law_of_friction(name, direction):
    keys, law = LAWS[name]
    of = run(keys, rate=2e4, direction=direction, **HOPS)
    corner, sticks = is_mode(of, ON_A_CORNER), is_mode(of, STICKING)
    to_x = np.where(is_mode(of, FORWARD), 1.0, -1.0)
    speed = np.abs(np.nan_to_num(of.slip_velocity))
    x = np.where(corner, of.contact_x, of.x)  # a face counts where its middle is
    expected = -to_x * law(KINETIC, facing(direction) * to_x, speed, x) * of.normal_force
    slips = (of.contact != FLIGHT) & ~sticks
    assert of.friction_force[slips] == pytest.approx(expected[slips], abs=1e-12 * FORCE)
    assert (slips & corner & (to_x > 0)).sum() > 20
    assert (slips & corner & (to_x < 0)).sum() > 20
    # A stick is held against the side to which it would slip, by no more than its limit there.
    way = -np.sign(of.friction_force) * facing(direction)
    limit = law(STATIC, way, 0.0, x) * of.normal_force
    assert np.all((np.abs(of.friction_force) - limit)[sticks] < 1e-9 * FORCE)
    assert of.mean_velocity != run(**HOPS, direction=direction).mean_velocity


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


@pytest.mark.parametrize("coefficient", [0.0, 30.0])
def test_viscous_friction_stops_a_slide_in_the_time_of_a_logarithm(coefficient):
    # Pulled by the +x coil's gradient, then let go: from v0, v = (v0 + u) e^(-t/T) - u with
    # u = mu_k N / (c + k N), which ends at t = T ln(1 + v0/u).
    pulled = 0.02
    waveform = Waveform.hold(pulled, volts(in_plane=6.5e-3)) + Waveform.hold(0.02, {})
    keys = {"effects.viscous_friction.coefficient": coefficient, "contact.adhesion": 0.0}
    of = run(program(waveform), QUICK_COILS, keys, TIGHT, rate=1e5)
    # The currents are gone within 2 us.
    free = of.t > pulled + 2e-6
    t, v = of.t[free], of.vx[free]
    total = DRAG + coefficient * WEIGHT
    slow, u = MASS / total, KINETIC * WEIGHT / total
    sliding = v > 0.0
    assert sliding.sum() > 20
    expected = (v[0] + u) * np.exp(-(t - t[0]) / slow) - u
    assert v[sliding] == pytest.approx(expected[sliding], abs=1e-9)
    stop = t[0] + slow * np.log1p(v[0] / u)
    assert t[sliding][-1] == pytest.approx(stop, abs=1.01e-5)  # a sample is 10 us
    assert np.abs(v[~sliding]).max() < 1e-15


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


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("downhill", [1, -1])
@pytest.mark.parametrize("amplitude", [0.5, -0.5])
def test_patches_take_the_work_of_their_friction(amplitude, downhill, direction):
    # Without drag, m v^2 / 2 = (W sin a - mu N) s - mu N times the integral of the sine along the
    # way, from x = 0 to downhill s in the world. Over a whole period the sine takes nothing.
    angle, period = 0.55, 80e-6
    keys = {
        "effects.friction_patches.amplitude": amplitude,
        "effects.friction_patches.period": period,
        "drag.linear": 0.0,
        "drive.direction": direction,
    }
    of = run(still_for(0.04), keys, tilted(downhill * angle), TIGHT, rate=1e4)
    friction = KINETIC * pressing(angle)
    wave = 2.0 * np.pi / period
    path = downhill * of.x
    sine = downhill * amplitude * (1.0 - np.cos(wave * path)) / wave
    work = (WEIGHT * np.sin(angle) - friction) * path - friction * sine
    assert path[-1] > 5.0 * period
    # Velocities within 1e-9 of 0.1 m/s, at some mm/s: energies within 1e-7 of 1e-13 J.
    assert 0.5 * MASS * of.vx**2 == pytest.approx(work, rel=1e-6, abs=1e-20)
    expected = friction * (1.0 + amplitude * np.sin(wave * of.x))
    assert -downhill * of.friction_force[1:] == pytest.approx(expected[1:], rel=1e-12)


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("amplitude", [0.6, -0.6])
def test_patches_decide_where_a_block_breaks_loose(amplitude, direction):
    # Pulled to somewhere, left alone, then pulled by a slowly growing gradient until it slips.
    strong = volts(in_plane=6.5e-3)
    waveform = Waveform.hold(0.02, strong) + Waveform.hold(0.1, {}) + Waveform.ramp(1.0, strong)
    keys = {
        "effects.friction_patches.amplitude": amplitude,
        "effects.friction_patches.period": 333e-6,
        "contact.adhesion": 0.0,
        "drive.direction": direction,
    }
    of = run(program(waveform), keys, rate="events")
    first = np.flatnonzero((of.event == of.event_names.index("slip_start")) & (of.t > 0.1))[0]
    moment = facing(direction) * MOMENT
    x = of.x[first]
    assert facing(direction) * x > 20e-6  # the coil repels a moment along -x
    gradient = Coils().gradient([[x, 0.0, HEIGHT / 2]], of.current[first])[0]
    along, pressed = moment * gradient[0, 0], WEIGHT - moment * gradient[2, 0]
    coefficient = STATIC * (1.0 + amplitude * np.sin(2.0 * np.pi * x / 333e-6))
    assert abs(coefficient / STATIC - 1.0) > 0.2
    assert abs(along) == pytest.approx(coefficient * pressed, rel=1e-7)


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


@pytest.mark.parametrize("strength", [1.0, 0.5, -3.0])
def test_block_that_stands_keeps_one_minus_the_strength(strength):
    stand = {
        "effects.ambient_field.Bz": -5e-3,
        "effects.rotational_drag.coefficient": 1e-12,
        "contact.static_friction": 50.0,
        "effects.angle_adhesion.strength": strength,
    }
    of = run(still_for(0.5), stand, rate=10.0)
    assert of.theta[-1] == pytest.approx(np.pi / 2, abs=1e-12)
    assert is_mode(of, ON_A_FACE)[-1]
    expected = WEIGHT + ADHESION * (1.0 - strength)
    assert of.normal_force[-1] == pytest.approx(expected, rel=1e-9)


def test_tilted_adhesion_lets_go_where_the_law_says():
    # Standing on its front without adhesion it slides beyond atan(mu), long before it would lying.
    # With one coefficient, what it slid as it tipped comes to rest below that.
    bare = np.arctan(STATIC)
    for share, slips in ((0.99, False), (1.01, True)):
        keys = {
            "effects.ambient_field.Bz": -5e-3,
            "effects.rotational_drag.coefficient": 1e-12,
            "effects.angle_adhesion.strength": 1.0,
            "contact.kinetic_friction": STATIC,
        }
        of = run(still_for(0.6), keys, tilted(share * bare), rate=100.0)
        late = of.t > 0.4
        assert is_mode(of, ON_A_FACE)[late].all()
        assert (np.ptp(of.x[late]) > 0.0) == slips


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


def test_ageing_holds_a_tilted_block_that_begins_to_slip_later():
    # Beyond the slip angle it slides at once; below it adhesion only grows: nothing ever moves.
    limit = slip_angle(STATIC)
    keys = {"effects.adhesion_ageing.rate": 1.0, "effects.adhesion_ageing.time": 1e-3}
    assert np.all(run(still_for(0.1), keys, tilted(limit * (1 - 1e-9)), rate=1e3).x == 0.0)
    assert run(still_for(0.1), keys, tilted(limit * (1 + 1e-9)), rate=1e3).x[-1] > 0.0


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
