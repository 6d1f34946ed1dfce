"""Motions in the whole plane in closed form, their symmetry, and how a run comes into it."""

import math

import numpy as np
import pytest

from stickslip import Coil, Drive, Scenario, ScenarioError, Simulator, State, Waveform, simulate

WALK = Scenario(drive=Drive(base=0.5e-3, pulses=8))
# Takes a run into the whole plane, and moves nothing by itself.
ASIDE = {"initial.y": 1e-12}


def alone(duration, **changes):
    """A robot on its face without field or drag, that is left alone for a time (s)."""
    still = Scenario(drive=Drive(mode="program", program=Waveform.hold(duration, {})))
    nothing = {"robot.magnetization": 0.0, "drag.linear": 0.0, "drag.rotational": 0.0}
    return still.replace({**nothing, **ASIDE, **changes})


def braking(scenario):
    """Of a face that slides, m/s^2."""
    pressed = scenario.environment.gravity + scenario.contact.adhesion / scenario.robot.mass
    return scenario.contact.kinetic_friction * pressed


def test_friction_patches_lie_along_x_whichever_way_the_robot_faces():
    # The corner that lands, too, is where the heading has it.
    patches = {"effects.friction_patches.amplitude": 0.5, "effects.friction_patches.period": 4e-4}
    across = WALK.replace({"drive.heading": 0.5 * math.pi})
    smooth, rough = (simulate(each).velocity for each in (across, across.replace(patches)))
    assert rough == pytest.approx(smooth, rel=1e-9)
    back = WALK.replace({"drive.direction": "-x", **patches})
    planar, turning = (simulate(each).mean_velocity for each in (back, back.replace(ASIDE)))
    assert turning == pytest.approx(planar, rel=1e-6)
    assert abs(planar + smooth[0]) > 1e-3 * smooth[0]


def test_turning_everything_by_a_quarter_turn_and_a_mirror_change_the_axes_alone():
    heading = math.radians(25.0)
    along, across = simulate(WALK.replace({"drive.heading": heading})).velocity
    assert abs(across) > 0.01 * along
    for turn, sign in ((0.5, 1), (1.0, 1), (1.5, 1), (0.0, -1)):
        turned = math.remainder(sign * heading + turn * math.pi, 2.0 * math.pi)
        found = simulate(WALK.replace({"drive.heading": turned})).velocity
        assert found[0] == pytest.approx(along, rel=1e-6)
        assert found[1] == pytest.approx(sign * across, rel=1e-5)


@pytest.mark.parametrize("way", np.radians([0.0, 50.0, 100.0, -170.0]))
def test_a_face_that_is_left_alone_slides_straight_and_as_far_as_friction_lets_it(way):
    speed, ahead = 0.02, np.array([np.cos(way), np.sin(way)])
    vx, vy = speed * ahead
    scenario = alone(0.05, **{"initial.vx": vx, "initial.vy": vy})
    end = simulate(scenario).final_state
    assert [end.x, end.y] == pytest.approx(speed**2 / (2.0 * braking(scenario)) * ahead, rel=1e-6)
    assert (end.vx, end.contact) == (0.0, "face_stick")


@pytest.mark.parametrize("azimuth", np.radians([20.0, 90.0, -130.0]))
def test_on_a_slope_a_face_holds_within_the_cone_and_slides_straight_down(azimuth):
    ends = []
    for tilt in (math.atan(0.2) - 1e-4, math.atan(0.2) + 1e-4):
        slope = {"effects.surface_tilt.azimuth": azimuth, "effects.surface_tilt.angle": tilt}
        scenario = alone(0.02, **{"contact.adhesion": 0.0}, **slope)
        ends.append(simulate(scenario).final_state)
    held, end = ends
    assert held.x == 0.0
    kinetic, gravity = scenario.contact.kinetic_friction, scenario.environment.gravity
    distance = 0.5 * gravity * (math.sin(tilt) - kinetic * math.cos(tilt)) * 0.02**2
    expected = [distance * math.cos(azimuth), distance * math.sin(azimuth)]
    assert [end.x, end.y] == pytest.approx(expected, rel=1e-5, abs=1e-12)


@pytest.mark.parametrize(("moves", "factor"), [("x", 1.3), ("y", 1.0)])
def test_friction_that_differs_to_front_and_rear_is_as_without_across(moves, factor):
    anisotropic = {"effects.friction_anisotropy.fraction": 0.3, f"initial.v{moves}": 0.02}
    scenario = alone(0.05, **anisotropic)
    distance = 0.02**2 / (2.0 * factor * braking(scenario))
    assert getattr(simulate(scenario).final_state, moves) == pytest.approx(distance, rel=1e-6)


