"""The command line: what it prints and writes, exit statuses, interrupts, completion."""

import json
import os
import re
import shutil
import subprocess
import sys

import pytest
import xarray
from PIL import Image

from command_line import COMMAND, check, python_process, stickslip, stickslip_process
from refusals.cli import REFUSALS, contents, lay_out
from stickslip import Scenario, _core, effects, load, simulate
from stickslip.simulation.quantities import NUMBERS

TEXT = "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 12\n"  # see `scenario` of conftest


def printed(*arguments, **how):
    """The JSON object that a command prints."""
    done = stickslip(*arguments, "--json", **how)
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout, parse_constant=pytest.fail)


# --- stickslip run


def test_json_is_one_object_with_the_summary_of_the_library(scenario):
    assert printed("run", scenario) == simulate(load(scenario)).summary()


def test_settings_change_the_scenario_and_the_last_of_a_key_counts(scenario):
    settings = {
        "drive.mode": "OPP",
        "drive.frequency": 30,
        "drive.hold": 2.5e-3,
        "drive.edge": "fall",
        "drive.direction": "-x",
        "surface_tilt.angle": 0.001,
    }
    options = [f"--set={key}={value}" for key, value in settings.items()]
    found = printed("run", scenario, "--set=drive.frequency=60", *options)
    expected = simulate(load(scenario).replace(settings)).mean_velocity
    assert found["mean_velocity"] == expected
    assert expected < 0


def test_voltages_can_be_set_and_taken_away(scenario, tmp_path):
    (tmp_path / "v.csv").write_text("t,xp,xm,yp,ym,clamp\n0,0,0,0,0,0\n0.25,1,0,0,0,-1\n")
    found = printed("run", scenario, "--set", "drive.file=v.csv", cwd=tmp_path)
    assert found["simulated_time"] == 0.25
    (tmp_path / "p.toml").write_text('stickslip = 1\n[drive]\nmode = "program"\nfile = "v.csv"\n')
    walk = printed("run", tmp_path / "p.toml", "--set=drive.mode=IPP", "--set=drive.pulses=4")
    assert walk["simulated_time"] == pytest.approx(0.05 + 4 * 0.01)


def test_the_table_has_the_numbers_of_the_summary(scenario):
    for heading, names in ((0.0, ()), (1.5, ("velocity_along", "velocity_across"))):
        run = simulate(load(scenario).replace({"drive.heading": heading}))
        done = stickslip("run", scenario, f"--set=drive.heading={heading}")
        rows = dict(re.split("  +", line, maxsplit=1) for line in done.stdout.splitlines())
        assert rows["status"] == "ok"
        assert rows["measured"] == "over 0.08 to 0.17 s"
        assert "lift_off" in rows["events"]
        for name in ("mean_velocity", "slip_up", *names):
            assert rows[name].startswith(f"{run.summary()[name]:.6g} m/s ")
            assert rows[name].endswith(f"{run.summary()[name] * 1e3:.5g} mm/s")
        assert ("turning_speed" in rows) == ("final heading" in rows) == bool(names)
    assert rows["final heading"].startswith(f"{run.final_state.heading:.6g} rad ")


def test_a_failed_simulation_exits_with_one(scenario):
    slide = ["--set=effects.surface_tilt.angle=1.4", "--set=contact.static_friction=0"]
    slide += ["--set=contact.kinetic_friction=0", "--set=drive.ramp=100"]
    done = stickslip("run", scenario, "--json", *slide)
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "left_workspace" in done.stderr
    summary = json.loads(done.stdout, parse_constant=pytest.fail)
    assert (summary["status"], summary["mean_velocity"]) == ("left_workspace", None)


@pytest.mark.nightly
def test_out_and_plot_set_a_recording_rate(scenario, tmp_path):
    done = stickslip("run", scenario, "--out", tmp_path / "a.nc", "--plot", tmp_path / "a.png")
    assert (done.returncode, done.stderr) == (0, "")
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as data:
        # Ten samples or more in a period of the fastest free swing of 842 Hz at 2.5 mT.
        assert data.sizes["t"] > 0.17 * 842 * 10
        assert float(data["t"][-1]) == pytest.approx(0.17)
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.nc", "a.png", "scenario.toml"]


@pytest.mark.nightly
def test_the_rate_is_the_given_one_and_of_a_long_run_a_lower_one(scenario, tmp_path):
    long = ["--set=drive.peak=0", "--set=drive.base=0", "--set=drive.hold=0"]
    long += ["--set=drive.pulses=19995"]  # 200 s of at most a million samples
    for options, samples in ((["--set=record.rate=100"], 18), (long, 1_000_001)):
        stickslip("run", scenario, *options, "--out", tmp_path / "a.nc")
        with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as data:
            assert data.sizes["t"] == samples


# --- pictures of a run


