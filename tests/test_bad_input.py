"""Every bad input through the real command: exit status 2, one line, nothing left behind."""

import os

import pytest

from command_line import check, stickslip
from stickslip import ScenarioError
from stickslip.cli.settings import parse_value, read_with

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


SCENARIOS = {
    "empty": ("", ["is empty", "[drive]"]),
    "blank": ("\n \n", ["is empty"]),
    "syntax": (HEAD + "frequency = = 3\n", ["not valid TOML", "line 3"]),
    "twice": (HEAD + "peak = 1\npeak = 2\n", ["not valid TOML", "line 4"]),
    "no version": ("[drive]\n", ['"stickslip = 1"']),
    "newer version": ("stickslip = 2\n[drive]\n", ["stickslip = 2", "allowed is 1"]),
    "version as word": ('stickslip = "1"\n[drive]\n', ['stickslip = "1"']),
    "version as bool": ("stickslip = true\n[drive]\n", ["stickslip = true"]),
    "no drive": ("stickslip = 1\n", ["[drive] is missing"]),
    "unknown section": (HEAD + "[contcat]\n", ["[contcat]", 'did you mean "contact"?']),
    "section as number": ("stickslip = 1\ndrive = 3\n", ["drive = 3", "[drive]"]),
    "section as list": ("stickslip = 1\n[[drive]]\n", ["drive = ", "[drive]"]),
    "unknown key": (HEAD + "freqency = 3\n", ["drive.freqency = 3", 'mean "drive.frequency"?']),
    "unknown effect": (HEAD + "[effects.tilt_surface]\n", ["effects.tilt_surface"]),
    "unknown parameter": (
        HEAD + "[effects.surface_tilt]\nangel = 1\n",
        ["effects.surface_tilt.angel = 1", "effects.surface_tilt.angle"],
    ),
    "effects as number": ("stickslip = 1\neffects = 3\n[drive]\n", ["effects = 3"]),
    "effect as number": (HEAD + "[effects]\neddy_lag = 3\n", ["effects.eddy_lag = 3"]),
    "word for number": (HEAD + 'frequency = "30"\n', ['drive.frequency = "30"', "a number"]),
    "bool for number": (HEAD + "frequency = true\n", ["drive.frequency = true", "a number"]),
    "list for number": (HEAD + "frequency = [1]\n", ["drive.frequency = [1]", "a number"]),
    "date for number": (HEAD + "frequency = 2008-06-25\n", ["drive.frequency = ", "a number"]),
    "half a pulse": (HEAD + "pulses = 1.5\n", ["drive.pulses = 1.5", "whole number"]),
    "no pulses": (HEAD + "pulses = 0\n", ["drive.pulses = 0", "from 1"]),
    "endless digits": (HEAD + "pulses = 1" + "0" * 400 + "\n", ["drive.pulses = 1", "whole"]),
    "negative": (HEAD + "frequency = -30\n", ["drive.frequency = -30", "from 1e-06"]),
    "nan": (HEAD + "peak = nan\n", ["drive.peak = nan", "from 0 to 1 T"]),
    "inf": (HEAD + "ramp = inf\n", ["drive.ramp = inf", "s"]),
    "unknown word": (HEAD + 'edge = "up"\n', ['drive.edge = "up"', '"rise", "fall"']),
    "number for word": (HEAD + "mode = 1\n", ["drive.mode = 1", '"IPP", "OPP", "program"']),
    "friction": (
        HEAD + "[contact]\nkinetic_friction = 0.5\n",
        ["contact.kinetic_friction = 0.5", "contact.static_friction"],
    ),
    "sawtooth upside down": (HEAD + "base = 3e-3\n", ["drive.peak", "drive.base"]),
    "edge too long": (HEAD + "edge_time = 0.01\n", ["drive.edge_time = 0.01", "period"]),
    "zero rate": (HEAD + "[record]\nrate = 0\n", ["record.rate = 0", "above 0"]),
    "nan rate": (HEAD + "[record]\nrate = nan\n", ["record.rate = nan", "above 0"]),
    "rate as word": (HEAD + '[record]\nrate = "all"\n', ['record.rate = "all"', '"events"']),
    "too many samples": (HEAD + "[record]\nrate = 1e9\n", ["record.rate = 1e+09", "1e9"]),
    "program without file": (HEAD + 'mode = "program"\n', ["drive.mode", "drive.file"]),
    "heading of a program": (PROGRAM + "heading = 0.5\n", ["drive.heading", '"program"']),
    "coils of a program": (PROGRAM + 'coils = "pairs"\n', ["drive.coils", '"program"']),
    "file without program": (HEAD + 'file = "v.csv"\n', ['drive.mode = "IPP"', '"program"']),
    "sawtooth beside a file": (PROGRAM + "pulses = 3\n", ["drive.pulses", "drive.file"]),
    "program as key": (HEAD + 'program = "v.csv"\n', ["drive.program", "drive.file", '"program"']),
    "file as number": (HEAD + "file = 3\n", ["drive.file = 3", "path"]),
}


