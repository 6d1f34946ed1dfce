"""Every bad input through the real command: exit status 2, one line, nothing left behind."""

import os

import pytest

from command_line import check, stickslip

HEAD = "stickslip = 1\n[drive]\n"
CSV = "t,xp,xm,yp,ym,clamp\n0,0,0,0,0,0\n1,1,0,0,0,0\n"
PROGRAM = HEAD + 'mode = "program"\nfile = "v.csv"\n'


def run(tmp_path, scenario, *options, **more):
    """The command with both kinds of output asked for; there must be none."""
    out = tmp_path / "out"
    out.mkdir()
    done = stickslip(
        "run", scenario, "--out", out / "a.nc", "--plot", out / "a.png", *options, **more
    )
    assert list(out.iterdir()) == []
    return done


def test_a_bad_scenario(tmp_path):
    """One for all: the others are in `refusals.scenario`."""
    (tmp_path / "my scenario.toml").write_text(HEAD + "freqency = 3\n")
    check(run(tmp_path, tmp_path / "my scenario.toml"), "my scenario.toml: drive.freqency = 3")


def test_a_replaced_value_of_the_file_is_judged_too(tmp_path):
    (tmp_path / "s.toml").write_text(HEAD + "frequency = -3\n")
    check(run(tmp_path, tmp_path / "s.toml", "--set=drive.frequency=30"), "drive.frequency = -3")


def test_a_missing_scenario(tmp_path):
    check(run(tmp_path, tmp_path / "no.toml"), "no.toml", "No such file")


def test_a_folder_as_scenario(tmp_path):
    check(run(tmp_path, tmp_path), str(tmp_path), "directory")


