"""Runs that are read back from files, files that hold none, and the keys of a record."""

import hashlib
import subprocess
import sys
import tracemalloc

import pytest

from command_line import stickslip
from recorded_runs import COARSE, DENSE, assert_same_record
from stickslip import (
    Drive,
    Note,
    Record,
    Scenario,
    ScenarioError,
    Waveform,
    load,
    open_run,
    plot,
    simulate,
    sweep,
)
from stickslip.simulation.record_blocks import BLOCK


@pytest.mark.parametrize("name", ["run.nc", "run.csv"])
def test_a_run_that_is_read_back_is_drawn_and_goes_on(tmp_path, name):
    waveform = Waveform.ramp(0.02, {"clamp": -10.0}) + Waveform.hold(0.03, {"xp": 9.0}).repeat(3)
    scenario = Scenario(drive=Drive(mode="program", program=waveform), record=Record(rate=2000.0))
    run = simulate(scenario, until="time >= 0.05", out=tmp_path / name)
    again = open_run(tmp_path / name)
    assert again.scenario == scenario
    assert again.condition_met
    assert plot.run(again).axes
    going_on = [simulate(each.scenario.with_state(each.final_state)) for each in (run, again)]
    assert going_on[0].x.tobytes() == going_on[1].x.tobytes()
    again.save(tmp_path / f"again-{name}")
    assert_same_record(open_run(tmp_path / f"again-{name}"), run)


def refusal_of(path):
    with pytest.raises(ScenarioError) as refusal:
        open_run(path)
    assert "\n" not in str(refusal.value)
    assert str(refusal.value).startswith(f"{path}: ")
    return str(refusal.value)


def test_files_that_are_no_runs_are_refused_in_one_line(tmp_path):
    path = tmp_path / "run.nc"
    run = simulate(COARSE)
    run.save(path)
    opened = open_run(path)
    image = path.read_bytes()
    path.write_bytes(image[:3000] + b"!" + image[3001:])
    assert "checksum" in refusal_of(path)
    with pytest.raises(ScenarioError, match=r"run\.nc: has changed since this run was opened"):
        _ = opened.x
    path.unlink()
    with pytest.raises(ScenarioError, match=r"run\.nc: cannot be read: No such file"):
        _ = opened.x
    data = run.to_xarray()
    data.drop_vars("theta").to_netcdf(path, engine="h5netcdf")
    assert "it has no theta" in refusal_of(path)
    for attribute, value in (("scenario", "[drive"), ("complete", "maybe"), ("events", "{")):
        data.assign_attrs({attribute: value}).to_netcdf(path, engine="h5netcdf")
        refusal_of(path)
    del data.attrs["final_state"]
    data.to_netcdf(path, engine="h5netcdf")
    assert "is no run of this version" in refusal_of(path)
    assert "cannot be read: Is a directory" in refusal_of(tmp_path)


def test_csv_files_that_are_no_runs_are_refused_in_one_line(tmp_path):
    path, side = tmp_path / "run.csv", tmp_path / "run.csv.json"
    simulate(COARSE, out=path)
    text, about = path.read_text(), side.read_text()
    opened = open_run(path)
    # A digit of a sample, and a sample less.
    for damaged in (text.replace("1", "2", 1), text[: text.rindex("\n", 0, -1) + 1]):
        path.write_text(damaged)
        assert "its checksum is not that of run.csv.json" in refusal_of(path)
    with pytest.raises(ScenarioError, match="has changed since this run was opened"):
        _ = opened.x
    changed = text.replace("x (m)", "x (mm)").encode()
    path.write_bytes(changed)
    digests = [hashlib.sha256(each).hexdigest() for each in (text.encode(), changed)]
    side.write_text(about.replace(*digests))
    assert "it has no x" in refusal_of(path)
    for old, new in (
        ('"stickslip_run": 1', '"stickslip_run": 2'),
        ("sha256", "md5"),
        (about, "[]"),
    ):
        side.write_text(about.replace(old, new))
        assert "run.csv.json beside it is no file of a run" in refusal_of(path)
    side.unlink()
    assert "run.csv.json is missing beside it" in refusal_of(path)


