"""Pictures: what is drawn has the numbers of the run or sweep."""

import base64
import io
import itertools
import math
import re

import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon
from PIL import Image

from measured_maps import formula_map
from pictures import RATE, RUNS, heading_of, recorded, way_of
from stickslip import (
    COIL_NAMES,
    Coil,
    Coils,
    Drive,
    Scenario,
    State,
    Waveform,
    plot,
    simulate,
    sweep,
)
from stickslip.plot import style

WANTED = np.array([(0.0, 0.0), (1.5e-3, 0.0), (1.5e-3, 0.5e-3)])
BASE = Scenario(drive=Drive(base=0.5e-3, pulses=5))
FREQUENCIES = [20.0, 50.0, 100.0]
FIVE = [2.0, -1.0, 0.5, 0.0, -3.0]
EACH = {
    "run": plot.run,
    "fields": plot.fields,
    "angle_and_contact_velocity": plot.angle_and_contact_velocity,
    "trajectory": plot.trajectory,
    "phase_portrait": plot.phase_portrait,
    "path": plot.path,
    "filmstrip": lambda run: plot.filmstrip(run, np.linspace(0.01, run.t[-1], 6).tolist()),
    "animation": lambda run: plot.animation(run).frame(-1),
}


@pytest.fixture(scope="module")
def by_mode():
    return sweep(BASE, {"drive.frequency": FREQUENCIES, "drive.mode": ["IPP", "OPP"]})


@pytest.fixture(scope="module")
def by_two():
    friction = {"contact.static_friction": [0.15, 0.2, 0.3]}
    return sweep(BASE, {"drive.frequency": FREQUENCIES, **friction})


def panels(figure):
    """The axes by the words of their vertical label, without its unit."""
    return {axes.get_ylabel().replace("\n", " ").partition(" (")[0]: axes for axes in figure.axes}


def factor_of(axes):
    return 1e3 if axes.get_xlabel().endswith("(mm)") else 1e6


def arrows(axes):
    """Ends of all arrows, begin and tip, shape (n, 2, 2)."""
    return np.array([each._posA_posB for each in axes.patches if isinstance(each, FancyArrowPatch)])


def outlines(axes):
    return [each.get_xy()[:4] for each in axes.patches if isinstance(each, Polygon)]


@pytest.mark.parametrize("draw", EACH.values(), ids=EACH)
@pytest.mark.parametrize("name", RUNS)
def test_every_run_is_drawn_and_rounding_is_not_its_scale(name, draw):
    for axes in draw(recorded(name)).axes:
        for axis in (axes.xaxis, axes.yaxis):
            assert np.ptp(axis.get_view_interval()) >= 1e-3


@pytest.mark.parametrize("name", ["a turn to the right", "210 degrees", "along -x"])
def test_panels_of_a_run_have_its_numbers(name):
    run = recorded(name)
    shown = panels(plot.run(run))
    slip = [run.slip_velocity * 1e3]
    expected = {
        "pitch $\\theta$": [np.degrees(run.theta)],
        "normal force": [run.normal_force * 1e6],
        "field": [run.bx * 1e3, run.bz * 1e3],
    }
    if run.scenario.whole_plane:
        expected["position"] = [run.x * 1e6, run.y * 1e6]
        expected["heading"] = [np.degrees(heading_of(run))]
        expected["field"].insert(1, run.by * 1e3)
        slip.append(run.slip_across * 1e3)
    else:
        expected["x"] = [run.x * 1e6]
    expected["contact velocity"] = slip
    assert shown.keys() == {*expected, "contact"}
    for label, values in expected.items():
        for line, each in zip(shown[label].get_lines(), values, strict=False):
            np.testing.assert_allclose(line.get_xdata(), run.t)
            np.testing.assert_allclose(line.get_ydata(), each)
    for draw, label, values in (
        (plot.fields, "field", expected["field"]),
        (plot.angle_and_contact_velocity, "contact velocity", slip),
    ):
        one = panels(draw(run, 0.05, 0.08))[label]
        seen = (run.t >= 0.05) & (run.t <= 0.08)
        for line, each in zip(one.get_lines(), values, strict=True):
            np.testing.assert_allclose(line.get_ydata(), each[seen])


