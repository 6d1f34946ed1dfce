"""Pictures of a robot that leaves its plane: views from above, from its side, and over time."""

import itertools
import math

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon

from pictures import assert_legible
from stickslip import Drive, Record, Scenario, ScenarioError, Waveform, plot, simulate
from stickslip.control import Path
from stickslip.plot.motion import motion
from stickslip.plot.scene import Scene

RATE = 10e3
WANTED = Path([(0.0, 0.0), (1.5e-3, 0.0), (1.5e-3, 0.5e-3)])


def turning(to, pulses):
    """A walk whose field turns from +x to an angle, rad, after the ramp."""
    t, volts = Waveform.ipp(base=0.5e-3, pulses=pulses).points()
    angle = np.interp(t, [0.05, t[-1]], [0.0, to])
    x, y = volts[:, 0] * np.cos(angle), volts[:, 0] * np.sin(angle)
    coils = [np.maximum(x, 0), np.minimum(x, 0), np.maximum(y, 0), np.minimum(y, 0), volts[:, 4]]
    program = Waveform.from_points(t, np.column_stack(coils))
    return Scenario(drive=Drive(mode="program", program=program), record=Record(rate=RATE))


def walking(**drive):
    given = {"base": 0.5e-3, "pulses": 8, **drive}
    return Scenario(drive=Drive(**given), record=Record(rate=RATE))


SCENARIOS = {
    "a turn": turning(1.5 * np.pi, 40),
    "half a turn and more": turning(-1.1 * np.pi, 30),
    "30 degrees": walking(heading=np.radians(30.0)),
    "210 degrees": walking(direction="-x", heading=np.radians(30.0)),
    "along -x": walking(direction="-x"),
    "half a turn in its plane": walking(heading=np.pi),
    "one pulse": walking(heading=0.5, pulses=1),
    "at rest": walking(heading=0.5, pulses=1, peak=0.0, base=0.0, hold=0.0),
}


@pytest.fixture(scope="module")
def runs():
    return {name: simulate(scenario) for name, scenario in SCENARIOS.items()}


@pytest.fixture(scope="module")
def run(runs):
    return runs["a turn"]


def heading_of(run):
    if run.scenario.turns:
        return np.unwrap(run.heading)
    return np.full(run.t.size, run.final_state.heading)


def place_of(run):
    return run.x, run.y


def way_of(run):
    """What has been gone along the heading, by the trapezoidal rule, m."""
    x, y = place_of(run)
    psi = heading_of(run)
    speed = np.gradient(x, run.t) * np.cos(psi) + np.gradient(y, run.t) * np.sin(psi)
    return np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) / RATE)])


def arrows(axes):
    """Ends of all arrows, begin and tip, shape (n, 2, 2)."""
    return np.array([each._posA_posB for each in axes.patches if isinstance(each, FancyArrowPatch)])


def turned(arrow, heading):
    """From a heading to an arrow, rad."""
    return math.remainder(math.atan2(arrow[1], arrow[0]) - heading, 2.0 * math.pi)


def factor_of(axes):
    return 1e3 if axes.get_xlabel() == "x (mm)" else 1e6


@pytest.mark.parametrize("name", SCENARIOS)
def test_the_view_from_above_has_the_path_and_arrows_that_point_to_the_heading(runs, name):
    run = runs[name]
    figure = plot.path(run)
    above = figure.axes[0]
    x, y = place_of(run)
    factor = factor_of(above)
    line = above.get_lines()[0]
    np.testing.assert_allclose(line.get_xdata(), x * factor)
    np.testing.assert_allclose(line.get_ydata(), y * factor)
    assert above.get_aspect() == 1.0

    *along, moment = arrows(above)
    heading = heading_of(run)
    for begin, tip in along:
        sample = np.hypot(x * factor - begin[0], y * factor - begin[1]).argmin()
        assert (begin[0], begin[1]) == pytest.approx((x[sample] * factor, y[sample] * factor))
        assert turned(tip - begin, heading[sample]) == pytest.approx(0.0, abs=1e-9)
    assert turned(moment[1] - moment[0], heading[-1]) == pytest.approx(0.0, abs=1e-9)
    if name == "a turn":
        assert len(along) >= 8
    begins = [begin for begin, _ in along]
    sizes = {round(float(np.hypot(*(tip - begin))), 6) for begin, tip in along}
    for one, two in itertools.combinations(begins, 2):
        assert np.hypot(*(one - two)) > 0.7 * max(sizes)
    assert_legible(figure, least=15)


