"""Records that go into a file while a run is simulated, and runs that are read back."""

import json
import resource
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray

from command_line import COMMAND, stickslip, stickslip_process
from stickslip import (
    Contact,
    Drag,
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
from stickslip.simulation.record_blocks import BLOCK, recorded_names

# 0.17 s at 500 kHz: 85 001 samples, a full block and a rest.
DENSE = Scenario(drive=Drive(base=0.5e-3, pulses=12), record=Record(rate=5e5))
COARSE = DENSE.replace({"record.rate": 2000.0})
# Minutes of work, and a record that does not fit into memory.
ENDLESS = DENSE.replace({"drive.pulses": 1_000_000, "record.rate": 5e4})


@pytest.fixture(scope="module")
def dense():
    run = simulate(DENSE)
    assert BLOCK < len(run.t) < 2 * BLOCK
    return run


def assert_same_record(one, other, samples=slice(None)):
    """The arrays of two runs are the same bits; of `other` these samples."""
    assert recorded_names(one.scenario) == recorded_names(other.scenario)
    for name in recorded_names(one.scenario):
        expected = getattr(other, name)[samples]
        assert getattr(one, name).dtype == expected.dtype, name
        assert getattr(one, name).tobytes() == expected.tobytes(), name


@pytest.mark.parametrize(
    ("name", "fields"), [("run.nc", "all"), ("run.csv", "x, slip_velocity, current, contact")]
)
def test_a_run_that_is_recorded_into_a_file_is_the_one_in_memory(tmp_path, name, fields):
    told = []
    scenario = DENSE.replace({"record.fields": fields})
    dense = simulate(scenario)
    run = simulate(scenario, out=tmp_path / name, progress=lambda *each: told.append(each))
    dense.save(tmp_path / f"saved-{name}")
    for each in (run, open_run(tmp_path / name), open_run(tmp_path / f"saved-{name}")):
        assert repr(each) == repr(dense)
        assert each.scenario == scenario
        assert each.final_state == dense.final_state
        assert (each.complete, each.recorded_until) == (True, 0.17)
        assert repr(each.summary()) == repr(dense.summary())
        assert_same_record(each, dense)
        assert each.to_xarray().identical(dense.to_xarray())
    # The same bytes, whether the blocks come from the core or from arrays.
    assert (tmp_path / name).read_bytes() == (tmp_path / f"saved-{name}").read_bytes()
    beside = [f"{name}.json", f"saved-{name}.json"] if name.endswith("csv") else []
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted(
        [name, f"saved-{name}", *beside]
    )
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


@pytest.mark.parametrize("name", [None, "run.nc", "run.csv"])
def test_single_precision_is_the_rounded_record(dense, tmp_path, name):
    scenario = DENSE.replace({"record.dtype": "float32", "record.fields": "x, current, contact"})
    run = simulate(scenario, out=name and tmp_path / name)
    assert run.t.tobytes() == dense.t.tobytes()
    assert run.x.tobytes() == dense.x.astype(np.float32).tobytes()
    assert run.current.tobytes() == dense.current.astype(np.float32).tobytes()
    assert run.contact.tobytes() == dense.contact.tobytes()
    # Why t is not rounded: after five minutes float32 has steps of 31 us.
    assert np.float32(333.0) + np.float32(1e-5) == np.float32(333.0)


@pytest.mark.parametrize("name", [None, "run.nc", "run.csv"])
def test_a_record_begins_where_it_is_to_and_has_the_fields_that_were_asked_for(
    dense, tmp_path, name
):
    scenario = DENSE.replace({"record.from": 0.1, "record.fields": "theta,x"})
    run = simulate(scenario, out=name and tmp_path / name)
    # 0.1 s at 500 kHz: the samples before number 50 000 are left out.
    assert run.t[0] == 0.1
    assert_same_record(run, simulate(scenario))
    for field in ("t", "x", "theta"):
        assert getattr(run, field).tobytes() == getattr(dense, field)[50_000:].tobytes()
    assert set(run.to_xarray().variables) == {"t", "x", "theta", "coil"}
    with pytest.raises(AttributeError, match=r"did not record z: set record\.fields to name it"):
        _ = run.z
    # The motion is the same, whatever is recorded of it.
    assert repr(run.summary()) == repr(dense.summary())


@pytest.mark.parametrize("name", ["run.nc", "run.csv"])
def test_events_are_recorded_from_a_time_on(tmp_path, name):
    scenario = COARSE.replace({"record.rate": "events"})
    every = simulate(scenario)
    some = simulate(scenario.replace({"record.from": 0.1}), out=tmp_path / name)
    later = every.t >= 0.1
    assert 0 < later.sum() < len(later)
    assert_same_record(some, every, later)
    none = simulate(scenario.replace({"record.from": 0.17}), out=tmp_path / name)
    assert len(none.event) == 0
    assert none.current.shape == (0, 5)
    assert np.isnan(open_run(tmp_path / name).recorded_until)


@pytest.mark.parametrize("name", ["run.nc", "run.csv"])
def test_what_was_recorded_before_an_interrupt_is_kept_and_marked(tmp_path, name):
    def interrupt(fraction, stage):
        raise KeyboardInterrupt

    path = tmp_path / name
    path.write_text("older")
    scenario = ENDLESS.replace({"record.fields": ["x", "theta", "contact"]})
    with pytest.raises(KeyboardInterrupt, match=r"run\.\w+ has the record up to [\d.]+ s"):
        simulate(scenario, out=path, progress=interrupt)
    run = open_run(path)
    assert (run.status, run.complete, run.ok) == ("interrupted", False, False)
    assert run.message.endswith("the run was stopped")
    assert run.recorded_until == run.t[-1] > 0.0
    # Where the run was stopped within a step, the step's other samples are not recorded.
    assert 0.0 <= run.summary()["simulated_time"] - run.recorded_until < 0.01
    # What there is are the bits of a shorter run.
    pulses = int(run.recorded_until * 100.0) + 1
    shorter = simulate(scenario.replace({"drive.pulses": max(pulses, 4)}))
    for field in ("t", "x", "theta", "contact"):
        assert getattr(run, field).tobytes() == getattr(shorter, field)[: len(run.t)].tobytes()
    files = {path.name, f"{name}.json"} if name.endswith("csv") else {path.name}
    assert {each.name for each in tmp_path.iterdir()} == files


def test_an_error_of_the_caller_passes_and_keeps_the_record(tmp_path):
    def stop(fraction, stage):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        simulate(ENDLESS, out=tmp_path / "run.nc", progress=stop)
    assert open_run(tmp_path / "run.nc").status == "interrupted"
    late = ENDLESS.replace({"record.from": 9000.0})
    with pytest.raises(LookupError, match="enough"):
        simulate(late, out=tmp_path / "none.nc", progress=stop)
    assert [each.name for each in tmp_path.iterdir()] == ["run.nc"]  # nothing was recorded


def test_an_interrupted_command_says_what_it_kept(tmp_path):
    ENDLESS.to_toml(tmp_path / "scenario.toml")
    out = tmp_path / "out"
    out.mkdir()
    command = [*COMMAND, "run", tmp_path / "scenario.toml", "--out", out / "run.nc"]
    process = subprocess.Popen(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    limit = time.monotonic() + 60.0
    while not any(each.stat().st_size > 1 << 20 for each in out.iterdir()):
        assert time.monotonic() < limit
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    printed, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert printed == ""
    last = said.replace("\r", "\n").strip().splitlines()[-1]
    run = open_run(out / "run.nc")
    assert last.startswith("stickslip: interrupted at ")
    assert last.endswith(f"run.nc has the record up to {run.recorded_until:.6g} s")
    assert len(run.t) >= BLOCK
    assert [each.name for each in out.iterdir()] == ["run.nc"]


def test_a_run_that_leaves_has_the_velocity_of_the_pulses_that_were_finished(tmp_path):
    # Down a slope to the coils, some 0.15 s; the record shows how far each pulse took it.
    scenario = Scenario(
        contact=Contact(static_friction=0.0, kinetic_friction=0.0),
        drag=Drag(linear=0.0),
        effects={"surface_tilt": {"angle": 1.4}},
        record=Record(rate=1000.0),
    )
    run = simulate(scenario, out=tmp_path / "run.nc")
    assert (run.status, run.complete) == ("left_workspace", False)
    assert np.isnan(run.mean_velocity)
    summary = run.summary()
    finished = summary["finished_pulses"]
    # From the end of the third pulse at 80 ms, 10 ms each.
    assert finished == int((summary["simulated_time"] - 0.08) / 0.01) > 3
    velocity = (run.x[80 + 10 * finished] - run.x[80]) / (0.01 * finished)
    assert summary["finished_velocity"] == pytest.approx(velocity, rel=1e-9)
    (note,) = [note for note in run.notes if "measuring window" in note]
    assert f"after {finished} of the 97 pulses of the measuring window" in note
    assert f"{velocity * 1e3:.5g} mm/s" in note
    again = open_run(tmp_path / "run.nc")
    assert repr(again.summary()) == repr(summary)
    assert json.loads(xarray.open_dataset(tmp_path / "run.nc").attrs["notes"]) == run.notes


def test_a_run_to_its_end_has_finished_all_pulses(dense):
    summary = dense.summary()
    assert summary["finished_pulses"] == 9
    assert summary["finished_velocity"] == dense.mean_velocity
    half = simulate(COARSE, until="time >= 0.123")
    # The window of a run that is ended by its condition ends there, within the fifth pulse.
    assert half.summary()["finished_pulses"] == 4
    program = Scenario(drive=Drive(mode="program", program=Waveform.hold(0.02, {"xp": 5.0})))
    assert simulate(program).summary()["finished_pulses"] == 0


# Room for one block of 65 536 samples of 169 bytes and a margin, not for two.
@pytest.mark.parametrize(("limit", "samples"), [(12_500_000, BLOCK), (100_000, 0)])
def test_where_the_disk_is_full_the_summary_is_printed_and_the_record_kept(
    tmp_path, limit, samples
):
    whole = simulate(DENSE.replace({"drive.pulses": 20}))
    whole.scenario.to_toml(tmp_path / "scenario.toml")
    out = tmp_path / "out"
    out.mkdir()
    path = out / "run.nc"

    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = stickslip_process(
        "run", tmp_path / "scenario.toml", "--out", path, "--json", preexec_fn=limited
    )
    assert done.returncode == 1
    printed = json.loads(done.stdout)
    assert printed["mean_velocity"] == whole.mean_velocity
    kept = f"; it has the record up to {whole.t[samples - 1]:.6g} s" if samples else ""
    assert done.stderr == f"stickslip: cannot write {path}: File too large{kept}\n"
    assert [each.name for each in out.iterdir()] == (["run.nc"] if samples else [])
    if samples:
        run = open_run(path)
        assert (run.status, run.complete) == ("ok", False)
        assert run.notes == printed["notes"]
        assert "the record ends at 0.13107 s" in run.notes[0]
        assert_same_record(run, whole, slice(samples))


def test_memory_does_not_grow_with_the_record(tmp_path):
    code = (
        "import resource, sys\n"
        "from stickslip import *\n"
        "scenario = load(sys.argv[1])\n"
        "for pulses in (12, 48):\n"
        "    run = simulate(scenario.replace({'drive.pulses': pulses}), out=sys.argv[2])\n"
        "    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)\n"
    )
    DENSE.to_toml(tmp_path / "scenario.toml")
    arguments = [sys.executable, "-c", code, tmp_path / "scenario.toml", tmp_path / "run.nc"]
    done = subprocess.run(list(map(str, arguments)), capture_output=True, text=True, check=True)
    short, long = map(int, done.stdout.split())  # KiB
    # 0.36 s at 500 kHz are 180 000 samples more, which would be 30 MB.
    assert long - short < 12_000


def test_a_record_of_any_length_has_to_go_into_a_file(tmp_path):
    with pytest.raises(ScenarioError) as refusal:
        simulate(ENDLESS)
    assert "\n" not in str(refusal.value)
    for word in ("record.rate = 50000.0", "1e7 samples in memory", "--out"):
        assert word in str(refusal.value)
    with pytest.raises(ScenarioError, match=r'record\.rate = "none": allowed with out'):
        simulate(COARSE.replace({"record.rate": "none"}), out=tmp_path / "run.nc")
    with pytest.raises(ValueError, match=r"run\.txt: allowed are names that end in"):
        simulate(COARSE, out=tmp_path / "run.txt")
    with pytest.raises(OSError, match="there is no folder"):
        simulate(COARSE, out=tmp_path / "missing" / "run.nc")
    assert list(tmp_path.iterdir()) == []


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
    lines = path.read_text().splitlines(keepends=True)
    opened = open_run(path)
    path.write_text("".join(lines[:-1]))
    assert "has 340 samples, but run.csv.json is of a record of 341" in refusal_of(path)
    with pytest.raises(ScenarioError, match="has changed since this run was opened"):
        _ = opened.x
    path.write_text("".join([lines[0].replace("x (m)", "x (mm)"), *lines[1:]]))
    assert "it has no x" in refusal_of(path)
    path.write_text("".join([*lines[:-1], lines[-1].replace("corner", "edge")]))
    with pytest.raises(ScenarioError, match="its columns of contact cannot be read"):
        _ = open_run(path).contact
    about = side.read_text()
    for text in ("", "[]", "{}", about.replace('"stickslip_run": 1', '"stickslip_run": 2')):
        side.write_text(text)
        assert "run.csv.json beside it is no file of a run" in refusal_of(path)
    side.unlink()
    assert "run.csv.json is missing beside it" in refusal_of(path)


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


def test_a_picture_needs_all_that_it_draws(tmp_path):
    COARSE.to_toml(tmp_path / "scenario.toml")
    run = ["run", tmp_path / "scenario.toml", "--out", tmp_path / "run.nc"]
    done = stickslip(*run, "--plot", tmp_path / "run.png", "--set", "record.fields=x,theta")
    assert done.returncode == 2
    assert 'stickslip: --plot: record.fields = "x, theta"' in done.stderr
    assert "also t, z, omega" not in done.stderr  # t is always there
    assert "z, omega, normal_force" in done.stderr
    done = stickslip(*run, "--plot", tmp_path / "run.png", "--set", "record.from=0.05")
    assert done.returncode == 0
    assert (tmp_path / "run.png").stat().st_size > 0