@pytest.mark.parametrize("name", SCENARIOS)
def test_scenarios(tmp_path, name):
    text, words = SCENARIOS[name]
    path = tmp_path / "my scenario.toml"
    path.write_text(text)
    (tmp_path / "v.csv").write_text(CSV)
    check(run(tmp_path, path), str(path), *words)


def test_a_missing_scenario(tmp_path):
    check(run(tmp_path, tmp_path / "no.toml"), "no.toml", "No such file")


def test_a_folder_as_scenario(tmp_path):
    check(run(tmp_path, tmp_path), str(tmp_path), "directory")


@pytest.mark.parametrize("data", [b"\x89PNG\r\n\x1a\n\xff\xfe" * 9, b"\0" * 99, b"a" * (2 << 20)])
def test_a_file_that_is_no_scenario(tmp_path, data):
    path = tmp_path / "s.toml"
    path.write_bytes(data)
    check(run(tmp_path, path), str(path))


VOLTAGES = {
    "empty": ("", ["is empty"]),
    "header only": ("t,xp,xm,yp,ym,clamp\n", ["0 row(s)", "two or more"]),
    "one row": ("t,xp,xm,yp,ym,clamp\n0,0,0,0,0,0\n", ["1 row(s)", "two or more"]),
    "missing column": ("t,xp,xm,yp,ym\n0,0,0,0,0\n", ["row 1", "column clamp is missing"]),
    "no header": ("0,0,0,0,0,0\n1,0,0,0,0,0\n", ["row 1", "column t is missing"]),
    "extra column": ("t,xp,xm,yp,ym,clamp,zp\n0,0,0,0,0,0,0\n", ["row 1", '"zp"', "no such"]),
    "column twice": ("t,xp,xm,yp,ym,clamp,xp\n0,0,0,0,0,0,0\n", ["row 1", "xp", "twice"]),
    "falling time": (CSV + "0.5,0,0,0,0,0\n", ["row 4", "t = 0.5", "1.0 s"]),
    "late start": (CSV.replace("\n0,", "\n0.5,"), ["row 2", "t = 0.5", "0 s"]),
    "no time": (CSV.replace("\n1,", "\n0,"), ["row 3", "t = 0.0", "above 0"]),
    "nan": (CSV + "2,0,nan,0,0,0\n", ["row 4", "column xm", "nan", "finite", "V"]),
    "inf": (CSV + "2,0,0,0,0,-inf\n", ["row 4", "column clamp", "-inf", "finite"]),
    "word": (CSV + "2,0,0,off,0,0\n", ["row 4", "column yp", "off", "finite"]),
    "gap": (CSV + "2,0,0,0,,0\n", ["row 4", "column ym", "finite"]),
    "time as word": (CSV + "later,0,0,0,0,0\n", ["row 4", "column t", "later", "of s"]),
    "short row": (CSV + "2,0,0\n", ["row 4", "3 cells", "6"]),
    "long row": (CSV + "2,0,0,0,0,0,0\n", ["row 4", "7 cells", "6"]),
    "cells separated by blanks": (
        CSV.replace(",", " "),
        ["line 1", "t xp xm", "no comma, semicolon or tab", "write commas"],
    ),
    "line break in a cell": (CSV + '2,"a\nb",0,0,0,0\n', ["line 4", "quoted cell", "one line"]),
    "unlike name": (CSV.replace("clamp", "Clmap"), ["column clamp", '"Clmap" may be meant']),
}


