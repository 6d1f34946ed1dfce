"""Moving pictures: what each frame shows, and the files that are written."""

import base64
import io
import itertools
import re

import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from matplotlib.patches import FancyArrowPatch, Polygon
from PIL import Image

from pictures import heading_of, recorded, way_of
from stickslip import Drive, Record, Scenario, plot, simulate
from stickslip.plot import style


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


@pytest.mark.parametrize(("suffix", "step"), [("gif", 10), ("webp", 1)])
def test_frames_of_a_file_last_as_long_as_they_say_together(tmp_path, suffix, step):
    path, made = tmp_path / f"a.{suffix}", plot.animation(
        recorded("opp"), 0.1, 0.14, slowdown=5.0, frames_per_second=60.0)  # fmt: skip
    made.save(path)
    with Image.open(path) as picture:
        lasts = []
        for k in range(made.frames):
            picture.seek(k)
            picture.load()
            lasts.append(picture.info["duration"])
    assert abs(sum(lasts) - 1000.0 * made.frames / 60.0) <= step / 2


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


def test_a_walk_of_steady_pulses_leads_from_its_last_frame_to_its_first():
    drive = Drive(frequency=50, base=0.5e-3, pulses=20)
    run = simulate(Scenario(drive=drive, record=Record(rate=2e4)))
    # The last five of the pulses, in at most ten seconds.
    assert plot.animation(run, frames_per_second=10.0).frames == 100
    made = plot.animation(run, slowdown=200.0, frames_per_second=1e2)
    end = run.scenario.window[1]

    def seen(frame):
        """Places from the middle of the view, µm: of body, ticks, flight, slip and stick."""
        side = made.frame(frame).axes[0]
        middle = np.mean(side.get_xlim())
        ticks = np.array([each[0, 0] for each in side.collections[0].get_segments()])
        trace = [each.get_xdata() for each in side.get_lines() if np.size(each.get_xdata()) > 2]
        places = [np.asarray(each) - middle for each in (outline(side)[:, 0], ticks, *trace)]
        return [each[np.isfinite(each)] for each in places]

    # From frame to frame the camera moves by less than a thousandth of the way.
    pairs = list(zip(seen(0), seen(-1), strict=True))
    assert len(pairs) == 5
    for one, other in [*pairs, *(pair[::-1] for pair in pairs)]:
        inner = one[np.abs(one) < 250.0]
        assert inner.size
        assert np.abs(np.subtract.outer(inner, other)).min(axis=1).max() < 1.5
    first, last = (int(np.abs(run.t - time).argmin()) for time in (end - 5 / 50, end))
    assert run.x[last] - run.x[first] > 80e-6


def test_the_camera_stays_with_a_robot_that_stands_up_and_walks_far():
    run = recorded("forty pulses")
    made = plot.animation(run, 0.0, float(run.t[-1]), slowdown=4.0)
    assert run.x[-1] > 1.0e-3
    for frame in range(0, made.frames, 4):
        side = made.frame(frame).axes[0]
        body, (low, high) = outline(side), side.get_xlim()
        assert low < body[:, 0].min() < body[:, 0].max() < high
        assert body[:, 1].max() < side.get_ylim()[1]
        assert high - low < 600.0