@pytest.mark.parametrize("name", ["a turn", "30 degrees", "along -x", "half a turn in its plane"])
def test_the_outlines_are_the_body_as_seen_from_above(runs, name):
    run = runs[name]
    above = plot.path(run).axes[0]
    outlines = [each.get_xy()[:4] for each in above.patches if isinstance(each, Polygon)]
    assert len(outlines) == 2
    x, y = place_of(run)
    robot = run.scenario.robot
    for outline, sample in zip(outlines, (0, -1), strict=True):
        signs = np.array(list(itertools.product([-0.5, 0.5], repeat=3)))
        a, b, c = (signs * [robot.length, robot.width, robot.height]).T
        theta, psi = run.theta[sample], heading_of(run)[sample]
        s = a * np.cos(theta) + c * np.sin(theta)
        corners = np.column_stack(
            [
                x[sample] + s * np.cos(psi) - b * np.sin(psi),
                y[sample] + s * np.sin(psi) + b * np.cos(psi),
            ]
        )
        # The same extent in every direction.
        for angle in np.linspace(0.0, np.pi, 19):
            way = np.array([np.cos(angle), np.sin(angle)])
            extent = (outline @ way).min(), (outline @ way).max()
            expected = factor_of(above) * np.array([(corners @ way).min(), (corners @ way).max()])
            assert extent == pytest.approx(expected)


@pytest.mark.parametrize("name", ["a turn", "210 degrees", "along -x"])
def test_height_and_tilt_are_shown_over_the_way_along_the_heading(runs, name):
    run = runs[name]
    above, height, tilt = plot.path(run).axes
    factor = factor_of(above)
    way = way_of(run)
    for axes, values in ((height, run.z * 1e6), (tilt, np.degrees(run.theta))):
        line = axes.get_lines()[0]
        np.testing.assert_allclose(line.get_ydata(), values)
        np.testing.assert_allclose(line.get_xdata(), way * factor, atol=2e-6 * factor)
    assert way[-1] > 1e-4
    assert f"({above.get_xlabel()[3:-1]})" in tilt.get_xlabel()


@pytest.mark.parametrize("along", [WANTED, WANTED.points.tolist()])
def test_the_wanted_path_is_drawn_under_the_one_that_was_walked(run, along):
    figure = plot.path(run, along=along)
    above = figure.axes[0]
    (wanted,) = [line for line in above.get_lines() if line.get_label() == "wanted"]
    np.testing.assert_allclose(wanted.get_xydata(), WANTED.points * factor_of(above))
    assert factor_of(above) == 1e3  # it is shown whole, and is above 1000 um
    assert above.get_xlim()[1] > 1.5
    walked = above.get_lines()[0]
    assert walked.get_label() == "centre of mass"
    assert wanted.get_zorder() < walked.get_zorder()
    assert_legible(figure, least=15)


@pytest.mark.parametrize("along", ["L", [1.0, 2.0], [(0.0, 0.0), (math.nan, 0.0)]])
def test_what_is_no_path_to_walk_along_is_refused(run, along):
    with pytest.raises(ScenarioError, match=r"along = .*: allowed is a Path, or its corners"):
        plot.path(run, along=along)


def test_given_axes_have_the_view_from_above_alone(run):
    figure = Figure()
    ax = figure.subplots()
    assert plot.path(run, 0.1, 0.2, ax=ax) is figure
    assert figure.axes == [ax]
    seen = (run.t >= 0.1) & (run.t <= 0.2)
    np.testing.assert_allclose(ax.get_lines()[0].get_xdata(), run.x[seen] * 1e6)


def test_a_run_shows_x_and_y_and_a_heading_without_jumps(runs):
    run = runs["half a turn and more"]
    assert np.abs(np.diff(run.heading)).max() > 6.0  # from -pi to pi
    figure = plot.run(run)
    panels = {axes.get_ylabel().replace("\n", " "): axes for axes in figure.axes}
    position = panels["position (µm)"]
    for line, values in zip(position.get_lines(), (run.x, run.y), strict=True):
        np.testing.assert_allclose(line.get_ydata(), values * 1e6)
    (heading,) = panels["heading (degrees)"].get_lines()
    np.testing.assert_allclose(heading.get_ydata(), np.degrees(np.unwrap(run.heading)))
    slips = panels["contact velocity (mm/s)"].get_lines()
    for line, values in zip(slips, (run.slip_velocity, run.slip_across), strict=True):
        np.testing.assert_allclose(line.get_ydata(), values * 1e3)


