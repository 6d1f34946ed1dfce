"""What must not move does not, what slides does so as Newton says, under every contact."""

import numpy as np
import pytest

from helpers import (
    ADHESION,
    FLIGHT,
    GRAVITY,
    HEIGHT,
    LENGTH,
    MASS,
    MOMENT,
    NO_FIELD,
    ON_A_CORNER,
    RADIUS,
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

STICK_ON_A_CORNER = 1


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("downhill", [1, -1])
def test_flat_block_at_nine_tenths_of_the_cone_stays_for_a_minute(direction, downhill):
    angle = downhill * slip_angle(0.2, ADHESION, share=0.9)
    drive = {"frequency": 1.0, "pulses": 60, "direction": direction}
    held = run(NO_FIELD, tilted(angle), rate=10.0, **drive)
    assert held.t[-1] == 60.0
    load = np.abs(held.friction_force) / (0.2 * held.normal_force)
    assert load == pytest.approx(0.9, rel=1e-9)
    assert np.all(held.x == 0.0)
    assert np.all(held.theta == 0.0)
    assert held.mean_velocity == 0.0
    assert sum(held.summary()["events"].values()) == 0


@pytest.mark.parametrize("clamp", ["down", "up"])
def test_corner_at_nine_tenths_of_the_cone_stays_for_a_minute(clamp):
    # Tipped by a slow ramp to some 45 degrees, damped, on a tilt that loads the corner sideways.
    # How much is read off a run that cannot slip, and friction then chosen for 0.9 of its cone.
    keys = {**tilted(0.15), "effects.rotational_drag.coefficient": 1e-12}
    drive = {
        "mode": "IPP", "base": 2.5e-3, "peak": 2.5e-3, "hold": 2.5e-3, "clamp": clamp,
        "ramp": 0.5, "frequency": 1.0,
    }  # fmt: skip
    sticky = {"contact.static_friction": 50.0, "contact.kinetic_friction": 50.0}
    end = run(keys, sticky, rate=100.0, pulses=4, **drive)
    needed = abs(end.friction_force[-1]) / end.normal_force[-1]
    friction = {"contact.static_friction": needed / 0.9, "contact.kinetic_friction": 0.7 * needed}
    held = run(keys, friction, rate=100.0, pulses=63, **drive)
    late = held.t > 3.4
    assert held.t[-1] - held.t[late][0] > 60.0
    assert np.all(held.contact[late] == STICK_ON_A_CORNER)
    assert 0.5 < abs(held.theta[-1]) < 1.2
    used = np.abs(held.friction_force) / (friction["contact.static_friction"] * held.normal_force)
    # The field's gradient differs by 1e-4 for each micrometre that the block slid as it tipped.
    assert used[late] == pytest.approx(0.9, abs=0.01)
    assert np.all(held.contact_x[late] == held.contact_x[-1])
    assert np.all(held.slip_velocity[late] == 0.0)
    # The centre of mass still rocks about the corner by what the integrator's tolerance allows.
    assert np.ptp(held.x[held.t > 30.0]) < 1e-5 * RADIUS


@pytest.mark.parametrize("clamp", [2.5e-3, -2.5e-3, 0.0, 6.5e-3])
@pytest.mark.parametrize("in_plane", [2.5e-3, 0.0, -1e-3])
def test_a_dc_field_moves_nothing(in_plane, clamp):
    final = volts(in_plane, clamp)
    keys = program(Waveform.ramp(0.5, final) + Waveform.hold(4.0, final))
    damped = {"effects.rotational_drag.coefficient": 1e-12}
    held = run(keys, damped, rate=200.0)
    late = held.t > 1.5
    assert np.all(held.contact_x[late] == held.contact_x[-1])
    assert np.all(held.slip_velocity[late] == 0.0)
    # What is left of the rocking is of the integrator's tolerance, 1e-7 of a radius a step.
    assert np.ptp(held.x[held.t > 4.0]) < 1e-5 * RADIUS
    if clamp != 0.0 and in_plane > 0.0:
        # Eq. (8): the moment turns towards the field, less what the weight takes.
        assert np.sign(held.theta[-1]) == -np.sign(clamp)


@pytest.mark.parametrize("mode", ["IPP", "OPP"])
def test_sawtooth_without_teeth_moves_nothing(mode):
    damped = {"effects.rotational_drag.coefficient": 1e-12}
    drive = {"mode": mode, "base": 1e-3, "peak": 1e-3, "ramp": 0.5, "frequency": 50.0}
    still = run(damped, pulses=100, **drive).summary()
    assert still["theta_max"] > 0.5
    assert (still["slip_up"], still["slip_down"], still["slip_flat"]) == (0.0, 0.0, 0.0)
    # The centre of mass ends where the rocking has left it, a part of a radius.
    assert abs(still["mean_velocity"]) * 1.94 < 1e-5 * RADIUS


@pytest.mark.parametrize("mass", [MASS, 24.05e-9])
@pytest.mark.parametrize("downhill", [1, -1])
def test_block_holds_just_below_the_slip_angle_and_slides_just_above(mass, downhill):
    limit = slip_angle(0.2, ADHESION, mass)
    drive = {"frequency": 1.0, "pulses": 5}
    robot = {"robot.mass": mass}
    below = run(NO_FIELD, robot, tilted(downhill * limit * (1 - 1e-9)), rate=10.0, **drive)
    assert np.all(below.x == 0.0)
    assert below.mean_velocity == 0.0
    above = run(NO_FIELD, robot, tilted(downhill * limit * (1 + 1e-9)), frequency=100.0, pulses=5)
    # Once it slips, friction drops to the kinetic value: the velocity jumps to a finite slope.
    assert downhill * above.mean_velocity > 1e-3


@pytest.mark.parametrize("downhill", [1, -1])
def test_block_on_a_steep_tilt_approaches_its_terminal_velocity(downhill):
    angle, drag, kinetic = 0.6, 1e-5, 0.145
    push = WEIGHT * np.sin(angle) - kinetic * (WEIGHT * np.cos(angle) + ADHESION)
    terminal = push / drag  # 2.6 mm/s
    # Born slipping: the block is tilted from the start.
    slide = run(still_for(0.05), tilted(downhill * angle), rate=2e3)
    after = slide.t > 0.0
    velocity, place = slid(slide.t[after], push, drag)
    # Each of some tens of steps may err by 1e-7 of the scales 0.1 mm and 0.1 m/s.
    assert downhill * slide.vx[after] == pytest.approx(velocity, abs=1e-6 * terminal + 1e-7)
    assert downhill * slide.x[after] == pytest.approx(place, abs=1e-9)
    assert np.all(slide.theta == 0.0)
    assert slide.vx[-1] == pytest.approx(downhill * terminal, rel=1e-6)


def test_block_on_a_frictionless_tilt_falls_freely_along_it():
    angle, seconds = 0.01, 0.1
    smooth = {"contact.static_friction": 0.0, "contact.kinetic_friction": 0.0, "drag.linear": 0.0}
    slide = run(still_for(seconds), tilted(angle), smooth, rate=1e3)
    place = 0.5 * GRAVITY * np.sin(angle) * slide.t**2
    assert slide.x == pytest.approx(place, rel=1e-9, abs=1e-15)


@pytest.mark.parametrize(("force", "sign"), [("up the hill", -1), ("down the hill", 1)])
def test_slip_starts_at_the_friction_cone_of_a_slowly_rising_force(force, sign):
    # The +x coil's gradient pulls the block towards it; a tilt helps or hinders.
    angle = sign * 0.05
    final = volts(in_plane=6.5e-3)
    keys = [program(Waveform.ramp(2.0, final)), tilted(angle), {"contact.adhesion": 0.0}]
    pulled = run(*keys, rate="events")
    first = np.flatnonzero(pulled.event == pulled.event_names.index("slip_start"))[0]
    gradient = Coils().gradient([[0.0, 0.0, HEIGHT / 2]], pulled.current[first])[0]
    along = MOMENT * gradient[0, 0] + WEIGHT * np.sin(angle)
    pressed = WEIGHT * np.cos(angle) - MOMENT * gradient[2, 0]
    assert along == pytest.approx(0.2 * pressed, rel=1e-7)


@pytest.mark.parametrize("adhesion", [0.0, ADHESION, 1e-6])
@pytest.mark.parametrize("clamp", [1, -1])
def test_block_tips_where_torques_balance_about_the_corner(clamp, adhesion):
    # About the corner that stays: torque of the moment, weight and adhesion at half a length, and
    # the pull of the gradient at half a height. The adhesion of the corner that leaves counts.
    keys = [
        program(Waveform.ramp(2.0, volts(clamp=clamp * 6.5e-3))),
        {"contact.adhesion": adhesion},
    ]
    tipped = run(*keys, {"contact.static_friction": 5.0}, rate="events")
    first = np.flatnonzero(tipped.event == tipped.event_names.index("tip"))[0]
    gradient = Coils().gradient([[tipped.x[first], 0.0, HEIGHT / 2]], tipped.current[first])[0]
    torque = -MOMENT * tipped.bz[first]
    pull, lift = MOMENT * gradient[0, 0], MOMENT * gradient[2, 0]
    lever = -clamp * LENGTH / 2  # nose-down about the front corner, nose-up about the rear one
    # The shared half of the adhesion that holds the leaving corner acts at a whole length.
    assert torque + pull * HEIGHT / 2 == pytest.approx(lever * (WEIGHT + adhesion - lift), rel=1e-7)
    assert is_mode(tipped, ON_A_CORNER)[first]


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