def test_a_heading_that_passes_half_a_turn_has_no_jump():
    run = recorded("a turn to the right")
    assert np.abs(np.diff(run.heading)).max() > 6.0  # from -pi to pi
    (line,) = panels(plot.run(run))["heading"].get_lines()
    assert np.abs(np.diff(line.get_ydata())).max() < 30.0


def test_the_contact_band_has_the_time_of_each_mode():
    run = recorded("a turn")
    band = panels(plot.run(run))["contact"]
    share = {code: np.mean(run.contact[:-1] == code) for code in np.unique(run.contact)}
    assert len(share) >= 4
    for bars, expected in zip(band.collections, share.values(), strict=True):
        widths = [path.get_extents().width for path in bars.get_paths()]
        assert sum(widths) == pytest.approx(expected * run.t[-1], abs=1e-9)


def test_a_long_run_is_shown_with_its_last_pulses_and_a_short_one_with_its_window():
    run = recorded("forty pulses")
    t = panels(plot.run(run))["x"].get_lines()[0].get_xdata()
    start, end = run.scenario.window
    assert (t[0], t[-1]) == pytest.approx((end - 0.06, end), abs=1.5 / RATE)  # six of 10 ms
    assert not plot.run(run, start + 0.01, end - 0.01).axes[0].patches
    assert "last 6 of 40 pulses" in plot.run(run)._suptitle.get_text()
    stopped = simulate(run.scenario, until=f"time >= {0.5 * end}")
    assert "last 6 pulses before its end" in plot.run(stopped)._suptitle.get_text()

    run = recorded("walk")
    for axes in plot.run(run).axes[:5]:
        box = axes.patches[0].get_extents().transformed(axes.transData.inverted())
        assert (box.x0, box.x1) == pytest.approx(run.scenario.window)


def test_a_failed_run_is_drawn_and_says_so():
    keys = ("contact.static_friction", "contact.kinetic_friction", "drag.linear")
    changes = {"effects.surface_tilt.angle": 1.4, "record.rate": 1000.0, **dict.fromkeys(keys, 0.0)}
    run = simulate(Scenario().replace(changes))
    assert run.status in plot.run(run)._suptitle.get_text()


@pytest.mark.parametrize("name", ["a turn", "along -x"])
@pytest.mark.parametrize("draw", [plot.trajectory, plot.phase_portrait])
def test_paths_have_every_step_in_the_colour_of_its_contact(name, draw):
    run = recorded(name)
    (axes,) = draw(run).axes
    modes = run.contact[:-1]
    present = np.unique(modes)
    assert len(present) >= 4
    if draw is plot.trajectory:
        x, y = way_of(run) * factor_of(axes), run.z * 1e6
        tolerance = 3e-6 * factor_of(axes)  # of the trapezoidal rule
    else:
        x, y, tolerance = np.degrees(run.theta), run.omega, 1e-9
    for lines, code in zip(axes.collections, present, strict=True):
        assert (
            to_hex(lines.get_color()[0]) == style.CONTACT_COLOURS[run.contact_names[code]].lower()
        )
        steps = np.array(lines.get_segments())
        first = np.flatnonzero(modes == code)
        for end in (0, 1):
            np.testing.assert_allclose(steps[:, end, 0], x[first + end], atol=tolerance)
            np.testing.assert_allclose(steps[:, end, 1], y[first + end])


