"""The force view of a film: what is left of torque and force, and how it is said and drawn."""

from dataclasses import replace

import numpy as np
import pytest

from films import NOISE, ROBOT, TRUE, tracking_run
from stickslip.diagnosis.observables.tracking.camera import record
from stickslip.diagnosis.observables.tracking.film import FilmObservable
from stickslip.diagnosis.observables.tracking.force_residuals import CLEAR, force_view
from stickslip.diagnosis.observables.tracking.smoothed_motion import Balance, Kinematics
from stickslip.diagnosis.report.film_figure import traces
from stickslip.diagnosis.report.film_section import view_lines
from stickslip.facts import Code

NAMES, VALUES = list(TRUE), np.array(list(TRUE.values()))


@pytest.mark.parametrize("drive", [{}, {"drive.direction": "-x"}, {"drive.clamp": "up"}])
def test_balances_close_on_a_simulated_motion(drive):
    scenario = ROBOT.replace({"drive.pulses": 5, "effects.surface_tilt.angle": 0.05, **drive})
    motion = next(record(scenario, [], np.zeros((1, 0)), 1e5, 1))
    late = slice(15000, -5)
    t, sign = motion["t"], -1.0 if "drive.direction" in drive else 1.0
    omega, vx = motion["omega"], sign * motion["vx"]
    moving = Kinematics(
        motion["theta"][late], omega[late], np.gradient(omega, t)[late],
        sign * motion["x"][late], vx[late], np.gradient(vx, t)[late],
    )  # fmt: skip
    codes = motion["contact"][late]
    direction = np.where(codes == 2, sign, -sign)
    found = Balance(scenario, motion, t[late], direction)(moving)

    def inside(code):
        """Nine samples that do the same, so that no derivative reaches over an event."""
        return np.convolve((codes == code).astype(float), np.ones(9), "same") > 8.5

    # Derivatives by differences err by the third derivative times h^2 / 6: rocking at 2.6e3 rad/s
    # makes that 1e-4 of the inertial torque, which itself is of the order of the field's.
    stick, slip = inside(1), inside(2) | inside(3)
    assert slip.any()
    assert np.max(np.abs(found.torque[stick])) < 1e-2 * found.torque_scale
    assert np.max(np.abs(found.contact_velocity[stick])) < 1e-12
    assert np.max(np.abs(found.force[slip])) < 1e-4 * found.weight


def view_of(changes, rate=1000.0, seed=0, drive=None):
    observable = FilmObservable(tracking_run(changes, rate, seed, drive=drive))
    return force_view(observable, NAMES, VALUES)


def torque_is_clear(view):
    return any(abs(each.t) > CLEAR for each in view.sticking.slopes)


def test_nothing_is_left_where_the_model_is_true():
    means = []
    for seed in range(6):
        view = view_of({}, seed=seed)
        assert not torque_is_clear(view)
        means += [view.sticking.slopes[0].t, view.slipping.slopes[0].t]
    # Twelve numbers of variance one: the mean square is within 1 +- 3.3 sqrt(2 / 12).
    assert np.mean(np.square(means)) < 1.0 + 3.3 * np.sqrt(2 / 12)


def test_a_turned_moment_shows_while_sticking():
    view = view_of({"effects.misalignment.angle": 0.06})
    constant = view.sticking.slopes[0]
    assert abs(constant.t) > 20.0
    assert torque_is_clear(view)
    assert Code.TORQUE_RESIDUAL in [each.code for each in view_lines(view, None)]


def test_a_tilt_shows_while_slipping_and_is_fixed_to_the_world():
    tilt = {"effects.surface_tilt.angle": 0.06}
    forward, back = (
        view_of(tilt, rate=2000.0, drive={"drive.direction": way}) for way in ("+x", "-x")
    )
    assert not torque_is_clear(forward)
    # Downhill is +x of the world: along the robot's own +x once, against it the other time. The
    # smoothing spreads the slip's force over its neighbourhood, so it comes out too small.
    weight = 25.6e-9 * 9.81 * np.sin(0.06)
    for view, sign in ((forward, 1.0), (back, -1.0)):
        force = view.slipping.slopes[0]
        assert sign * force.t > 3.0
        assert 0.2 * weight < sign * force.value < 1.5 * weight


def test_the_drawn_motion_lies_on_the_readings_if_the_cause_is_right():
    tilt = "effects.surface_tilt.angle"
    observable = FilmObservable(tracking_run({tilt: 0.06}, 1000.0, 0))
    before = force_view(observable, NAMES, VALUES)
    after = force_view(observable, [*NAMES, tilt], np.append(VALUES, 0.06))
    place = traces(before, after)[1]
    # A fit of 2 n + 1 harmonics to so many frames of this noise.
    frames = 1000.0 * 9 / 30.0  # nine periods: three of twelve settle
    noise = 1e6 * NOISE["x"] * np.sqrt((2 * before.orders + 1) / frames)
    error = {
        stage: np.std(place.measured - getattr(place, stage))
        for stage in ("recalibrated", "extended")
    }
    # An rms of 2 n + 1 numbers is within a quarter of its mean; a half for what the cause's own
    # error adds. What the tilt does not do is many times the noise.
    assert error["extended"] < 1.5 * noise
    assert error["recalibrated"] > 3.0 * noise


def test_the_camera_of_another_model_moves_no_drawn_curve():
    observable = FilmObservable(tracking_run({}, 1000.0, 0))
    before = force_view(observable, NAMES, VALUES)
    moved = {"theta": 0.02, "theta_model": 0.02, "place": 3e-6, "place_model": 3e-6}
    after = replace(before, **{key: getattr(before, key) + by for key, by in moved.items()})
    for trace in traces(before, after):
        np.testing.assert_allclose(trace.extended, trace.recalibrated, atol=1e-12)


def test_too_few_phases_are_reported_and_not_drawn():
    view = view_of({}, rate=200.0)
    assert view.distinct == 20
    assert view.sticking is None
    assert view.slipping is None
    few = view_lines(view, None)[0]
    assert (few.code, few.fields["phases"]) == (Code.TOO_FEW_PHASES, 20)
