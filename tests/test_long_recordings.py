"""Records that go into a file while a run is simulated."""

import json
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray

from command_line import COMMAND, stickslip, stickslip_process
from own_effects import unregister
from recorded_runs import COARSE, DENSE, ENDLESS, assert_same_record
from stickslip import (
    EffectParameter,
    ScenarioError,
    open_run,
    register_effect,
    simulate,
)
from stickslip.simulation.record_blocks import BLOCK
from stickslip.simulation.simulate import MOST_IN_MEMORY


@pytest.fixture(scope="module")
def dense():
    run = simulate(DENSE)
    assert BLOCK < len(run.t) < 2 * BLOCK
    return run


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


def test_an_effect_that_fails_keeps_the_record(tmp_path):
    calls = []

    def failing(state, parameters):
        calls.append(1)
        if len(calls) > 2000:
            raise LookupError("broken")
        return 0.0, 0.0, 0.0

    parameter = EffectParameter(name="k", unit="-", low=-1.0, high=1.0, meaning="of a test")
    register_effect("own", failing, [parameter], meaning="an effect of a test")
    try:
        scenario = COARSE.replace({"own.k": 0.5})
        with pytest.raises(LookupError, match="broken"):
            simulate(scenario, out=tmp_path / "run.nc")
        run = open_run(tmp_path / "run.nc")
    finally:
        unregister("own")
    assert (run.status, run.complete) == ("interrupted", False)
    assert run.message == "the run was stopped by LookupError: broken"
    assert 0 < len(run.t) < 341


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
    for _ in range(2):  # the second, of someone in a hurry, must not undo what the first keeps
        process.send_signal(signal.SIGINT)
        time.sleep(0.05)
    printed, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert printed == ""
    last = said.replace("\r", "\n").strip().splitlines()[-1]
    run = open_run(out / "run.nc")
    assert last.startswith("stickslip: interrupted at ")
    assert last.endswith(f"run.nc has the record up to {run.recorded_until:.6g} s")
    assert len(run.t) >= BLOCK
    assert [each.name for each in out.iterdir()] == ["run.nc"]


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
    done = stickslip_process(
        "run", tmp_path / "scenario.toml", "--out", path, "--json", largest_file=limit
    )
    assert done.returncode == 1
    printed = json.loads(done.stdout)
    assert printed["mean_velocity"] == whole.mean_velocity
    kept = f"; it has the record up to {whole.t[samples - 1]:.6g} s" if samples else ""
    # A slow machine shows a progress bar before.
    assert done.stderr.endswith(f"stickslip: cannot write {path}: File too large{kept}\n")
    assert [each.name for each in out.iterdir()] == (["run.nc"] if samples else [])
    if samples:
        run = open_run(path)
        assert (run.status, run.complete) == ("ok", False)
        assert run.summary()["notes"] == printed["notes"]
        assert "the record ends at 0.13107 s" in run.notes[0].text
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
    for word in ("record.rate = 50000.0", f"{MOST_IN_MEMORY} samples in memory", "--out"):
        assert word in str(refusal.value)
    with pytest.raises(ScenarioError, match=r'record\.rate = "none": allowed with out'):
        simulate(COARSE.replace({"record.rate": "none"}), out=tmp_path / "run.nc")
    with pytest.raises(ValueError, match=r"run\.txt: allowed are names that end in"):
        simulate(COARSE, out=tmp_path / "run.txt")
    with pytest.raises(OSError, match="there is no folder"):
        simulate(COARSE, out=tmp_path / "missing" / "run.nc")
    assert list(tmp_path.iterdir()) == []


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