@pytest.mark.parametrize("name", ["a turn", "210 degrees", "along -x", "a tumble"])
def test_the_view_from_above_has_the_path_and_arrows_that_point_to_the_heading(name):
    run = recorded(name)
    above, height, pitch = plot.path(run).axes
    factor, heading = factor_of(above), heading_of(run)
    places = np.column_stack([run.x, run.y]) * factor
    np.testing.assert_allclose(above.get_lines()[0].get_xydata(), places)
    moment, *along = arrows(above)
    samples = [np.hypot(*(places - begin).T).argmin() for begin, _ in along]
    for sample, arrow in [*zip(samples, along, strict=True), (-1, moment)]:
        turned = math.atan2(*(arrow[1] - arrow[0])[::-1]) - heading[sample]
        assert math.remainder(turned, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    assert along
    for axes, values in ((height, run.z * 1e6), (pitch, np.degrees(run.theta))):
        (line,) = axes.get_lines()
        np.testing.assert_allclose(line.get_ydata(), values)
        np.testing.assert_allclose(line.get_xdata(), way_of(run) * factor, atol=3e-6 * factor)


@pytest.mark.parametrize("name", ["a turn", "210 degrees", "along -x"])
def test_the_outlines_are_the_body_as_seen_from_above(name):
    run = recorded(name)
    above = plot.path(run).axes[0]
    robot = run.scenario.robot
    for outline, k in zip(outlines(above), (0, -1), strict=True):
        signs = np.array(list(itertools.product([-0.5, 0.5], repeat=3)))
        a, b, c = (signs * [robot.length, robot.width, robot.height]).T
        psi, s = heading_of(run)[k], a * np.cos(run.theta[k]) + c * np.sin(run.theta[k])
        corners = np.array([run.x[k], run.y[k]]) + np.column_stack(
            [s * np.cos(psi) - b * np.sin(psi), s * np.sin(psi) + b * np.cos(psi)]
        )
        for angle in np.linspace(0.0, np.pi, 19):  # the same extent in every direction
            way = np.array([np.cos(angle), np.sin(angle)])
            expected = factor_of(above) * (corners @ way)
            extent = (outline @ way).min(), (outline @ way).max()
            assert extent == pytest.approx((expected.min(), expected.max()))


@pytest.mark.parametrize("along", [WANTED, WANTED.tolist()])
def test_the_wanted_path_is_drawn_beside_the_one_that_was_walked(along):
    above = plot.path(recorded("a turn"), along=along).axes[0]
    (wanted,) = [line for line in above.get_lines() if line.get_label() == "wanted"]
    np.testing.assert_allclose(wanted.get_xydata(), WANTED * factor_of(above))


@pytest.mark.parametrize("name", ["a turn", "along -x", "opp"])
def test_a_filmstrip_shows_outline_contact_and_the_contact_before(name):
    run = recorded(name)
    samples = np.linspace(600, run.t.size - 1, 4).astype(int)
    figure = plot.filmstrip(run, run.t[samples].tolist())
    psi, way = heading_of(run), way_of(run)
    touched = []
    for axes, k in zip(figure.axes, samples, strict=True):
        (outline,) = outlines(axes)
        assert outline[:, 1].mean() == pytest.approx(run.z[k] * 1e6)
        assert outline[:, 0].mean() == pytest.approx(way[k] * 1e6, abs=3.0)
        assert outline[0, 0] > outline[1, 0]  # the front is at the right
        mark = next(each for each in axes.get_lines() if each.get_marker() == "^")
        touched.append(float(mark.get_xdata()[0]))
        assert touched[-1] == outline[outline[:, 1].argmin(), 0]
        if np.isfinite(run.contact_x[k]):
            y = run.contact_y[k] if run.scenario.whole_plane else 0.0
            ahead = (run.contact_x[k] - run.x[k]) * np.cos(psi[k]) + (y - run.y[k]) * np.sin(psi[k])
            assert touched[-1] - outline[:, 0].mean() == pytest.approx(ahead * 1e6)
        dashed = [each for each in axes.get_lines() if each.get_linestyle() == "--"]
        assert [float(each.get_xdata()[0]) for each in dashed] == touched[-2:-1]


def test_given_axes_are_drawn_in(by_mode):
    run = recorded("a turn")
    figure = Figure(layout="constrained", figsize=(9, 9))
    upper, lower = figure.subfigures(2, 1)
    draws = [EACH[name] for name in EACH if name not in ("run", "filmstrip", "animation")]
    draws += [lambda _, ax: plot.velocity(by_mode, ax), lambda _, ax: plot.coils(BASE, ax=ax)]
    for draw, ax in zip(draws, upper.subplots(2, 4).ravel(), strict=False):
        assert draw(run, ax=ax) is figure
        assert ax.has_data() or ax.collections
    strip = lower.subplots(1, 2)
    assert plot.filmstrip(run, [0.1, 0.11], labels=["a", "b"], ax=strip) is figure
    assert [ax.get_title(loc="left") for ax in strip] == ["a", "b"]


def test_a_sweep_has_a_line_a_mode_and_gaps(by_mode):
    broken = by_mode.copy(deep=True)
    broken.mean_velocity[1, 0] = np.nan
    for data in (by_mode, broken):
        (axes,) = plot.velocity(data).axes
        for line, mode in zip(axes.get_lines(), ["IPP", "OPP"], strict=True):
            np.testing.assert_allclose(line.get_xdata(), FREQUENCIES)
            row = data.mean_velocity[:, list(data.coords[data.mean_velocity.dims[1]]).index(mode)]
            np.testing.assert_allclose(line.get_ydata(), row * 1e3)
            assert line.get_label() == mode


def test_a_heat_map_over_two_keys(by_two):
    axes, _ = plot.velocity(by_two).axes
    (mesh,) = axes.collections
    np.testing.assert_allclose(mesh.get_array(), by_two.mean_velocity.values.T * 1e3)
    edges = mesh.get_coordinates()
    np.testing.assert_allclose(edges[0, :, 0], [5.0, 35.0, 75.0, 125.0])
    np.testing.assert_allclose(edges[:, 0, 1], [0.125, 0.175, 0.25, 0.35])


def test_a_list_of_points_is_drawn_in_order():
    points = [
        {"drive.frequency": f, "drive.mode": m} for f in (100.0, 20.0, 50.0) for m in ("IPP", "OPP")
    ]
    (axes,) = plot.velocity(sweep(BASE, points)).axes
    for line in axes.get_lines():
        assert line.get_xdata().tolist() == FREQUENCIES
    (axes,) = plot.velocity(sweep(BASE, [{"contact.adhesion": a} for a in (0.3e-6, 0.1e-6)])).axes
    np.testing.assert_allclose(axes.get_lines()[0].get_xdata(), [0.1, 0.3])


def test_the_legend_of_a_map_says_which_cells_have_no_velocity_and_why():
    # On steep slopes the robot slides away, unless drag holds it; kinetic friction of 0.145 is
    # above the least static one.
    steep = {"effects.surface_tilt.angle": [0.0, 0.8, 1.4], "drag.linear": [0.0, 1e-7, 1e-5]}
    refused = {"effects.surface_tilt.angle": [0.0, 0.01], "contact.static_friction": [0.1, 0.2]}
    for keys, words in ((steep, "4 left workspace"), (refused, "2 refused")):
        axes = plot.velocity(sweep(BASE.replace({"drive.pulses": 100}), keys)).axes[0]
        (said,) = axes.get_legend().get_texts()
        assert said.get_text() == f"no velocity: {words}"


def test_of_headings_the_velocity_along_them_is_drawn():
    data = sweep(BASE, {"drive.heading": [0.0, 0.5, 1.5]})
    (axes,) = plot.velocity(data).axes
    np.testing.assert_allclose(axes.get_lines()[0].get_ydata(), data.velocity_along.values * 1e3)


def test_a_map_of_the_field_is_that_of_the_coils():
    axes = plot.coils(Scenario(), FIVE).axes[0]
    mesh = axes.collections[0]
    corners = mesh.get_coordinates()
    # The corners are half way between the places where the field is computed.
    x, z = (0.5 * (corners[:-1, :-1, k] + corners[1:, 1:, k]) * 1e-3 for k in (0, 1))
    expected = Coils().field(np.stack([x, np.zeros_like(x), z], axis=-1), FIVE)
    drawn = np.asarray(mesh.get_array())
    np.testing.assert_allclose(drawn, np.linalg.norm(expected, axis=-1) * 1e3, rtol=1e-9)


@pytest.mark.parametrize("name", ["xp", "xm", "clamp"])
@pytest.mark.parametrize("current", [1.0, -1.0])
def test_dots_and_crosses_are_the_directions_of_the_currents(name, current):
    currents = np.where(np.array(COIL_NAMES) == name, current, 0.0)
    drawn = {"x": [], ".": []}
    for line in plot.coils(Scenario(), currents).axes[0].get_lines():
        if line.get_marker() in drawn:
            drawn[line.get_marker()].append(line.get_xydata()[0] * 1e-3)
    assert [len(drawn[each]) for each in "x."] == [1, 1]
    # Ampere: around a current away from the reader, who sees x to the right and z upwards, the
    # field goes with the clock: to the right above it.
    for marker, sign in (("x", 1.0), (".", -1.0)):
        x, z = drawn[marker][0]
        above = Coils().field([x, 0.0, z + 1e-3], currents)
        assert sign * above[0] > 5.0 * abs(above[2])


def test_coils_of_ones_own_are_drawn_where_they_are_with_the_highest_currents():
    own = Coil(xp={"resistance": 20.0, "side": 0.1, "distance": 0.12})
    program = Waveform.ramp(0.1, {"xp": 8.0}) + Waveform.ramp(0.1, {"ym": -3.0}, {"xp": 4.0})
    scenario = Scenario(drive=Drive(mode="program", program=program), coil=own)
    axes = plot.coils(scenario).axes[0]
    places = {tuple(np.round(line.get_xydata()[0], 6)) for line in axes.get_lines()}
    assert {(120.0, 50.0), (120.0, -50.0), (-99.0, 69.25), (-99.0, -69.25)} <= places


@pytest.mark.parametrize(
    ("drive", "initial", "heading"),
    [
        ({}, {}, 0.0),
        ({"direction": "-x"}, {"theta": 0.3}, np.pi),
        ({"direction": "-x", "heading": 0.7}, {"x": 0.02}, np.pi + 0.7),
        ({}, {"heading": 1.0}, 1.0),
    ],
)
def test_the_robot_is_a_mark_with_its_moment_and_the_field(drive, initial, heading):
    # At the top of the sawtooth the peak and the holding field.
    given = Drive(peak=2.5e-3, base=0.5e-3, hold=1e-3, **drive)
    scenario = Scenario(drive=given, initial=State(**initial))
    axes = plot.coils(scenario).axes[0]
    moment = arrows(axes)[-1]  # above those of the field lines
    theta = scenario.initial.theta
    expected = np.array([np.cos(theta) * np.cos(heading), -np.sin(theta)])
    length = 0.14 * np.ptp(axes.get_xlim())
    np.testing.assert_allclose(moment[1] - moment[0], length * expected, atol=1e-9)
    assert moment[0][0] == scenario.initial.x * 1e3


def test_a_robot_outside_of_a_map_is_drawn_without_a_field():
    coil = Coil(map=formula_map(count=(3, 3, 3)))
    for x, known in ((0.007, True), (0.009, False)):
        axes = plot.coils(Scenario(coil=coil, initial=State(x=x)), FIVE).axes[0]
        assert any("B = " in text.get_text() for text in axes.texts) is known


def instants(run, animation, first, last):
    """Samples of the frames of an animation from one time to another."""
    times = np.linspace(first, last, animation.frames, endpoint=False)
    return [int(np.abs(run.t - time).argmin()) for time in times]


def outline(axes):
    return next(each for each in axes.patches if type(each) is Polygon).get_xy()[:4]


@pytest.mark.parametrize("suffix", ["gif", "webp"])
def test_a_file_has_the_frames_it_says_and_repeats(tmp_path, suffix):
    path = tmp_path / f"motion.{suffix}"
    made = plot.animation(recorded("opp"), 0.1, 0.14, slowdown=10.0, frames_per_second=20.0)
    assert made.frames == 8
    told = []
    made.save(path, progress=lambda part, stage: told.append(part))
    assert told == [(k + 1) / 8 for k in range(8)]
    with Image.open(path) as picture:
        assert (picture.n_frames, picture.info["loop"]) == (made.frames, 0)
        frames = []
        for k in range(made.frames):
            picture.seek(k)
            picture.load()
            assert picture.info["duration"] == 50
            frames.append(np.asarray(picture.convert("L"), dtype=float))
    assert all(np.any(a != b) for a, b in itertools.pairwise(frames))
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_an_interrupt_of_the_first_frame_leaves_nothing(tmp_path):
    def interrupt(part, stage):
        raise KeyboardInterrupt

    made = plot.animation(recorded("opp"), 0.1, 0.11, slowdown=40.0)
    with pytest.raises(KeyboardInterrupt):
        made.save(tmp_path / "a.gif", interrupt)
    assert list(tmp_path.iterdir()) == []


def test_a_page_has_all_frames_in_itself(tmp_path):
    plot.animation(recorded("opp"), 0.1, 0.11, slowdown=40.0).save(tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64") == 8
    assert [each.name for each in tmp_path.iterdir()] == ["a.html"]


@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="ffmpeg is not installed")
def test_an_mp4_is_written(tmp_path):
    plot.animation(recorded("opp"), 0.1, 0.11, slowdown=40.0).save(tmp_path / "a.mp4")
    assert (tmp_path / "a.mp4").read_bytes()[4:8] == b"ftyp"


def test_an_mp4_without_ffmpeg_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RuntimeError, match="ffmpeg"):
        plot.animation(recorded("opp"), 0.1, 0.11).save(tmp_path / "a.mp4")
    assert list(tmp_path.iterdir()) == []


