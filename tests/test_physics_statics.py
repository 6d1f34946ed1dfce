"""A robot that is held does not move at all, and one that slides obeys Newton's second law."""

import numpy as np
import pytest

from helpers import (
    ADHESION,
    GRAVITY,
    HEIGHT,
    LENGTH,
    MASS,
    MOMENT,
    NO_FIELD,
    ON_A_CORNER,
    RADIUS,
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


def test_slip_angle_of_equation_15():
    # 0.22 uN and 0.2 give 21.2 degrees with the mass of Table II, 21.8 with density times volume.
    assert np.degrees(slip_angle(0.2, ADHESION)) == pytest.approx(21.20, abs=0.01)
    assert np.degrees(slip_angle(0.2, ADHESION, mass=24.05e-9)) == pytest.approx(21.85, abs=0.01)


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