def test_a_csv_file_is_not_opened_with_the_summary_of_another_run(tmp_path):
    # What is left where the process ends after the first of the two files took its name.
    for name, base in (("run.csv", 0.0), ("other.csv", 0.5e-3)):
        simulate(COARSE.replace({"drive.base": base}), out=tmp_path / name)
    (tmp_path / "other.csv.json").replace(tmp_path / "run.csv.json")
    assert "one of the two is of another run" in refusal_of(tmp_path / "run.csv")


def test_csv_files_need_no_library_of_netcdf(tmp_path):
    code = (
        "import sys\nfrom stickslip import Record, Scenario, open_run, simulate\n"
        "sys.modules |= dict.fromkeys(['xarray', 'h5py', 'h5netcdf'])\n"
        "run = simulate(Scenario(record=Record(rate=100.0)), out='run.csv')\n"
        "assert (open_run('run.csv').x == run.x).all()"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True)


def test_a_column_of_a_csv_file_is_read_with_little_more_memory_than_its_numbers(tmp_path):
    peaks = []
    for blocks in (2, 5):  # while one is read, the text of the one before is still there
        path = tmp_path / f"{blocks}.csv"
        # The last sample is at the end of the run, which takes 0.17 s.
        record = {"record.rate": (blocks * BLOCK - 1) / 0.17, "record.fields": "x"}
        simulate(DENSE.replace(record), out=path)
        run = open_run(path)
        tracemalloc.start()
        assert len(run.x) == blocks * BLOCK
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    # Eight bytes a number, twice while its blocks are joined; a text takes more than fifty.
    assert peaks[1] - peaks[0] < 20 * 3 * BLOCK


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("from", "-1", ["record.from = -1", "from 0 s"]),
        ("from", '"late"', ['record.from = "late"']),
        ("from", "2.0", ["record.from = 2", "from 0 to 1.05 s, the duration of the run"]),
        ("fields", '"x, thta"', ['record.fields = "x, thta"', 'did you mean "theta"?']),
        ("fields", '["x", 1]', ["record.fields = ['x', 1]", '"all"']),
        ("fields", "[]", ["record.fields = []"]),
        ("dtype", '"float16"', ['record.dtype = "float16"', '"float64", "float32"']),
        ("form", "1", ["record.form = 1: there is no such key", "record.from"]),
    ],
)
def test_bad_keys_of_a_record_are_refused_in_one_line(tmp_path, key, value, words):
    path = tmp_path / "scenario.toml"
    path.write_text(f"stickslip = 1\n[drive]\n[record]\nrate = 1e3\n{key} = {value}\n")
    done = stickslip("run", path, "--out", tmp_path / "run.nc")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    for word in words:
        assert word in done.stderr
    assert [each.name for each in tmp_path.iterdir()] == ["scenario.toml"]


def test_the_fields_of_a_record_are_one_value_however_they_are_written(tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_text('stickslip = 1\n[drive]\n[record]\nfields = ["theta", "x", "x"]\nfrom = 1\n')
    for scenario in (
        load(path),
        Scenario(record=Record(fields=("x", "theta"), from_=1.0)),
        Scenario().replace({"record.fields": " x,theta ", "record.from": 1}),
    ):
        assert scenario.get("record.fields") == "x, theta"
        assert scenario.record == Record(fields="theta, x", from_=1.0)
        scenario.to_toml(path)
        assert load(path) == scenario
    with pytest.raises(ScenarioError, match=r"record\.from: a sweep keeps summaries only"):
        sweep(Scenario(), vary={"record.from": [0.0, 1.0]})


@pytest.mark.parametrize("suffix", ["nc", "csv"])
def test_a_condition_that_was_never_met_is_a_note(suffix, tmp_path):
    path = tmp_path / f"a.{suffix}"
    scenario = Scenario(drive=Drive(base=0.5e-3, pulses=4), record=Record(rate=1e3))
    note = "the condition x >= 1 was not met until the end of the run"
    for run in (
        simulate(scenario, until="x  >= 1"),
        simulate(scenario, until="x >= 1", out=path),
        open_run(path),
    ):
        assert (run.condition_met, run.condition) == (False, "x >= 1")
        assert run.notes[0] == Note("condition-not-met", note)
    assert note not in map(str, simulate(scenario, until="x >= 1e-6").notes)
    failed = simulate(scenario.replace({"solver.max_steps": 100}), until="x >= 1")
    assert note not in map(str, failed.notes)
