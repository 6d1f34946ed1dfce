"""Pictures of one motion: what they show, where they draw, and that they can be read."""

import base64
import io
import itertools
import math
import re

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from helpers import corner_offsets
from pictures import assert_legible
from stickslip import Drive, Record, Scenario, plot, simulate
from stickslip.plot import style
from stickslip.plot.motion import motion
from stickslip.plot.scene import Scene

RATE = 10e3


@pytest.fixture(scope="module")
def run():
    drive = Drive(mode="OPP", frequency=30, hold=2.5e-3, edge="rise", clamp="up", pulses=6)
    return simulate(Scenario(drive=drive, record=Record(rate=RATE)))


@pytest.fixture(scope="module", params=["run", "dataset"])
def data(request, run):
    return run if request.param == "run" else run.to_xarray()


def line(axes, place=0):
    drawn = axes.get_lines()[place]
    return np.asarray(drawn.get_xdata()), np.asarray(drawn.get_ydata())


def labels(figure):
    return [label for axes in figure.axes for label in (axes.get_xlabel(), axes.get_ylabel())]


def test_fields_are_those_of_the_run(run, data):
    figure = plot.fields(data)
    t, bx = line(figure.axes[0], 0)
    _, bz = line(figure.axes[0], 1)
    np.testing.assert_array_equal(t, run.t)
    np.testing.assert_allclose(bx, run.bx * 1e3)
    np.testing.assert_allclose(bz, run.bz * 1e3)
    assert labels(figure) == ["time (s)", "field (mT)"]
    assert_legible(figure, least=8)


def test_angle_and_contact_velocity_are_those_of_the_run(run, data):
    figure = plot.angle_and_contact_velocity(data, 0.1, 0.2)
    velocity, tilt = figure.axes
    seen = (run.t >= 0.1) & (run.t <= 0.2)
    np.testing.assert_allclose(line(tilt)[1], np.degrees(run.theta[seen]))
    np.testing.assert_allclose(line(velocity)[1], run.slip_velocity[seen] * 1e3)
    assert (tilt.get_ylabel(), velocity.get_ylabel()) == (
        r"tilt $\theta$ (degrees)",
        "contact velocity (mm/s)",
    )
    assert velocity.get_xlabel() == "time (s)"
    assert_legible(figure, least=10)


@pytest.mark.parametrize("draw", [plot.trajectory, plot.phase_portrait])
def test_paths_have_every_step_in_the_colour_of_its_contact(run, data, draw):
    figure = draw(data, 0.1, 0.15)
    (axes,) = figure.axes
    seen = (run.t >= 0.1) & (run.t <= 0.15)
    modes = run.contact[seen][:-1]
    present = sorted(set(modes.tolist()))
    assert len(present) >= 3
    assert [len(c.get_segments()) for c in axes.collections] == [
        np.count_nonzero(modes == code) for code in present
    ]
    legend = axes.get_legend().get_texts()
    assert [text.get_text() for text in legend] == [
        style.CONTACT_LABELS[run.contact_names[code]] for code in present
    ]
    every = np.concatenate([np.concatenate(c.get_segments()) for c in axes.collections])
    x, y = (run.x, run.z) if draw is plot.trajectory else (run.theta, run.omega)
    factor = (1e6, 1e6) if draw is plot.trajectory else (np.degrees(1.0), 1.0)
    for column, values, scale in zip(every.T, (x[seen], y[seen]), factor, strict=True):
        assert (column.min(), column.max()) == pytest.approx(
            (values.min() * scale, values.max() * scale)
        )
    assert all("(" in label for label in labels(figure))
    assert_legible(figure, least=10)


def test_a_filmstrip_shows_outline_contact_and_the_contact_before(run, data):
    times = [0.1, 0.12, 0.14, 0.16]
    figure = plot.filmstrip(data, times)
    assert len(figure.axes) == 4
    offsets_x, offsets_z = corner_offsets(run)
    touched, standing = [], 0
    for axes, time in zip(figure.axes, times, strict=True):
        k = np.abs(run.t - time).argmin()
        outline = axes.patches[0].get_xy()[:4]
        expected = np.column_stack([run.x[k] + offsets_x[:, k], run.z[k] + offsets_z[:, k]]) * 1e6
        for corner in expected:
            assert np.min(np.hypot(*(outline - corner).T)) < 1e-6
        marker = next(each for each in axes.get_lines() if each.get_marker() == "^")
        touched.append(float(marker.get_xdata()[0]))
        assert touched[-1] == pytest.approx(expected[expected[:, 1].argmin(), 0])
        if np.isfinite(run.contact_x[k]):
            standing += 1
            assert touched[-1] == pytest.approx(run.contact_x[k] * 1e6)
        dashed = [each for each in axes.get_lines() if each.get_linestyle() == "--"]
        assert [float(each.get_xdata()[0]) for each in dashed] == touched[-2:-1]
        assert axes.get_aspect() == 1.0
    assert standing
    assert "x (µm)" in labels(figure)
    assert "z (µm)" in labels(figure)
    assert_legible(figure, least=20)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 7])
