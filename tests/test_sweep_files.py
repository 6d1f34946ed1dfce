"""The file of a sweep: whole at any time, of one sweep, resumed without repeating a point."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import h5netcdf
import numpy as np
import pytest
import xarray

from command_line import files_up_to, stickslip
from stickslip import Drive, JointPrior, Scenario, ScenarioError, predict, sweep
from stickslip.sweeping import checkpoint, run_sweep

# Some 2 to 20 ms a point.
SLOW = Scenario(drive=Drive(base=0.5e-3, pulses=4)).replace({"solver.max_step": 5e-6})
QUICK = SLOW.replace({"solver.max_step": 0.0})
VARY = {"drive.frequency": np.linspace(20.0, 200.0, 31), "contact.static_friction": [0.3, 0.1]}
FRICTION = {"contact.static_friction": [0.3, 0.1]}


@pytest.fixture(autouse=True)
def short_slabs(monkeypatch):
    monkeypatch.setattr(run_sweep, "_SECONDS", 0.1)
    monkeypatch.setattr(run_sweep, "_MOST", 8)  # however fast the machine is


class Counting(ThreadPoolExecutor):
    """Counts the points that were simulated."""

    points = 0

    def submit(self, function, /, scenario, keys, rows, *how):
        self.points += len(rows)
        return super().submit(function, scenario, keys, rows, *how)


def finished_points(path):
    with h5netcdf.File(path, "r") as file:
        return int(file.attrs["finished_points"])


def begin(path, scenario=SLOW, vary=VARY, fraction=0.2):
    """A sweep that is stopped in its midst."""

    def stop(done, stage):
        if done > fraction:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as interrupt:
        sweep(scenario, vary, threads=1, out=path, progress=stop)
    assert f"{path} has {finished_points(path)} of" in str(interrupt.value)


def assert_resumes(path, expected, scenario=SLOW, vary=VARY):
    """The sweep is completed, and the points of the file are not simulated again."""
    before = finished_points(path)
    assert 0 < before < expected["status"].size
    with Counting(2) as executor:
        data = sweep(scenario, vary, executor=executor, out=path, resume=True)
        assert executor.points == expected["status"].size - before
    xarray.testing.assert_identical(data, expected)
    xarray.testing.assert_identical(xarray.load_dataset(path), expected)


@pytest.fixture(scope="module")
def expected():
    return sweep(SLOW, VARY)


def test_a_file_holds_the_dataset_and_does_not_depend_on_who_wrote_it(tmp_path):
    for name, threads in {"a.nc": 1, "b.nc": 2}.items():
        data = sweep(QUICK, VARY, out=tmp_path / name, threads=threads)
        xarray.testing.assert_identical(xarray.load_dataset(tmp_path / name), data)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.nc", "b.nc"]


def test_an_interrupt_keeps_what_was_done(tmp_path, expected):
    begin(tmp_path / "a.nc")
    stored = xarray.load_dataset(tmp_path / "a.nc")
    names = stored["status"].attrs["flag_meanings"].split()
    codes = dict(zip(names, stored["status"].attrs["flag_values"], strict=True))
    not_run = (stored["status"] == codes["not_run"]).values
    assert np.isnan(stored["mean_velocity"].values[not_run]).all()
    assert not_run.sum() == 62 - finished_points(tmp_path / "a.nc")
    assert_resumes(tmp_path / "a.nc", expected)


def test_an_interrupt_from_the_keyboard_ends_a_slab(tmp_path):
    endless = QUICK.replace({"solver.max_step": 1e-7, "drive.pulses": 5_000})
    calls = []

    def interrupt(fraction, stage):
        calls.append(fraction)
        if len(calls) == 3:  # the core works
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        sweep(endless, FRICTION, out=tmp_path / "a.nc", progress=interrupt)
    assert list(tmp_path.iterdir()) == []  # nothing was done


@pytest.mark.nightly
def test_a_killed_sweep_resumes(tmp_path):
    slower = SLOW.replace({"solver.max_step": 1e-6})
    many = {"drive.frequency": np.linspace(20.0, 200.0, 50), "contact.static_friction": [0.3, 0.1]}
    script = (
        "import numpy as np\n"
        "from stickslip import load, sweep\n"
        "from stickslip.sweeping import checkpoint, run_sweep\n"
        "run_sweep.MIN_INTERVAL = checkpoint.MIN_INTERVAL = 0.0\n"
        "checkpoint._MAX_SHARE, run_sweep._SECONDS = 1.0, 0.05\n"
        "vary = {'drive.frequency': np.linspace(20.0, 200.0, 50),"
        " 'contact.static_friction': [0.3, 0.1]}\n"
        "sweep(load('s.toml'), vary, threads=1, out='a.nc')\n"
    )
    slower.to_toml(tmp_path / "s.toml")
    process = subprocess.Popen([sys.executable, "-c", script], cwd=tmp_path)
    try:
        deadline = time.monotonic() + 60
        finished = 0
        while finished < 8:
            assert process.poll() is None, "the sweep ended too early"
            assert time.monotonic() < deadline
            time.sleep(0.02)
            with contextlib.suppress(FileNotFoundError):
                finished = finished_points(tmp_path / "a.nc")
    finally:
        process.kill()
        process.wait()
    assert_resumes(tmp_path / "a.nc", sweep(slower, many), slower, many)


def test_a_finished_file_is_read_and_left_alone(tmp_path):
    path = tmp_path / "a.nc"
    data = sweep(QUICK, VARY, out=path)
    path.chmod(0o444)
    before = os.stat(path)
    seen = []
    with Counting(1) as executor:
        again = sweep(
            *(QUICK, VARY),
            executor=executor,
            out=path,
            resume=True,
            progress=lambda *each: seen.append(each),
        )
        assert executor.points == 0
    xarray.testing.assert_identical(again, data)
    after = os.stat(path)
    assert (after.st_mtime_ns, after.st_ino) == (before.st_mtime_ns, before.st_ino)
    assert seen == [(1.0, "simulating")]


def test_predictions_resume_from_the_file_of_their_draws(tmp_path):
    path = tmp_path / "a.nc"
    prior = JointPrior({}, ("coil.resistance", "drag.linear"), ((0.25, 2.5e-7), (2.5e-7, 1e-12)))
    how = {"vary": FRICTION, "draws": 20, "uncertain": prior}
    whole = predict(SLOW, **how)

    def stop(done, stage):
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        predict(SLOW, **how, out=path, progress=stop, threads=1)
    before = finished_points(path)
    with Counting(2) as executor:
        found = predict(SLOW, **how, out=path, resume=True, executor=executor)
        assert executor.points == 40 - before < 40
    xarray.testing.assert_identical(found, whole)
    draws = xarray.load_dataset(path)
    assert draws["mean_velocity"].dims == ("contact_static_friction", "draw")
    assert draws["coil_resistance"].dims == ("draw",)
    np.testing.assert_array_equal(
        draws["mean_velocity"].median("draw"), whole["mean_velocity"][:, 1]
    )
    with pytest.raises(ScenarioError, match="another sweep"):
        predict(SLOW, **how, seed=1, out=path, resume=True)


def test_a_file_is_neither_overwritten_nor_changed_by_another_sweep(tmp_path):
    path = tmp_path / "a.nc"
    sweep(QUICK, FRICTION, out=path)
    before = path.read_bytes()
    with pytest.raises(FileExistsError, match=r"a\.nc already exists"):
        sweep(QUICK, FRICTION, out=path)
    with pytest.raises(
        ScenarioError, match=r"a\.nc cannot be resumed: it belongs to another sweep"
    ):
        sweep(QUICK, VARY, out=path, resume=True)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["a.nc"]


def test_a_full_disk_keeps_the_last_good_file(tmp_path, expected):
    path = tmp_path / "a.nc"
    begin(path)
    before = path.read_bytes()
    with files_up_to(10_000), pytest.raises(OSError, match=r"cannot write .*a\.nc: File too large"):
        sweep(SLOW, VARY, out=path, resume=True)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["a.nc"]
    assert_resumes(path, expected)


def test_a_file_has_one_sweep_at_a_time(tmp_path):
    path = tmp_path / "a.nc"
    (tmp_path / ".a.nc.lock").write_text("")  # what a killed sweep leaves
    (tmp_path / "link.nc").symlink_to("a.nc")
    refused = []

    def another(done, stage):
        for name, resume in (("a.nc", False), ("a.nc", True), ("link.nc", False)):
            with pytest.raises(ScenarioError, match=rf"{name}: another sweep is writing"):
                sweep(QUICK, {"drive.frequency": [30.0]}, out=tmp_path / name, resume=resume)
            refused.append(name)

    data = sweep(QUICK, FRICTION, out=path, progress=another)
    assert len(refused) >= 3
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.nc", "link.nc"]
    xarray.testing.assert_identical(xarray.load_dataset(path), data)


def test_another_process_is_refused_until_the_first_is_killed(tmp_path):
    QUICK.to_toml(tmp_path / "s.toml")
    options = ["s.toml", "--vary=contact.static_friction=0.3,0.2", "--out=a.nc"]
    code = (
        "from stickslip.sweeping.checkpoint import locked\n"
        "with locked('a.nc'):\n print(flush=True); input()"
    )
    holder = subprocess.Popen(
        [sys.executable, "-c", code], cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    try:
        holder.stdout.readline()
        done = stickslip("sweep", *options, cwd=tmp_path)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr == "stickslip: a.nc: another sweep is writing this file\n"
        assert not (tmp_path / "a.nc").exists()
    finally:
        holder.kill()
        holder.wait()
    assert stickslip("sweep", *options, cwd=tmp_path).returncode == 0
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.nc", "s.toml"]


@pytest.mark.parametrize("cost", [0.001, 0.05, 2.0])
def test_checkpoints_come_early_and_cost_little(monkeypatch, cost):
    """A clock of its own: slabs of a second for 1000 s, each with new points."""
    now, slab, writes = 0.0, 1.0, []

    def write(*_):
        nonlocal now
        writes.append(now)
        now += cost

    monkeypatch.setattr(checkpoint.time, "monotonic", lambda: now)
    monkeypatch.setattr(checkpoint, "write", write)
    due = checkpoint.MIN_INTERVAL
    while now < 1000.0:
        now += slab
        if now >= due:
            due = checkpoint.checkpoint(None, "a.nc")
    assert writes[0] <= 1.0 + slab
    assert cost * (len(writes) - 1) <= 0.03 * 1000.0
    # No rarer than that needs, or than once a second, and a slab's delay.
    assert np.diff(writes).max() <= cost + max(1.0, cost / 0.03) + slab + 1e-9
