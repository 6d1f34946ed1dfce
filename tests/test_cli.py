"""The command line: output, exit statuses, interrupts."""

import json
import os
import re
import signal
import subprocess
import sys

import numpy as np
import pandas
import pytest
import xarray

from command_line import COMMAND, ended_at_the_bar, stickslip, stickslip_process
from stickslip import COIL_NAMES, Scenario, load, open_run, simulate
from stickslip.simulation.columns import COLUMNS, PLANE_COLUMNS

TEXT = "stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 12\n"


def test_json_is_one_object_with_the_summary_of_the_library(scenario):
    done = stickslip("run", scenario, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout) == simulate(load(scenario)).summary()


def test_settings_change_the_scenario(scenario):
    settings = {
        "drive.mode": "OPP",
        "drive.frequency": 30,
        "drive.hold": 2.5e-3,
        "drive.edge": "fall",
        "drive.direction": "-x",
        "effects.surface_tilt.angle": 0.001,
    }
    options = [f"--set={key}={value}" for key, value in settings.items()]
    done = stickslip("run", scenario, "--json", *options)
    expected = simulate(load(scenario).replace(settings)).mean_velocity
    assert json.loads(done.stdout)["mean_velocity"] == expected
    assert expected < 0


def test_the_last_setting_of_a_key_is_used(scenario):
    done = stickslip("run", scenario, "--json", "--set", "drive.pulses=4", "--set=drive.pulses=5")
    assert json.loads(done.stdout)["simulated_time"] == pytest.approx(0.05 + 5 * 0.01)


def test_a_voltage_file_can_be_set(scenario, tmp_path):
    (tmp_path / "v.csv").write_text("t,xp,xm,yp,ym,clamp\n0,0,0,0,0,0\n0.25,1,0,0,0,-1\n")
    done = stickslip("run", scenario, "--json", "--set", "drive.file=v.csv", cwd=tmp_path)
    assert json.loads(done.stdout)["simulated_time"] == 0.25


def test_the_table_names_status_velocity_and_events(scenario):
    done = stickslip("run", scenario)
    rows = dict(line.split(maxsplit=1) for line in done.stdout.splitlines())
    velocity = simulate(load(scenario)).mean_velocity
    assert rows["status"] == "ok"
    assert rows["measured"] == "over 0.08 to 0.17 s"
    assert rows["mean_velocity"].split()[:2] == [f"{velocity:.6g}", "m/s"]
    assert "lift_off" in rows["events"]


def test_out_and_plot_set_a_recording_rate(scenario, tmp_path):
    done = stickslip("run", scenario, "--out", tmp_path / "a.nc", "--plot", tmp_path / "a.png")
    assert (done.returncode, done.stderr) == (0, "")
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as data:
        # Ten samples or more in a period of the fastest free swing of 842 Hz at 2.5 mT.
        assert data.sizes["t"] > 0.17 * 842 * 10
        assert float(data["t"][-1]) == pytest.approx(0.17)
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.nc", "a.png", "scenario.toml"]


def test_a_given_rate_is_kept(scenario, tmp_path):
    stickslip("run", scenario, "--set", "record.rate=100", "--out", tmp_path / "a.nc")
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as data:
        assert data.sizes["t"] == 18


@pytest.mark.parametrize(("rate", "noted"), [(100, True), (1999, True), (2000, False)])
def test_a_rate_that_is_too_low_for_the_pulses_is_noted(scenario, tmp_path, rate, noted):
    done = stickslip("run", scenario, f"--set=record.rate={rate}", "--out", tmp_path / "a.nc")
    assert done.returncode == 0
    assert ("samples a pulse" in done.stderr) is noted
    assert done.stderr.count("\n") == noted


def test_a_rate_that_is_reduced_for_a_long_run_is_noted(scenario, tmp_path):
    settings = ["--set=drive.peak=0", "--set=drive.base=0", "--set=drive.hold=0"]
    done = stickslip(
        "run", scenario, *settings, "--set=drive.pulses=19995", "--out", tmp_path / "a.nc"
    )
    # 200 s of at most a million samples.
    assert done.stderr.startswith("stickslip: note: record.rate: 5000 Hz in place of 2e+04 Hz")
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as data:
        assert data.sizes["t"] == 1_000_001