def test_a_filmstrip_of_any_length_can_be_read_and_fills_its_sheet(run, count):
    figure = plot.filmstrip(run, np.linspace(0.1, 0.2, count).tolist())
    assert_legible(figure, least=7)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    ink = np.asarray(canvas.buffer_rgba())[..., :3].min(axis=2) < 255
    for along in (0, 1):
        drawn = np.flatnonzero(ink.any(axis=along))
        widest = np.diff([-1, *drawn, ink.shape[1 - along]]).max()
        # Versions of matplotlib place their text some pixels apart.
        assert widest < 0.3 * figure.dpi, "an empty band of 0.3 inches"


def test_given_axes_are_drawn_in(run):
    figure = Figure(layout="constrained", figsize=(9, 9))
    upper, lower = figure.subfigures(2, 1)
    axes = upper.subplots(2, 2).ravel()
    draws = [
        plot.fields,
        plot.angle_and_contact_velocity,
        plot.trajectory,
        plot.phase_portrait,
    ]
    for draw, ax in zip(draws, axes, strict=True):
        assert draw(run, ax=ax) is figure
        assert ax.has_data() or ax.collections
    strip = lower.subplots(1, 2)
    assert plot.filmstrip(run, [0.1, 0.11], labels=["a", "b"], ax=strip) is figure
    assert [ax.get_title(loc="left") for ax in strip] == ["a", "b"]


def test_a_robot_that_faces_back_is_drawn_facing_back():
    drive = Drive(direction="-x", base=0.5e-3, pulses=3)
    run = simulate(Scenario(drive=drive, record=Record(rate=RATE)))
    (axes,) = plot.filmstrip(run, [0.07]).axes
    front_bottom = axes.patches[0].get_xy()[0]
    k = np.abs(run.t - 0.07).argmin()
    assert front_bottom[0] < run.x[k] * 1e6
    assert run.contact_x[k] * 1e6 == pytest.approx(front_bottom[0])


def test_what_cannot_be_drawn_is_refused(run):
    with pytest.raises(AttributeError, match=r"set record\.rate"):
        plot.fields(simulate(run.scenario.replace({"record.rate": "none"})))
    events = simulate(run.scenario.replace({"record.rate": "events"}))
    for data in (events, events.to_xarray()):
        with pytest.raises(ValueError, match=r"set record\.rate"):
            plot.trajectory(data)
    with pytest.raises(ValueError, match="no theta"):
        plot.fields(run.to_xarray().drop_vars("theta"))
    with pytest.raises(ValueError, match="less than two samples"):
        plot.phase_portrait(run, 0.2, 0.1)
    with pytest.raises(ValueError, match="a time or more"):
        plot.filmstrip(run, [])
    with pytest.raises(ValueError, match="outside the record"):
        plot.filmstrip(run, [0.1, 9.0])
    with pytest.raises(ValueError, match="labels has 1 entries: allowed are 2"):
        plot.filmstrip(run, [0.1, 0.2], labels=["a"])


@pytest.mark.parametrize("suffix", ["gif", "webp"])
def test_an_animation_has_the_frames_it_says_and_repeats(run, data, tmp_path, suffix):
    path = tmp_path / f"motion.{suffix}"
    made = plot.animation(data, 0.1, 0.14, slowdown=10.0, frames_per_second=20.0)
    assert made.frames == 8
    assert repr(made) == "<Animation: 8 frames, 0.4 s>"
    made.save(path)
    with Image.open(path) as picture:
        assert picture.n_frames == made.frames
        assert picture.info["loop"] == 0
        frames = []
        for k in range(made.frames):
            picture.seek(k)
            picture.load()
            assert picture.info["duration"] == 50
            frames.append(np.asarray(picture.convert("L"), dtype=float))
    assert frames[0].std() > 5.0
    assert all(np.any(a != b) for a, b in itertools.pairwise(frames))
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_a_notebook_shows_an_animation_without_a_network(run):
    shown = plot.animation(run, 0.1, 0.11, slowdown=40.0)._repr_html_()
    content = re.fullmatch(r'<img alt="[\w ]+" src="data:image/webp;base64,(.+)">', shown).group(1)
    with Image.open(io.BytesIO(base64.b64decode(content))) as picture:
        assert picture.n_frames == 8


