"""Runs that are read back from files, and the keys of a record."""

import io
import os
import resource
import subprocess
import sys
from ast import literal_eval
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest

from recorded_runs import COARSE, assert_same_record
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
from stickslip.simulation import checked_file


def test_a_run_that_is_read_back_is_drawn_and_goes_on(tmp_path):
    waveform = Waveform.ramp(0.02, {"clamp": -10.0}) + Waveform.hold(0.03, {"xp": 9.0}).repeat(3)
    scenario = Scenario(drive=Drive(mode="program", program=waveform), record=Record(rate=2000.0))
    run = simulate(scenario, until="time >= 0.05", out=tmp_path / "run.nc")
    again = open_run(tmp_path / "run.nc")
    assert again.scenario == scenario
    assert again.condition_met
    assert plot.run(again).axes
    going_on = [simulate(each.scenario.with_state(each.final_state)) for each in (run, again)]
    assert going_on[0].x.tobytes() == going_on[1].x.tobytes()
    again.save(tmp_path / "again.nc")
    assert_same_record(open_run(tmp_path / "again.nc"), run)


def test_a_file_that_is_replaced_is_not_mixed_with_what_was_read(tmp_path):
    path = tmp_path / "run.nc"
    simulate(COARSE).save(path)
    opened = open_run(path)
    x = opened.x.copy()
    simulate(COARSE.replace({"drive.base": 0.0})).save(path)
    assert opened.x.tobytes() == x.tobytes()  # kept
    with pytest.raises(ScenarioError, match=r"run\.nc: is not the file that was opened"):
        _ = opened.z
    path.unlink()
    with pytest.raises(ScenarioError, match=r"run\.nc: cannot be read: No such file"):
        _ = opened.z


def test_a_part_stays_until_it_is_saved(tmp_path):
    simulate(COARSE).save(tmp_path / "run.nc")
    (tmp_path / "run.nc").rename(tmp_path / "run.nc.part")
    code = (
        "from stickslip import open_run\n"
        "try: open_run('run.nc.part').save('run.nc')\n"
        "except OSError as error: print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)),
    )
    assert (done.stdout, done.stderr) == ("cannot write run.nc: File too large\n", "")
    assert [each.name for each in tmp_path.iterdir()] == ["run.nc.part"]
    open_run(tmp_path / "run.nc.part").save(tmp_path / "run.nc")
    assert_same_record(open_run(tmp_path / "run.nc"), open_run(tmp_path / "run.nc.part"))


@pytest.mark.nightly
def test_a_damaged_file_is_refused_or_read_as_it_was():
    code = Path(__file__).with_name("damaged_files.py")
    command = [sys.executable, code, "500", "1"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    kinds = literal_eval(done.stdout)
    assert len(kinds) == 3
    assert all(sum(each.values()) >= 500 // 3 and each["refused"] for each in kinds.values())


def test_a_file_without_checksums_is_opened_in_limited_time(tmp_path, monkeypatch):
    path = tmp_path / "run.nc"
    simulate(COARSE, out=path)
    whole, sums = simulate(COARSE), path.read_bytes()[-8:]
    with h5py.File(path, "r+") as file:  # as another program would
        file.attrs["more"] = 1
    assert path.read_bytes()[-8:] != sums
    assert_same_record(open_run(path), whole)
    monkeypatch.setattr(checked_file, "_LIMITS", (1, 1.0))
    monkeypatch.setattr(checked_file, "_TRIAL", "while True: pass")
    path.touch()
    with pytest.raises(ScenarioError, match=r"run\.nc: is no netCDF file, or a damaged one"):
        open_run(path)


def when_its_end_is_sought(monkeypatch, change):
    """Let `change` come between the search for a file's end and what is read next."""

    class File(io.FileIO):
        def seek(self, offset, whence=0):
            position = super().seek(offset, whence)
            if whence == os.SEEK_END:
                change()
            return position

    monkeypatch.setattr(checked_file, "open", File, raising=False)


def test_a_file_that_grows_while_it_is_opened(tmp_path, monkeypatch):
    path = tmp_path / f"run.nc{checked_file.PART}"
    simulate(COARSE).save(tmp_path / "run.nc")
    (tmp_path / "run.nc").rename(path)

    def grow():
        with path.open("ab") as file:
            file.write(bytes(100))

    when_its_end_is_sought(monkeypatch, grow)
    assert_same_record(open_run(path), simulate(COARSE))


def test_a_file_that_goes_while_it_is_opened(tmp_path, monkeypatch):
    path = tmp_path / f"run.nc{checked_file.PART}"
    path.write_bytes(bytes(1000))
    when_its_end_is_sought(monkeypatch, lambda: path.unlink(missing_ok=True))
    with pytest.raises(ScenarioError, match=rf"{path}: no longer exists: its run has ended"):
        open_run(path)


@pytest.mark.parametrize("rate", [2000.0, "events"])
def test_a_csv_file_has_the_record_with_units_and_words(tmp_path, rate):
    scenario = COARSE.replace({"record.rate": rate})
    run = simulate(scenario, out=tmp_path / "run.csv")
    run.save(tmp_path / "saved.csv")
    assert (tmp_path / "run.csv").read_bytes() == (tmp_path / "saved.csv").read_bytes()
    assert sorted(each.name for each in tmp_path.iterdir()) == ["run.csv", "saved.csv"]
    table = pd.read_csv(tmp_path / "run.csv")
    lines = pd.read_csv(tmp_path / "run.csv", dtype=str)
    # The cells have the bits; pandas reads them to the last one or so.
    np.testing.assert_array_equal([float(cell) for cell in lines["t (s)"]], run.t)
    np.testing.assert_allclose(table["current clamp (A)"], run.current[:, 4], rtol=1e-15)
    flying = run.contact == run.contact_names.index("flight")
    assert lines["slip_velocity (m/s)"].isna().tolist() == flying.tolist()
    assert table["contact"].tolist() == [run.contact_names[k] for k in run.contact]
    if rate == "events":
        assert table["event"].tolist() == [run.event_names[k] for k in run.event]
    with pytest.raises(ScenarioError, match="is no netCDF file"):
        open_run(tmp_path / "run.csv")


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


def test_a_condition_that_was_never_met_is_a_note(tmp_path):
    scenario = Scenario(drive=Drive(base=0.5e-3, pulses=4), record=Record(rate=1e3))
    note = "the condition x >= 1 was not met until the end of the run"
    for run in (
        simulate(scenario, until="x  >= 1"),
        simulate(scenario, until="x >= 1", out=tmp_path / "a.nc"),
        open_run(tmp_path / "a.nc"),
    ):
        assert (run.condition_met, run.condition) == (False, "x >= 1")
        assert run.notes[0] == Note("condition-not-met", note)
    assert note not in map(str, simulate(scenario, until="x >= 1e-6").notes)
    failed = simulate(scenario.replace({"solver.max_steps": 100}), until="x >= 1")
    assert note not in map(str, failed.notes)