def test_out_as_csv_has_the_columns_with_their_units(scenario, tmp_path):
    done = stickslip(
        "run", scenario, "--set=record.rate=2000", "--out", tmp_path / "a.csv", "--json"
    )
    assert (done.returncode, done.stderr) == (0, "")
    # Text, since pandas before version 3 reads numbers wrong in their last digits.
    table = pandas.read_csv(tmp_path / "a.csv", dtype=str)
    run = simulate(load(scenario).replace({"record.rate": 2000.0}))
    for name, column in COLUMNS.items():
        if name == "current":
            for k, coil in enumerate(COIL_NAMES):
                values = table[f"current {coil} (A)"].to_numpy(float)
                np.testing.assert_array_equal(values, run.current[:, k])
        elif name == "contact":
            assert table["contact"].tolist() == [run.contact_names[k] for k in run.contact]
        elif name not in ("event", *PLANE_COLUMNS):
            values = table[f"{name} ({column.unit})"].to_numpy(float)
            np.testing.assert_array_equal(values, getattr(run, name))
    assert len(table.columns) == 13 + 1 + 5 + 1


def test_notes_are_printed(scenario):
    still = ["--set=drive.peak=0", "--set=drive.base=0", "--set=drive.hold=0"]
    assert "the robot never moved" in stickslip("run", scenario, *still).stdout
    assert "solver.rtol = 0.0001" in stickslip("run", scenario, "--set=solver.rtol=1e-4").stdout
    assert "note" not in stickslip("run", scenario, "--set=drive.coils=pairs").stdout


def test_init_writes_a_robot_that_walks_with_all_keys_once(tmp_path):
    done = stickslip("init", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "wrote scenario.toml\n", "")
    text = (tmp_path / "scenario.toml").read_text()
    written = load(tmp_path / "scenario.toml")
    assert written == Scenario().replace({"drive.base": 0.5e-3})
    walk = simulate(written)
    assert walk.mean_velocity == pytest.approx(1.9e-3, rel=0.05)
    assert [note.code for note in walk.notes] == ["pulled"]
    assert max(map(len, text.splitlines())) <= 100
    for key in Scenario.keys():  # noqa: SIM118
        if not key.startswith("effects."):
            assert f"\n{key.rpartition('.')[2]} = " in text, key
    again = stickslip("init", "scenario.toml", cwd=tmp_path)
    assert again.returncode == 2
    assert again.stderr.startswith("stickslip: scenario.toml is already there")
    assert (tmp_path / "scenario.toml").read_text() == text


def test_a_failed_simulation_exits_with_one(scenario):
    slide = ["--set=effects.surface_tilt.angle=1.4", "--set=contact.static_friction=0"]
    slide += ["--set=contact.kinetic_friction=0", "--set=drive.ramp=100"]
    done = stickslip("run", scenario, "--json", *slide)
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "left_workspace" in done.stderr
    summary = json.loads(done.stdout, parse_constant=pytest.fail)
    assert summary["status"] == "left_workspace"
    assert summary["mean_velocity"] is None


@pytest.mark.parametrize(
    "settings",
    [
        pytest.param(["solver.max_step=1e-7", "drive.pulses=5000"], id="moving"),
        # As many pulses as the default of solver.max_steps allows, two stretches each.
        pytest.param(["drive.peak=0.6e-3", "drive.hold=1e-6", "drive.pulses=499e6"], id="at rest"),
    ],
)
def test_an_interrupt_stops_a_run(scenario, settings):
    # How fast is measured by bench/promises.py; here a run that would take hours has to end.
    options = [f"--set={setting}" for setting in settings]
    done, _ = ended_at_the_bar("run", scenario, *options, shows=b"simulating")
    assert (done.returncode, done.stdout) == (130, b"")
    assert b"Traceback" not in done.stderr
    assert re.search(rb"stickslip: interrupted at \d+ %, nothing written\n$", done.stderr)


def test_termination_keeps_what_was_recorded_as_an_interrupt_does(scenario, tmp_path):
    # Twice, as `timeout` sends it: to the process and to its group.
    folder = tmp_path / "out"
    folder.mkdir()
    settings = ("solver.max_step=1e-7", "drive.pulses=5000", "record.rate=1e7")
    options = [*(f"--set={setting}" for setting in settings), "--out", folder / "term.nc"]
    twice = 2 * (signal.SIGTERM,)
    done, _ = ended_at_the_bar("run", scenario, *options, shows=b"simulating", signals=twice)
    assert done.returncode == 130
    assert re.search(rb"stickslip: interrupted at \d+ %, \S+ has the record up to ", done.stderr)
    assert [each.name for each in folder.iterdir()] == ["term.nc.part"]
    assert open_run(folder / "term.nc.part").recorded_until > 0.0