def test_a_notebook_shows_an_animation_without_a_network():
    shown = plot.animation(recorded("opp"), 0.1, 0.11, slowdown=40.0)._repr_html_()
    content = re.fullmatch(r'<img alt="[\w ]+" src="data:image/webp;base64,(.+)">', shown).group(1)
    with Image.open(io.BytesIO(base64.b64decode(content))) as picture:
        assert picture.n_frames == 8


@pytest.mark.parametrize(
    "name", [pytest.param("a turn", marks=pytest.mark.nightly), "along -x", "opp"]
)
def test_every_frame_has_body_contact_and_field_of_its_instant(name):
    run = recorded(name)
    first, last = float(run.t[-1]) - 1 / 30, float(run.t[-1])
    made = plot.animation(run, first, last, slowdown=30.0, frames_per_second=11.0)
    seen = set()
    for frame, sample in enumerate(instants(run, made, first, last)):
        side, field, *above = made.frame(frame).axes
        body = outline(side)
        assert body[:, 1].mean() == pytest.approx(run.z[sample] * 1e6)
        assert body[:, 0].mean() == pytest.approx(way_of(run)[sample] * 1e6, abs=3.0)
        contact = next(each for each in side.get_lines() if each.get_label() == "contact")
        mode = run.contact_names[run.contact[sample]]
        kind = next(each for each in style.KIND_COLOURS if each in mode)
        assert contact.get_color() == style.KIND_COLOURS[kind]
        np.testing.assert_allclose(contact.get_xydata()[0], body[body[:, 1].argmin()])
        seen.add(kind)
        begin = instants(run, made, first, last)[0]
        assert field.get_lines()[-1].get_xdata()[0] == pytest.approx(
            (run.t[sample] - run.t[begin]) * 1e3
        )
        assert len(above) == run.scenario.whole_plane
    np.testing.assert_allclose(field.get_lines()[0].get_ydata(), run.bx[begin:] * 1e3)
    assert len(seen) >= 2


def test_the_view_from_above_has_the_path_so_far_and_the_arrows_passed():
    run = recorded("a turn")
    made = plot.animation(run)
    passed = 0
    for frame in (0, made.frames // 2, -1):
        sample = instants(run, made, run.t[0], run.t[-1])[frame]
        above = made.frame(frame).axes[2]
        factor = 1e3 if above.get_xlabel() == "x (mm)" else 1e6
        path = np.column_stack([run.x, run.y])[: sample + 1] * factor
        np.testing.assert_allclose(above.get_lines()[0].get_xydata(), path)
        body = outline(above)
        np.testing.assert_allclose(body.mean(axis=0), path[-1])
        psi = heading_of(run)[sample]
        ahead = body[0] - body[1]
        assert ahead @ [np.cos(psi), np.sin(psi)] == pytest.approx(np.hypot(*ahead))
        arrows = [each for each in above.patches if isinstance(each, FancyArrowPatch)]
        shown = sum(each.get_visible() for each in arrows)
        assert shown > passed
        passed = shown