def instants(run, animation, first, last):
    """Samples of the frames of an animation from one time to another."""
    times = np.linspace(first, last, animation.frames, endpoint=False)
    return [int(np.abs(run.t - time).argmin()) for time in times]


def test_the_contact_of_every_frame_has_the_colour_of_what_it_does(run):
    made = plot.animation(run, 0.15, 0.15 + 1 / 30, slowdown=90.0, frames_per_second=20.0)
    colours = {"stick": style.STICK, "slip": style.SLIP, "flight": style.FLIGHT}
    offsets_x, offsets_z = corner_offsets(run)
    seen = set()
    for frame, sample in enumerate(instants(run, made, 0.15, 0.15 + 1 / 30)):
        side = made.frame(frame).axes[0]
        contact = next(each for each in side.get_lines() if each.get_label() == "contact")
        name = run.contact_names[run.contact[sample]]
        kind = next(each for each in colours if each in name)
        assert contact.get_color() == colours[kind]
        corner = offsets_z[:, sample].argmin()
        expected = run.x[sample] + offsets_x[corner, sample]
        assert contact.get_xdata()[0] == pytest.approx(expected * 1e6)
        seen.add(kind)
    assert seen == set(colours)


def test_an_animation_of_steady_pulses_leads_from_its_last_frame_to_its_first():
    drive = Drive(frequency=50, base=0.5e-3, pulses=20)
    run = simulate(Scenario(drive=drive, record=Record(rate=2e4)))
    # The last five of the pulses, in at most ten seconds.
    assert plot.animation(run, frames_per_second=10.0).frames == 100
    end = run.scenario.window[1]
    first, last = (int(np.abs(run.t - time).argmin()) for time in (end - 5 / 50, end))
    scene = Scene(motion(run), first, last, "")
    side = scene.figure.axes[0]

    def seen(sample):
        """Places from the middle of the view, µm: of body, ticks, stick, slip and flight."""
        scene.show(sample)
        low, high = side.get_xlim()
        _, ticks, *trace, _, _ = side.get_lines()
        places = [side.patches[1].get_xy()[:, 0], *(each.get_xdata() for each in (ticks, *trace))]
        relative = [np.asarray(each) - 0.5 * (low + high) for each in places]
        return [each[np.isfinite(each)] for each in relative]

    pairs = list(zip(seen(first), seen(last), strict=True))
    assert len(pairs) == 5
    for pair in pairs:
        for one, other in (pair, pair[::-1]):
            inner = one[np.abs(one) < 250.0]
            assert inner.size
            assert np.abs(np.subtract.outer(inner, other)).min(axis=1).max() < 1.0
    assert run.x[last] - run.x[first] > 80e-6


def test_an_animation_keeps_a_robot_in_view_that_stands_up_and_walks_far():
    run = simulate(Scenario(drive=Drive(base=0.5e-3, pulses=60), record=Record(rate=RATE)))
    scene = Scene(motion(run), 0, run.t.size - 1, "")
    side = scene.figure.axes[0]
    for sample in range(0, run.t.size, 100):
        scene.show(sample)
        low, high = side.get_xlim()
        outline = side.patches[1].get_xy()
        assert low < outline[:, 0].min() < outline[:, 0].max() < high
        assert outline[:, 1].max() < side.get_ylim()[1]
        assert high - low < 600.0
    assert run.x[-1] > 1.0e-3


def test_an_animation_that_cannot_be_is_refused_and_leaves_no_file(run, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    short = plot.animation(run, 0.1, 0.11)
    with pytest.raises(RuntimeError, match="ffmpeg"):
        short.save(tmp_path / "a.mp4")
    with pytest.raises(ValueError, match=r"\.gif, \.webp, \.mp4"):
        short.save(tmp_path / "a.png")
    with pytest.raises(ValueError, match="at most 2000"):
        plot.animation(run, slowdown=1e6)
    with pytest.raises(ValueError, match="at most 2000"):
        plot.animation(run, slowdown=1e308, frames_per_second=1e308)  # their product is infinite
    for value in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(ValueError, match="slowdown"):
            plot.animation(run, slowdown=value)
        with pytest.raises(ValueError, match="frames_per_second"):
            plot.animation(run, frames_per_second=value)
    assert list(tmp_path.iterdir()) == []