@pytest.mark.parametrize(("option", "name"), [("--plot", "a.png"), ("--animate", "a.gif")])
def test_a_picture_of_which_nothing_can_be_drawn_is_a_failure(scenario, tmp_path, option, name):
    ends_before = ["--until", "time >= 0.05", "--start", "0.1"]
    done = stickslip("run", scenario, option, tmp_path / name, *ends_before)
    assert done.returncode == 1
    assert "status" in done.stdout
    assert done.stderr.startswith(f"stickslip: {option}: nothing drawn: ")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize(
    ("name", "options", "frames"),
    [
        # At the default of 20 frames a second; 10 ms, 40 times slower.
        ("walk.webp", "--set=drive.heading=0.5 --start=0.1 --stop=0.11 --slowdown=40", 8),
        # The last five of forty pulses.
        ("walk.gif", "--set=drive.pulses=40 --slowdown=10", 10),
    ],
)
@pytest.mark.nightly
def test_a_run_is_written_as_a_moving_picture(scenario, tmp_path, name, options, frames):
    pictures = ["--animate", tmp_path / name, "--plot", tmp_path / "run.png"]
    done = stickslip("run", scenario, *pictures, *options.split())
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "run.png").exists()
    with Image.open(tmp_path / name) as picture:
        assert picture.n_frames == frames


def test_a_robot_that_stays_has_no_velocity_in_print(scenario):
    still = ("run", scenario, "--set=drive.base=2.5e-3", "--set=drive.peak=2.5e-3")
    still += ("--set=drive.pulses=24",)
    assert 0.0 < abs(printed(*still)["mean_velocity"]) < 1e-8
    text = stickslip(*still).stdout
    assert re.search(r"^mean_velocity +0 m/s +0 mm/s$", text, re.MULTILINE)
    assert re.search(r"^velocity_growth +0 +0 %$", text, re.MULTILINE)


# --- keys, effects, init, help


def test_keys_lists_all_or_those_that_have_a_word():
    listed = printed("keys")["keys"]
    laws = [f"laws.NAME.{each}" for each in _core.law_keys]
    assert [each["key"] for each in listed] == [*Scenario.keys(), *laws]
    assert printed("keys", "LAWS")["keys"] == listed[-len(laws) :]
    assert {each["default"] for each in listed[-len(laws) :]} == {None}
    assert [each["key"] for each in printed("keys", "laws.own.scale")["keys"]] == ["laws.own.scale"]
    listed = listed[: -len(laws)]
    for each in listed:
        assert each["default"] == Scenario().get(each["key"])
    for word in ("friction", "Friction", "drive.frequency", "effects.surface_tilt"):
        wanted = [name for name in Scenario.keys() if word.casefold() in name]  # noqa: SIM118
        assert [each["key"] for each in printed("keys", word)["keys"]] == wanted
        sections = dict.fromkeys(name.rpartition(".")[0] for name in wanted)
        text = stickslip("keys", word).stdout
        assert re.findall(r"^\[(.*)\]$", text, re.MULTILINE) == list(sections)
        assert len(re.findall(r"^    \w+ = ", text, re.MULTILINE)) == len(wanted)
    for word, name in (("Fluid", "[fluid]"), ("uncertain", "[uncertain]"), ("map", "coil.map"),
                       ("field_per", "coil.field_per_ampere"), ("tracking", "[[tracking]]"),
                       ("Density", "robot.density")):  # fmt: skip
        assert name in printed("keys", word)["others"]
        assert name in stickslip("keys", word).stdout
    for one, many in (("coil", "coils"), ("Frequency", "frequencies"), ("prior", "Priors")):
        assert printed("keys", many) == printed("keys", one)
    # No name has it.
    assert all("pulses a second" in each["meaning"] for each in printed("keys", "a second")["keys"])


def test_effects_lists_all_or_those_that_have_a_word():
    found = printed("effects")["effects"]
    assert [each["name"] for each in found] == [each.name for each in effects()]
    for each in found:
        for parameter in each["parameters"]:
            assert {"key", "unit", "low", "high", "default", "meaning"} <= set(parameter)
    names = [each.name for each in effects() if "drag" in each.name]
    for word in ("drag", "drags"):
        assert [each["name"] for each in printed("effects", word)["effects"]] == names
    (tilt,) = (each for each in effects() if each.name == "surface_tilt")
    for word in ("effects.surface_tilt", "Surface_Tilt", tilt.meaning):
        assert [each["name"] for each in printed("effects", word)["effects"]] == [tilt.name]


def test_init_writes_a_robot_that_walks_with_all_keys_once(tmp_path):
    done = stickslip("init", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "wrote scenario.toml\n", "")
    text = (tmp_path / "scenario.toml").read_text()
    written = load(tmp_path / "scenario.toml")
    assert written == Scenario().replace({"drive.base": 0.5e-3})
    walk = simulate(written)
    assert walk.mean_velocity == pytest.approx(1.9e-3, rel=0.05)
    assert [note.code for note in walk.notes] == ["pulled"]
    for key in Scenario.keys():  # noqa: SIM118
        if not key.startswith("effects."):
            assert f"\n{key.rpartition('.')[2]} = " in text, key
    section, coil = text.split("[coil]")
    (tmp_path / "scenario.toml").write_text(f"{section}[coil]{coil.replace('= 510.0', '= 200.0')}")
    assert load(tmp_path / "scenario.toml") == written.replace({"coil.turns": 200.0})