@pytest.mark.parametrize("static", [0.145, 0.2])
def test_a_push_across_changes_the_velocity_no_more_than_it_pushes(static):
    # A single coil beside the axis pushes across, which lets the slip pass zero at a speed that
    # goes with the heading. What that changes goes with it too: 1.1 times the heading for friction
    # that is the same at rest, where nothing is captured, and for the paper's friction as well.
    walk = WALK.replace({"drive.mode": "OPP", "contact.static_friction": static})
    straight = simulate(walk.replace(ASIDE)).mean_velocity
    for heading in (-5e-4, 1e-6, 1e-4, 5e-4):
        along, _ = simulate(walk.replace({"drive.heading": heading})).velocity
        assert abs(along / straight - 1.0) < 2.0 * abs(heading) + 2e-6


@pytest.mark.parametrize("azimuth", [0.0, 1e-9, 1e-6, 1e-3, -1e-3])
def test_a_block_that_slides_up_a_slope_rests_where_its_slip_ends(azimuth):
    # Thrown up a slope of tan 0.17, below the static coefficient of 0.2, it comes to rest after
    # v^2 / 2 a, wherever downhill is. What the capture takes of the way is below 1e-9 of it, the
    # turn downhill of 1e-3 rad some 1e-6.
    slope = math.atan(0.17)
    tilted = {"effects.surface_tilt.angle": slope, "effects.surface_tilt.azimuth": azimuth}
    scenario = alone(0.3, **{"contact.adhesion": 0.0, "initial.vx": -0.05}, **tilted)
    end = simulate(scenario).final_state
    kinetic, gravity = scenario.contact.kinetic_friction, scenario.environment.gravity
    brake = gravity * (math.sin(slope) + kinetic * math.cos(slope))
    assert end.contact == "face_stick"
    assert end.x == pytest.approx(-(0.05**2) / (2.0 * brake), rel=2e-6)


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("heading", [0.0, 0.5, math.pi])
def test_a_start_that_does_not_face_the_drives_direction_is_one_in_the_whole_plane(
    heading, direction
):
    start = {"initial.heading": heading, "drive.direction": direction}
    ahead = heading in (0.0, math.pi if direction == "-x" else 0.0)
    assert Scenario().replace(start).whole_plane is not ahead


def held(volts, duration, **changes):
    drive = Drive(mode="program", program=Waveform.hold(duration, volts), **changes)
    return Scenario(drive=drive)


def test_before_a_program_has_a_field_its_direction_says_the_heading():
    scenario = held({"clamp": -10.0}, 0.1, direction="-x")
    planar, turning = (simulate(e).final_state for e in (scenario, scenario.replace(ASIDE)))
    assert planar.x < -1e-5
    assert planar.heading == math.pi
    for name in ("x", "theta", "heading"):
        assert getattr(turning, name) == pytest.approx(getattr(planar, name), rel=1e-6)


def test_coils_of_y_that_are_unlike_turn_a_stepped_robot_by_voltages_that_cancel():
    cancelling, step = [10.0, 0.0, 25.0, -25.0, -10.0], 2e-3

    def stepped(scenario, **how):
        simulator = Simulator(scenario, **how)
        for _ in range(20):
            state = simulator.step(cancelling, step)
        return state.heading

    unlike = Coil(yp={"distance": 1e-3})
    assert stepped(Scenario()) == 0.0
    with pytest.raises(ScenarioError, match="whole_plane"):
        stepped(Scenario(coil=unlike))
    turned = stepped(Scenario(coil=unlike), whole_plane=True)
    whole = Scenario(drive=held(cancelling, 20 * step).drive, coil=unlike)
    assert turned == pytest.approx(simulate(whole).final_state.heading, rel=1e-6)
    assert turned != 0.0
    # So do currents that are there as the run begins.
    begun = State(current_yp=1.0, current_ym=-1.0)
    assert Scenario(coil=unlike, initial=begun).whole_plane


def test_a_run_takes_no_snapshot_of_the_other_kind_of_run():
    both = [Simulator(Scenario(), whole_plane=whole) for whole in (False, True)]
    for one, other in (both, both[::-1]):
        with pytest.raises(ScenarioError):
            one.restore(other.snapshot())


@pytest.mark.parametrize("heading", [0.0, 0.5 * math.pi, 2.5])
@pytest.mark.parametrize(("along", "way"), [(0.02, "forward"), (-0.02, "backward")])
def test_the_contact_of_a_state_slips_forward_or_backward_along_the_heading(heading, along, way):
    c, s = math.cos(heading), math.sin(heading)
    start = State(y=1e-12, heading=heading, vx=along * c - 0.01 * s, vy=along * s + 0.01 * c)
    scenario = held({}, 1e-4).replace({"robot.magnetization": 0.0})
    for _ in range(2):  # it begins a run that goes on with that slip
        run = simulate(scenario.with_state(start))
        start = run.final_state
        assert start.contact == f"face_slip_{way}"
        assert run.summary()["events"]["reversal"] == 0
