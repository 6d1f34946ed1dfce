"""Pictures and moving pictures of ``stickslip run``."""

import pytest
from PIL import Image

from command_line import stickslip

TEXT = "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 12\n"


def test_a_stretch_of_the_picture_can_be_chosen(scenario, tmp_path):
    plot = ["--plot", tmp_path / "a.svg", "--set=record.rate=2000"]
    done = stickslip("run", scenario, *plot, "--start", "0.1", "--stop", "0.12")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "a.svg").exists()


def test_a_picture_of_which_nothing_can_be_drawn_is_a_failure(scenario, tmp_path):
    # The run ends before the stretch begins.
    ends = ["--until", "time >= 0.05", "--start", "0.1"]
    done = stickslip("run", scenario, "--plot", tmp_path / "a.png", *ends)
    assert done.returncode == 1
    assert "status" in done.stdout
    assert done.stderr.startswith("stickslip: --plot: nothing drawn: ")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "a.png").exists()


@pytest.mark.parametrize("suffix", ["gif", "webp"])
def test_a_run_is_written_as_a_moving_picture(scenario, tmp_path, suffix):
    path = tmp_path / f"walk.{suffix}"
    stretch = ["--start=0.1", "--stop=0.11", "--slowdown=40", "--plot", tmp_path / "run.png"]
    done = stickslip("run", scenario, "--animate", path, *stretch)
    assert (done.returncode, done.stderr) == (0, "")
    assert path.read_bytes().startswith({"gif": b"GIF8", "webp": b"RIFF"}[suffix])
    assert (tmp_path / "run.png").exists()


def test_a_robot_that_leaves_its_plane_is_written_as_a_moving_picture(scenario, tmp_path):
    path = tmp_path / "walk.gif"
    options = ["--set=drive.heading=0.5", "--start=0.1", "--stop=0.11", "--slowdown=40"]
    done = stickslip("run", scenario, "--animate", path, *options)
    assert (done.returncode, done.stderr) == (0, "")
    with Image.open(path) as picture:
        assert picture.n_frames == 8
    fields = "x, z, theta, omega, normal_force, slip_velocity, bx, by, bz, contact"
    done = stickslip("run", scenario, "--animate", path, *options, f"--set=record.fields={fields}")
    assert done.returncode == 2
    assert done.stderr.endswith("also y, heading, slip_across\n")


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--animate", "a.mp4"], "--animate: a.mp4: MP4 needs the program ffmpeg, which is not"),
        (["--animate", "a.png"], "--animate: a.png: allowed are names that end in .gif, .webp"),
        (["--animate", "scenario.toml"], "--animate: scenario.toml is the scenario, which it"),
        (["--animate", "a.gif", "--out", "a.gif"], "--out and --animate: a.gif cannot be both"),
        (["--animate", "a.gif", "--slowdown", "1e5"], "--animate: 100000 frames: allowed are at"),
        (["--animate", "a.gif", "--slowdown", "0"], "--animate: slowdown = 0.0: allowed is a"),
        (["--animate", "a.gif", "--slowdown", "inf"], "--animate: slowdown = inf: allowed is a"),
        (["--animate", "a.gif", "--set=record.rate=events"], '--animate: record.rate = "events"'),
        (["--slowdown", "10"], "--slowdown: allowed with --animate only"),
        (["--start", "0.1"], "--start: allowed with --plot or --animate only"),
    ],
)
def test_moving_pictures_that_cannot_be_are_refused_before_the_run(
    scenario, tmp_path, monkeypatch, options, told
):
    monkeypatch.setenv("PATH", str(tmp_path))
    done = stickslip("run", "scenario.toml", *options, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"stickslip: {told}")
    assert done.stderr.count("\n") == 1
    assert [each.name for each in tmp_path.iterdir()] == ["scenario.toml"]


def test_a_moving_picture_of_a_long_run_has_its_last_pulses(scenario, tmp_path):
    # Five of forty pulses at 100 Hz, at 2 frames in a pulse.
    path = tmp_path / "walk.gif"
    done = stickslip("run", scenario, "--animate", path, "--set=drive.pulses=40", "--slowdown=10")
    assert (done.returncode, done.stderr) == (0, "")
    with Image.open(path) as picture:
        assert picture.n_frames == 10
