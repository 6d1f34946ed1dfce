"""Runs in files: read back, and written while they are simulated; the keys of a record."""

import io
import os
from ast import literal_eval
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray

from command_line import files_up_to, python_process, stickslip, stickslip_process
from killed_recordings import killed
from own_effects import nothing_stays, register  # noqa: F401 (around every test here)
from recorded_runs import COARSE, DENSE, ENDLESS, assert_same_record, flat_columns
from stickslip import (
    Drive,
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
from stickslip.simulation.record_file import BLOCK, PART


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
    run = open_run(tmp_path / "run.nc.part")
    with files_up_to(20_000), pytest.raises(OSError, match=r"^cannot write \S+: File too large$"):
        run.save(tmp_path / "run.nc")
    assert [each.name for each in tmp_path.iterdir()] == ["run.nc.part"]
    run.save(tmp_path / "run.nc")
    assert_same_record(open_run(tmp_path / "run.nc"), open_run(tmp_path / "run.nc.part"))


@pytest.mark.nightly
def test_a_damaged_file_is_refused_or_read_as_it_was():
    code = Path(__file__).with_name("damaged_files.py")
    done = python_process(code, 500, 1, timeout=3600)
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


def linked(file, name):
    file[name] = h5py.ExternalLink("other.nc", f"/{name}")


def of_raw_bytes(file, name):
    file.create_dataset(name, (8,), "f8", external=[("other.nc", 0, 64)])


def virtual(file, name):
    layout = h5py.VirtualLayout((8,), "f8")
    layout[:] = h5py.VirtualSource("other.nc", name, (8,))
    file.create_virtual_dataset(name, layout)


def endless(file, name):
    file.create_dataset(name, (10**12,), "f8", chunks=(1024,), maxshape=(None,))[:8] = 1.0


def wide(file, name):
    file.create_dataset(name, (8, 10**12), "f8", chunks=(8, 1024))


@pytest.mark.parametrize(
    ("replace", "said"),
    [(linked, "not in it"), (of_raw_bytes, "not in it"), (virtual, "not in it"),
     (endless, "it states 1000000000000 rows of .*, and has 1024"), (wide, "of shape")],
)  # fmt: skip
def test_a_file_whose_data_are_not_in_it_is_refused(replace, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    points = {"drive.frequency": [100.0, 200.0]}
    simulate(COARSE, out="run.nc")
    sweep(COARSE, points, out="swept.nc")
    with h5py.File("other.nc", "w") as other:
        other["x"] = other["mean_velocity"] = np.arange(8.0)
    for path, name in (("run.nc", "x"), ("swept.nc", "mean_velocity")):
        with h5py.File(path, "r+") as file:
            del file[name]
            replace(file, name)
    with pytest.raises(ScenarioError, match=rf"^run\.nc: is damaged: .*{said}"):
        open_run("run.nc")
    with pytest.raises(ScenarioError, match=rf"^swept\.nc cannot be resumed: is damaged: .*{said}"):
        sweep(COARSE, points, out="swept.nc", resume=True)


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
    assert "nan" not in (tmp_path / "run.csv").read_text()
    # Text, as pandas reads numbers to the last bit or so.
    lines = pd.read_csv(tmp_path / "run.csv", dtype=str)
    columns = list(flat_columns(run))
    assert len(lines.columns) == len(columns)
    for name, unit, values in columns:
        heading = name.replace("current_", "current ") + f" ({unit})" * bool(unit)
        np.testing.assert_array_equal(lines[heading].to_numpy().astype(values.dtype), values)
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
    note = "the condition x >= 1 was not met until the end of the run at "
    for run in (
        simulate(scenario, until="x  >= 1"),
        simulate(scenario, until="x >= 1", out=tmp_path / "a.nc"),
        open_run(tmp_path / "a.nc"),
    ):
        assert (run.condition_met, run.condition) == (False, "x >= 1")
        assert run.notes[0].code == "condition-not-met"
        assert run.notes[0].text.startswith(f"{note}{run.simulated_time:.6g} s")
    failed = simulate(scenario.replace({"solver.max_steps": 100}), until="x >= 1")
    for run in (simulate(scenario, until="x >= 1e-6"), failed):
        assert "condition-not-met" not in [each.code for each in run.notes]


@pytest.fixture(scope="module")
def dense():
    run = simulate(DENSE)
    assert BLOCK < len(run.t) < 2 * BLOCK
    return run


def names(folder):
    return sorted(each.name for each in folder.iterdir())


def test_a_run_that_is_recorded_into_a_file_is_the_one_in_memory(dense, tmp_path):
    told = []
    run = simulate(DENSE, out=tmp_path / "run.nc", progress=lambda *each: told.append(each))
    dense.save(tmp_path / "saved.nc")
    assert names(tmp_path) == ["run.nc", "saved.nc"]
    for each in (run, open_run(tmp_path / "run.nc"), open_run(tmp_path / "saved.nc")):
        assert repr(each) == repr(dense)
        assert each.scenario == DENSE
        assert each.final_state == dense.final_state
        assert (each.complete, each.recorded_until) == (True, 0.17)
        assert repr(each.summary()) == repr(dense.summary())
        assert_same_record(each, dense)
        assert each.to_xarray().identical(dense.to_xarray())
    assert {stage for _, stage in told} <= {"simulating"}


def test_the_file_is_compressed_and_the_same_for_other_programs(dense, tmp_path):
    dense.save(tmp_path / "run.nc")
    with xarray.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as data:
        assert data.identical(dense.to_xarray())
        assert data.x.encoding["zlib"]
        assert data.x.encoding["shuffle"]
        assert data.x.encoding["chunksizes"] == (BLOCK,)
        plain = sum(variable.nbytes for variable in data.variables.values())
    assert (tmp_path / "run.nc").stat().st_size < 0.6 * plain


@pytest.mark.parametrize("name", [None, "run.nc"])
def test_a_record_keeps_what_it_is_asked_for(dense, tmp_path, name):
    keys = {"record.from": 0.1, "record.fields": "theta,x, current", "record.dtype": "float32"}
    run = simulate(DENSE.replace(keys), out=name and tmp_path / name)
    # 0.1 s at 500 kHz: the samples before number 50 000 are left out.
    assert run.t.tobytes() == dense.t[50_000:].tobytes()
    for field in ("x", "theta", "current"):
        expected = getattr(dense, field)[50_000:].astype(np.float32)
        assert getattr(run, field).tobytes() == expected.tobytes()
    assert set(run.to_xarray().variables) == {"t", "x", "theta", "current", "coil"}
    with pytest.raises(AttributeError, match=r"did not record z: set record\.fields to name it"):
        _ = run.z
    # The motion is the same, whatever is recorded of it.
    assert repr(run.summary()) == repr(dense.summary())
    # Why t is not rounded: after five minutes float32 has steps of 31 us.
    assert np.float32(333.0) + np.float32(1e-5) == np.float32(333.0)


def test_events_are_recorded_from_a_time_on(tmp_path):
    scenario = COARSE.replace({"record.rate": "events"})
    every = simulate(scenario)
    some = simulate(scenario.replace({"record.from": 0.1}), out=tmp_path / "run.nc")
    later = every.t >= 0.1
    assert 0 < later.sum() < len(later)
    assert_same_record(some, every, later)
    none = simulate(scenario.replace({"record.from": 0.17}), out=tmp_path / "run.nc")
    assert (len(none.event), none.current.shape) == (0, (0, 5))
    assert np.isnan(open_run(tmp_path / "run.nc").recorded_until)


def test_what_was_recorded_before_an_interrupt_is_kept_as_a_part(tmp_path):
    def interrupt(fraction, stage):
        raise KeyboardInterrupt

    path = tmp_path / "run.nc"
    path.write_text("older")
    scenario = ENDLESS.replace({"record.fields": ["x", "theta", "contact"]})
    with pytest.raises(KeyboardInterrupt, match=r"run\.nc\.part has the record up to [\d.]+ s"):
        simulate(scenario, out=path, progress=interrupt)
    assert path.read_text() == "older"
    assert names(tmp_path) == ["run.nc", f"run.nc{PART}"]
    run = open_run(tmp_path / f"run.nc{PART}")
    assert (run.status, run.complete, run.ok) == ("interrupted", False, False)
    assert run.notes[0].code == "record-cut"
    assert run.recorded_until == run.t[-1] > 0.0
    # Where the run was stopped within a step, the step's other samples are not recorded.
    assert 0.0 <= run.summary()["simulated_time"] - run.recorded_until < 0.01
    # What there is are the bits of a shorter run.
    pulses = int(run.recorded_until * 100.0) + 1
    shorter = simulate(scenario.replace({"drive.pulses": max(pulses, 4)}))
    for field in ("t", "x", "theta", "contact"):
        assert getattr(run, field).tobytes() == getattr(shorter, field)[: len(run.t)].tobytes()


def test_an_error_of_the_caller_passes_and_keeps_the_record(tmp_path):
    def stop(fraction, stage):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        simulate(ENDLESS, out=tmp_path / "run.nc", progress=stop)
    assert open_run(tmp_path / f"run.nc{PART}").status == "interrupted"
    late = ENDLESS.replace({"record.from": 9000.0})
    with pytest.raises(LookupError, match="enough"):
        simulate(late, out=tmp_path / "none.nc", progress=stop)
    assert names(tmp_path) == [f"run.nc{PART}"]  # nothing was recorded


# Room for one block of 65 536 samples of 169 bytes and a margin, not for two.
def test_a_full_disk_ends_the_run_and_keeps_whole_blocks(tmp_path):
    scenario = DENSE.replace({"drive.pulses": 20})
    scenario.to_toml(tmp_path / "scenario.toml")
    out = tmp_path / "out"
    out.mkdir()
    path = out / "run.nc"
    done = stickslip_process(
        "run", tmp_path / "scenario.toml", "--out", path, largest_file=13_500_000
    )
    assert (done.returncode, done.stdout) == (1, "")
    said = f"stickslip: cannot write {path}{PART}: File too large"
    # A slow machine shows a progress bar before.
    assert done.stderr.endswith(f"{said}; {path}{PART} has the record up to 0.13107 s\n")
    assert names(out) == [f"run.nc{PART}"]
    run = open_run(f"{path}{PART}")
    assert (run.status, run.complete) == ("interrupted", False)
    assert_same_record(run, simulate(scenario), slice(BLOCK))


# One within the writing of a block, and one at any time.
@pytest.mark.parametrize("k", range(2))
def test_a_killed_recording_leaves_whole_blocks_or_no_file(tmp_path, k):
    killed(tmp_path, np.random.default_rng([7, k]), inside=k % 2 == 0)


@pytest.mark.nightly
@pytest.mark.parametrize("k", range(60))
def test_many_killed_recordings(tmp_path, k):
    killed(tmp_path, np.random.default_rng([8, k]), inside=k % 3 == 0)


def test_two_recordings_of_one_name_never_mix(tmp_path):
    part = tmp_path / f"run.nc{PART}"
    simulate(COARSE).save(tmp_path / "other.nc")

    def replace(fraction, stage):
        if (tmp_path / "other.nc").exists():  # as another process does, which began later
            (tmp_path / "other.nc").replace(part)

    with pytest.raises(OSError, match="another process has replaced it"):
        simulate(ENDLESS, out=tmp_path / "run.nc", progress=replace)
    assert open_run(part).samples == 341


@pytest.mark.nightly
def test_memory_does_not_grow_with_the_record(tmp_path):
    code = (
        "import resource, sys\n"
        "from stickslip import *\n"
        "scenario = load(sys.argv[1])\n"
        "for pulses in (12, 30):\n"
        "    run = simulate(scenario.replace({'drive.pulses': pulses}), out=sys.argv[2])\n"
        "    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)\n"
    )
    DENSE.to_toml(tmp_path / "scenario.toml")
    done = python_process("-c", code, tmp_path / "scenario.toml", tmp_path / "run.nc")
    short, long = map(int, done.stdout.split())  # KiB
    # 0.18 s at 500 kHz are 90 000 samples more, which would be 15 MB.
    assert long - short < 8_000


def test_a_record_that_begins_late_is_drawn(tmp_path):
    COARSE.to_toml(tmp_path / "scenario.toml")
    run = ["run", tmp_path / "scenario.toml", "--out", tmp_path / "run.nc"]
    done = stickslip(*run, "--plot", tmp_path / "run.png", "--set", "record.from=0.05")
    assert done.returncode == 0
    assert (tmp_path / "run.png").stat().st_size > 0