@pytest.mark.parametrize("name", VOLTAGES)
def test_voltage_files(tmp_path, name):
    text, words = VOLTAGES[name]
    (tmp_path / "s.toml").write_text(PROGRAM)
    (tmp_path / "v.csv").write_text(text)
    check(run(tmp_path, tmp_path / "s.toml"), "s.toml", 'drive.file = "v.csv"', *words)


def test_voltage_files_that_cannot_be_read(tmp_path):
    (tmp_path / "s.toml").write_text(PROGRAM)
    check(run(tmp_path, tmp_path / "s.toml"), "v.csv", "No such file")


@pytest.mark.parametrize("data", [b"\x89PNG\r\n\x1a\n\xff\xfe" * 9, b"\0" * 200_000])
def test_binary_voltage_files(tmp_path, data):
    (tmp_path / "s.toml").write_text(PROGRAM)
    (tmp_path / "v.csv").write_bytes(data)
    check(run(tmp_path, tmp_path / "s.toml"), "v.csv")


def test_a_folder_as_voltage_file(tmp_path):
    (tmp_path / "s.toml").write_text(PROGRAM)
    (tmp_path / "v.csv").mkdir()
    check(run(tmp_path, tmp_path / "s.toml"), "v.csv", "directory")


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


REPLACED = {
    "value": ("frequency = -3", ["drive.frequency=30"]),
    "word": ('edge = "up"', ["drive.edge=fall"]),
    "together": ("base = 3e-3", ["drive.peak=4e-3"]),
    "section": ("[robot]\nmass = 0", ["robot.mass=25e-9"]),
    "effect": ("[effects.surface_tilt]\nangle = 9", ["effects.surface_tilt.angle=0.1"]),
    "file": ('mode = "program"\nfile = "no.csv"', ["drive.file=v.csv"]),
    "mode": ('mode = "program"\nfile = "no.csv"', ["drive.mode=OPP", "drive.pulses=4"]),
    "whole drive": ("frequency = -3", ["drive.file=v.csv"]),
}


@pytest.mark.parametrize("name", REPLACED)
def test_a_replaced_value_of_the_file_is_not_checked(tmp_path, monkeypatch, name):
    text, settings = REPLACED[name]
    (tmp_path / "s.toml").write_text(f"{HEAD}{text}\n")
    (tmp_path / "v.csv").write_text(CSV)
    monkeypatch.chdir(tmp_path)
    found = read_with(tmp_path / "s.toml", settings)
    for key, value in (each.split("=") for each in settings):
        if key != "drive.file":
            assert found.get(key) == parse_value(value)
    with pytest.raises(ScenarioError, match=r"s\.toml.*: "):
        read_with(tmp_path / "s.toml", ["drag.linear=1e-6"])


def test_other_values_of_the_file_are_checked(tmp_path):
    (tmp_path / "s.toml").write_text(HEAD + "frequency = -3\npeak = -1\n")
    done = stickslip("run", tmp_path / "s.toml", "--set", "drive.frequency=30")
    check(done, "s.toml: drive.peak = -1")
    (tmp_path / "s.toml").write_text(HEAD)
    done = stickslip("run", tmp_path / "s.toml", "--set", "drive.base=0.1")
    check(done, "s.toml with --set: drive.peak = 0.0025 with drive.base = 0.1")


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