def test_every_column_of_a_table_has_its_unit(scenario, tmp_path):
    (tmp_path / "u.toml").write_text('[uncertain]\n"drag.linear" = { low = 1e-6, high = 2e-6 }\n')
    vary = ["--vary=drive.peak=2e-3,3e-3", "--vary=drive.pulses=4,5", "--vary=drive.mode=IPP,OPP"]
    known = {each["unit"] for each in printed("keys")["keys"]}
    known |= {each.unit for each in NUMBERS.values()} | {"draws"}
    for command in (["sweep"], ["predict", "--draws=2", "--uncertain=u.toml"]):
        done = stickslip(*command, "scenario.toml", *vary, cwd=tmp_path)
        assert done.returncode == 0
        heading, units = (line.split() for line in done.stdout.splitlines()[:2])
        found = dict(zip(heading, units, strict=True))
        assert set(found.values()) <= known
        by_key = {name.removeprefix("drive_"): unit for name, unit in found.items()}
        assert [by_key[name] for name in ("peak", "pulses", "mode")] == ["T", "1", "-"]
        assert {u for name, u in found.items() if name.startswith("mean_velocity")} == {"m/s"}


# --- exit statuses and interrupts


def test_an_interrupt_of_the_imports_is_one_line():
    code = (
        "import importlib, sys\nbefore = set(sys.modules)\nfrom stickslip.__main__ import main\n"
        "print(*(m for m in sys.modules if m not in before))\n"
        "class Interrupt:\n"
        "    def find_spec(name, *_): raise KeyboardInterrupt\n"
        "sys.stdout.flush()\nsys.meta_path.insert(0, Interrupt)\nmain(['--version'])"
    )
    done = python_process("-c", code)
    assert (done.returncode, done.stderr) == (130, "stickslip: interrupted\n")
    # What is imported before `main` can answer takes a millisecond or two.
    assert set(done.stdout.split()) <= {
        "__future__",
        "signal",
        "enum",
        "stickslip",
        "stickslip.__main__",
        "stickslip.cli",
    }


def test_a_short_run_shows_no_progress_bar(scenario):
    assert stickslip_process("run", scenario).stderr == ""


def test_a_closed_output_pipe_ends_quietly():
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(
            [*COMMAND, "effects"], stdout=writing, stderr=subprocess.PIPE, timeout=60
        )
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (1, b"")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_output_device_is_reported_in_one_line(scenario):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [*COMMAND, "run", str(scenario)], stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode == 1
    assert done.stderr == "stickslip: cannot write standard output: No space left on device\n"


# In this process all are refused by test_refusals.py.
@pytest.mark.parametrize("bad", [bad for way, bad, _ in REFUSALS if way == "command"][::24])
def test_a_bad_input_is_refused_by_the_process(tmp_path, bad):
    arguments, files = (bad, {}) if isinstance(bad, str) else bad
    before = lay_out(tmp_path, files)
    check(stickslip_process(*arguments.split(), cwd=tmp_path))
    assert contents(tmp_path) == before


@pytest.mark.parametrize(
    "arguments", [["effects", "--json"], ["--help"], ["keys", "friction"], ["rnu"]]
)
def test_the_command_starts_quickly(arguments):
    # The modules that would break the promise of a quick start; a clock would measure the machine.
    heavy = "{'scipy', 'pandas', 'xarray', 'matplotlib', 'h5py', 'numpy'}"
    code = (
        "import sys\nfrom stickslip.__main__ import main\n"
        f"try: main({arguments})\nexcept SystemExit: pass\n"
        f"print(sorted({heavy} & set(sys.modules)), file=sys.stderr)"
    )
    done = python_process("-c", code)
    assert done.stderr.splitlines()[-1] == "[]"


# --- completion


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(
    ("words", "answers"),
    [
        ("swe", ["sweep"]),
        ("run s.toml --un", ["--until"]),
        ("run s.toml --set robot.ma", ["robot.mass=", "robot.magnetization="]),
        ("sweep s.toml --vary drive.fre", ["drive.frequency="]),
        ("keys drive.fre", ["drive.frequency"]),
    ],
)
def test_bash_completes_commands_options_and_keys(tmp_path, words, answers):
    command = tmp_path / "stickslip"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m stickslip "$@"\n')
    command.chmod(0o755)
    script = (
        'eval "$(_STICKSLIP_COMPLETE=bash_source stickslip)"\n'
        f"COMP_WORDS=(stickslip {words})\nCOMP_CWORD={len(words.split())}\n"
        '_stickslip_completion stickslip\nprintf "%s\\n" "${COMPREPLY[@]}"\n'
    )
    done = subprocess.run(
        ["bash", "--norc", "-c", script],
        env={**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (done.stdout.split(), done.stderr) == (answers, "")