def test_an_interrupt_of_the_imports_is_silent():
    code = (
        "import importlib, sys\nbefore = set(sys.modules)\nfrom stickslip.cli import main\n"
        "print(*(m for m in sys.modules if m not in before))\n"
        "class Interrupt:\n"
        "    def find_spec(name, *_): raise KeyboardInterrupt\n"
        "sys.stdout.flush()\nsys.meta_path.insert(0, Interrupt)\nmain(['--version'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (130, "")
    # What is imported before `main` can answer takes less than a millisecond.
    assert done.stdout == "__future__ stickslip stickslip.cli\n"


def test_a_short_run_shows_no_progress_bar(scenario):
    assert stickslip_process("run", scenario).stderr == ""


def test_a_closed_output_pipe_is_no_error():
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(
            [*COMMAND, "effects"], stdout=writing, stderr=subprocess.PIPE, timeout=60
        )
    finally:
        os.close(writing)
    assert done.stderr == b""
    assert done.returncode == 141


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_output_device_is_reported_in_one_line(scenario):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [*COMMAND, "run", str(scenario)], stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode == 1
    assert done.stderr == "stickslip: cannot write standard output: No space left on device\n"


@pytest.mark.parametrize(
    ("option", "name"), [("--out", "a.nc"), ("--out", "a.csv"), ("--plot", "a.png")]
)
def test_a_full_disk_leaves_no_file(scenario, tmp_path, option, name):
    folder = tmp_path / "out"
    folder.mkdir()

    done = stickslip_process("run", scenario, option, folder / name, largest_file=10_000)
    assert done.returncode == 1
    # A picture is drawn after the run, which nobody simulates again.
    assert done.stdout == (stickslip("run", scenario).stdout if option == "--plot" else "")
    assert done.stderr.startswith("stickslip: cannot write")
    assert done.stderr.count("\n") == 1
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize(
    "arguments", [["effects", "--json"], ["--help"], ["keys", "friction"], ["rnu"]]
)
def test_the_command_starts_quickly(arguments):
    # The modules that would break the promise of a quick start; a clock would measure the machine.
    heavy = "{'scipy', 'pandas', 'xarray', 'matplotlib', 'h5py', 'numpy'}"
    code = (
        "import sys\nfrom stickslip.cli import main\n"
        f"try: main({arguments})\nexcept SystemExit: pass\n"
        f"print(sorted({heavy} & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stderr.splitlines()[-1] == "[]"


def test_the_default_scenario_runs_from_its_own_file(tmp_path):
    Scenario().to_toml(tmp_path / "s.toml")
    assert stickslip("run", tmp_path / "s.toml").returncode == 0


def test_the_summary_of_a_heading_has_the_velocity_along_it_and_where_the_robot_ends(scenario):
    run = simulate(load(scenario).replace({"drive.heading": 1.5}))
    done = stickslip("run", scenario, "--set", "drive.heading=1.5")
    lines = {line[:19].rstrip(): line[19:] for line in done.stdout.splitlines()}
    along, across = run.velocity
    assert lines["velocity_along"].startswith(f"{along:.6g} m/s ")
    assert "along the heading" in lines["velocity_along"]
    assert lines["velocity_across"].startswith(f"{across:.6g} m/s ")
    assert lines["mean_velocity"].endswith("along x")
    assert lines["final y"].startswith(f"{run.final_state.y:.6g} m ")
    assert lines["final heading"].startswith(f"{run.final_state.heading:.6g} rad ")
    assert "turning_speed" in lines


def test_a_condition_that_was_never_met_is_told(scenario):
    done = stickslip("run", scenario, "--until", "x >= 1")
    assert "note               the condition x >= 1 was not met" in done.stdout
    found = json.loads(stickslip("run", scenario, "--until", "x >= 1", "--json").stdout)
    assert found["notes"][0]["text"].startswith("the condition x >= 1 was not met")