OPTIONS = {
    "no value": (["--set", "drive.frequency"], ["drive.frequency", "key=value"]),
    "no key": (["--set", "=3"], ["key=value"]),
    "unknown key": (["--set", "drive.freqency=3"], ["did you mean", "drive.frequency"]),
    "unknown section": (["--set", "robto.length=3"], ["robto.length", "robot.length"]),
    "word for number": (["--set", "drive.peak=high"], ['drive.peak = "high"', "a number"]),
    "out of range": (["--set", "drive.frequency=-1"], ["--set", "drive.frequency = -1"]),
    "nan": (["--set", "drive.frequency=nan"], ["drive.frequency = nan"]),
    "together": (["--set", "drive.base=1"], ["drive.peak", "drive.base"]),
    "unit": (["--set", "drive.peak=2.5 mT"], ["drive.peak", "2.5 mT is 2.5e-3"]),
    "open quote": (["--set", 'drive.mode="IPP'], ["drive.mode", "quote"]),
    "degrees": (["--set", "drive.heading=30"], ["drive.heading = 30", "30 degrees are 0.5236 rad"]),
    "degrees of an effect": (
        ["--set", "effects.surface_tilt.angle=-20"],
        ["-20 degrees are -0.3491 rad"],
    ),
    "degrees with their unit": (["--set", "drive.heading=30deg"], ["30 degrees are 0.5236 rad"]),
    "mm": (["--set", "robot.length=0.25"], ["robot.length = 0.25", "0.25 mm are 0.00025 m"]),
    "um": (["--set", "robot.width=130"], ["robot.width = 130", "130 um are 0.00013 m"]),
    "ug": (["--set", "robot.mass=25.6"], ["robot.mass = 25.6", "25.6 ug are 2.56e-08 kg"]),
    "program as key": (["--set", "drive.program=v.csv"], ["drive.program", "drive.file"]),
    "sawtooth beside a file": (
        ["--set", "drive.file=v.csv", "--set", "drive.pulses=3"],
        ["--set", "drive.pulses", "drive.file"],
    ),
    "late start": (["--start", "9"], ["--start = 9.0", "1.05 s"]),
    "late start, six digits": (
        ["--set", "drive.ramp=0.123456789", "--start", "1.12346"],
        ["--start = 1.12346", "from 0 to 1.12345 s"],
    ),
    "rounded start": (["--set", "drive.pulses=12", "--start", "5"], ["from 0 to 0.17 s"]),
    "no stretch": (["--start", "0.1", "--stop", "0.1"], ["--start", "--stop"]),
    "missing voltages": (["--set", "drive.file=no.csv"], ["no.csv", "No such file"]),
    "unknown option": (["--frequency", "3"], ["--frequency"]),
    "two scenarios": (["other.toml"], ["other.toml"]),
    "curve of events": (["--set", "record.rate=events"], ["--plot", "record.rate"]),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_options(tmp_path, name):
    options, words = OPTIONS[name]
    (tmp_path / "s.toml").write_text(HEAD)
    (tmp_path / "v.csv").write_text(CSV)
    check(run(tmp_path, tmp_path / "s.toml", *options, cwd=tmp_path), *words)


@pytest.mark.parametrize(
    ("option", "name", "words"),
    [
        ("--out", "missing/a.nc", ["missing/a.nc", "no folder"]),
        ("--out", ".", ["is a folder"]),
        ("--out", "", ["is a folder"]),
        ("--plot", "missing/a.png", ["missing/a.png", "no folder"]),
        ("--plot", "a.docx", ["a.docx", ".png"]),
        ("--plot", "a", [".png"]),
        ("--out", "a.txt", ["--out", "a.txt", ".nc, .nc4, .h5, .csv"]),
        ("--out", "a", ["--out", ".csv"]),
        ("--out", "s.toml", ["--out", "s.toml", "is the scenario", "overwrite"]),
        ("--plot", "./s.toml", ["--plot", "s.toml", "is the scenario"]),
        ("--start", "0.1", ["--start", "--plot"]),
    ],
)
def test_targets(tmp_path, option, name, words):
    (tmp_path / "s.toml").write_text(HEAD)
    check(stickslip("run", "s.toml", option, name, cwd=tmp_path), *words)
    assert [each.name for each in tmp_path.iterdir()] == ["s.toml"]


@pytest.mark.parametrize("option", ["--out", "--plot"])
@pytest.mark.parametrize("link", [False, True])
def test_what_is_read_is_not_overwritten(tmp_path, option, link):
    (tmp_path / "s.toml").write_text(PROGRAM)
    (tmp_path / "v.csv").write_text(CSV)
    name = "v.csv"
    if link:
        name = "w.csv"
        (tmp_path / name).hardlink_to(tmp_path / "v.csv")
    check(stickslip("run", "s.toml", option, name, cwd=tmp_path), option, name, "drive.file")
    setting = f"--set=drive.file={name}"
    (tmp_path / "s.toml").write_text(HEAD)
    check(stickslip("run", "s.toml", setting, option, "v.csv", cwd=tmp_path), "--set drive.file")
    assert (tmp_path / "v.csv").read_text() == CSV


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="needs a folder that takes no file")
@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["run", "s.toml", "--out", "/proc/a.nc"], "/proc/a.nc"),
        (["run", "s.toml", "--plot", "/proc/a.png"], "/proc/a.png"),
        (["run", "s.toml", "--out", "a" * 300 + ".nc"], "aaa.nc: File name too long"),
        (["sweep", "s.toml", "--vary=drive.peak=1e-3", "--out", "/proc/a.nc"], "/proc/a.nc"),
        (["sweep", "s.toml", "--vary=drive.peak=1e-3", "--out", "a" * 250 + ".nc"], "aaa.nc: its"),
        (["diagnose", "m.toml", "--out", "/proc"], "/proc"),
        (["reproduce", "--only=fig8", "--out", "/proc"], "/proc"),
        (["init", "/proc/s.toml"], "/proc/s.toml"),
    ],
)
def test_a_path_that_cannot_be_written_is_refused_before_the_work(tmp_path, arguments, name):
    (tmp_path / "s.toml").write_text(HEAD)
    (tmp_path / "velocity.csv").write_text("velocity\n1e-3\n")
    (tmp_path / "m.toml").write_text(
        'stickslip_measurement = 1\nscenario = "s.toml"\n[[velocity]]\nfile = "velocity.csv"\n'
    )
    done = stickslip(*arguments, cwd=tmp_path)
    check(done, "cannot write", name)
    assert ".lock" not in done.stderr
    assert len(list(tmp_path.iterdir())) == 3


def test_an_error_names_its_file_once(tmp_path):
    (tmp_path / "s.toml").write_text(PROGRAM)
    (tmp_path / "v.csv").write_text(CSV + "2,0,0\n")
    done = stickslip("run", tmp_path / "s.toml")
    check(done, 'drive.file = "v.csv": row 4')
    assert done.stderr.count("v.csv") == 1


def test_a_device_is_not_replaced(tmp_path):
    (tmp_path / "s.toml").write_text(HEAD)
    check(stickslip("run", tmp_path / "s.toml", "--out", "/dev/null"), "not an ordinary file")


def test_one_file_for_out_and_plot_is_refused(tmp_path):
    (tmp_path / "s.toml").write_text(HEAD)
    both = tmp_path / "a.png"
    check(stickslip("run", tmp_path / "s.toml", "--out", both, "--plot", both), "cannot be both")
    assert not both.exists()


def test_commands():
    check(stickslip("rum"), "rum")
    check(stickslip("run"), "SCENARIO")
    check(stickslip("effects", "tilt_surface"), "tilt_surface", '"surface_tilt"')
    check(stickslip("keys", "drives"), "drives", '"drive"')
    check(stickslip("init", "missing/s.toml"), "missing/s.toml", "no folder")