@pytest.mark.parametrize("name", ["a turn", "30 degrees", "at rest"])
def test_pictures_over_time_can_be_read(runs, name):
    assert_legible(plot.run(runs[name]), least=35)
    assert_legible(plot.filmstrip(runs[name], [0.01, 0.05]), least=10)
    assert_legible(plot.trajectory(runs[name]), least=8)


def test_a_filmstrip_shows_the_plane_in_which_the_robot_rocks(run):
    (axes,) = plot.filmstrip(run, [0.3]).axes
    sample = np.abs(run.t - 0.3).argmin()
    psi = run.heading[sample]
    outline = axes.patches[0].get_xy()[:4] * 1e-6
    centre = outline.mean(axis=0)
    assert centre[1] == pytest.approx(run.z[sample])
    assert centre[0] == pytest.approx(way_of(run)[sample], abs=2e-6)
    # The front, of which the lower corner touches, is at the right.
    ahead = (run.contact_x[sample] - run.x[sample]) * np.cos(psi)
    ahead += (run.contact_y[sample] - run.y[sample]) * np.sin(psi)
    touch = outline[outline[:, 1].argmin()]
    assert touch[0] - centre[0] == pytest.approx(ahead)
    assert ahead > 0.0


def test_the_scene_has_both_views_and_the_field_over_time(run):
    scene = Scene(motion(run), 0, run.t.size - 1, "")
    side, field, above = scene.figure.axes
    assert above.get_xlabel() in ("x (µm)", "x (mm)")
    for line, values in zip(field.get_lines(), (run.bx, run.by, run.bz), strict=False):
        np.testing.assert_allclose(line.get_ydata(), values * 1e3)
    mark = field.get_lines()[3]
    factor = factor_of(above)
    seen = 0
    for sample in (0, run.t.size // 2, run.t.size - 1):
        scene.show(sample)
        assert_legible(scene.figure, least=20)
        assert mark.get_xdata()[0] == pytest.approx((run.t[sample] - run.t[0]) * 1e3)
        path = above.get_lines()[0]
        np.testing.assert_allclose(path.get_xdata(), run.x[: sample + 1] * factor)
        np.testing.assert_allclose(path.get_ydata(), run.y[: sample + 1] * factor)
        body = next(each for each in above.patches if isinstance(each, Polygon)).get_xy()
        for column, (low, high) in zip(body.T, (above.get_xlim(), above.get_ylim()), strict=True):
            assert low < column.min() < column.max() < high
        passed = [each for each in above.patches if isinstance(each, FancyArrowPatch)]
        assert sum(each.get_visible() for each in passed) > seen
        seen = sum(each.get_visible() for each in passed)
        outline = side.patches[1].get_xy()[:4]
        assert outline[:, 1].mean() == pytest.approx(run.z[sample] * 1e6)


def test_a_saved_run_is_drawn_as_the_run(run):
    data = run.to_xarray()
    for draw in (plot.path, plot.trajectory):
        one, two = (draw(each)._repr_png_() for each in (run, data))
        assert one == two
    one, two = (plot.animation(each, 0.1, 0.12).frame(0)._repr_png_() for each in (run, data))
    assert one == two


def test_a_record_without_what_is_across_is_refused(run):
    data = run.to_xarray()
    across = ["y", "vy", "heading", "friction_across", "contact_y", "slip_across"]
    for left_out in (["y"], across):
        with pytest.raises(ValueError, match=r"has no .*y"):
            plot.path(data.drop_vars(left_out))
    fields = "x, z, theta, omega, normal_force, slip_velocity, bx, by, bz, contact"
    partly = simulate(run.scenario.replace({"record.fields": fields}))
    with pytest.raises(AttributeError, match="did not record y"):
        plot.path(partly)


def test_a_long_way_is_in_millimetres_from_above():
    run = simulate(walking(heading=0.7, pulses=120).replace({"record.rate": 1e3}))
    figure = plot.animation(run, 0.0, 1.2).frame(-1)
    assert figure.axes[2].get_xlabel() == "x (mm)"
    assert_legible(figure, least=20)
