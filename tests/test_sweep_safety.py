"""What a sweep's file stands: damage, other programs, two sweeps at once, a kill at any time."""

import hashlib
import subprocess
import sys

import h5py
import numpy as np
import pytest
import xarray

from command_line import stickslip
from stickslip import ScenarioError, open_run, simulate, sweep
from stickslip.cli.sweep_command import command
from stickslip.sweeping import checkpoint
from stickslip.sweeping.results import Results
from test_sweep_files import FRICTION, QUICK, assert_refused


def without_hdf5(monkeypatch):
    """From here on no file is opened by HDF5, which may never come back from a damaged one."""

    def opened(*_):
        pytest.fail("HDF5 was given the file")

    monkeypatch.setattr("stickslip.sweeping.checkpoint.h5netcdf.File", opened)


def test_a_damaged_file_is_refused_before_hdf5_sees_it(tmp_path, monkeypatch):
    path = tmp_path / "a.nc"
    sweep(QUICK, FRICTION, out=path)
    whole = path.read_bytes()
    without_hdf5(monkeypatch)
    for place in np.linspace(0, len(whole) - 1, 60).astype(int):
        damaged = bytearray(whole)
        damaged[place] ^= 1
        path.write_bytes(damaged)
        assert_refused(path, QUICK, FRICTION, "checksum")
    inverted = bytes(255 - each for each in whole[9000:9500])
    path.write_bytes(whole[:9000] + inverted + whole[9500:])
    assert_refused(path, QUICK, FRICTION, "its checksum does not match: it is damaged")


def test_the_checksum_is_that_of_all_bytes_before_it(tmp_path):
    sweep(QUICK, FRICTION, out=tmp_path / "a.nc")
    data, _, line = (tmp_path / "a.nc").read_bytes().rpartition(b"\nstickslip sha256 ")
    assert line.decode() == hashlib.sha256(data).hexdigest() + "\n"


def test_other_programs_read_the_file_and_what_they_write_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "a.nc"
    data = sweep(QUICK, FRICTION, out=path)
    with h5py.File(path, "r") as file:
        np.testing.assert_array_equal(file["mean_velocity"], data["mean_velocity"])
    with h5py.File(path, "r+") as file:
        file.attrs["vary"] = file.attrs["vary"].replace("0.3", "0.4")
        file["mean_velocity"][0] = 1.0
    with h5py.File(path, "r") as file:
        assert file["mean_velocity"][0] == 1.0
    changed = path.read_bytes()
    data.to_netcdf(path, engine="h5netcdf")
    without_hdf5(monkeypatch)
    assert_refused(path, QUICK, FRICTION, "rewritten by another program")
    path.write_bytes(changed)
    assert_refused(path, QUICK, FRICTION, "checksum")


def test_a_run_that_is_damaged_is_refused(tmp_path):
    simulate(QUICK.replace({"record.rate": 1e3})).save(tmp_path / "a.nc")
    data = bytearray((tmp_path / "a.nc").read_bytes())
    data[len(data) // 2] ^= 1
    (tmp_path / "a.nc").write_bytes(data)
    with pytest.raises(ScenarioError, match=r"a\.nc: its checksum does not match"):
        open_run(tmp_path / "a.nc")


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
    with xarray.open_dataset(path, engine="h5netcdf") as stored:
        xarray.testing.assert_identical(stored.load(), data)


def test_another_process_is_refused_until_the_first_is_killed(tmp_path):
    (tmp_path / "s.toml").write_text(QUICK.to_toml())
    options = ["s.toml", "--vary=contact.static_friction=0.3,0.2", "--out=a.nc"]
    code = (
        "from stickslip.sweeping.lock import file_lock\n"
        "with file_lock('a.nc'):\n print(flush=True); input()"
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
    """A clock of its own: reports 20 times a second, each with a new point, for 1000 s."""
    now, writes = 0.0, []

    def write(*_):
        nonlocal now
        writes.append(now)
        now += cost

    monkeypatch.setattr(checkpoint.time, "monotonic", lambda: now)
    monkeypatch.setattr(checkpoint, "write_netcdf", write)
    monkeypatch.setattr(checkpoint, "dataset", lambda *_: None)
    results = Results(100_000)
    kept = checkpoint.Checkpoint("a.nc", None, results)
    while now < 1000.0:
        now += 0.05
        results.finished += 1
        kept.write_if_due()
    assert writes[0] <= 0.55 + 1e-9
    assert cost * (len(writes) - 1) <= 0.03 * 1000.0
    # No rarer than that needs, or than once a second, and a report's delay.
    assert np.diff(writes).max() <= cost + max(1.0, cost / 0.03) + 0.05 + 1e-9


def test_an_interrupt_offers_resume_only_if_the_file_exists(tmp_path, monkeypatch, capsys):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("stickslip.cli.sweep_command.sweep_points", interrupted)
    (tmp_path / "s.toml").write_text(QUICK.to_toml())
    options = {"vary": ("drive.hold=0,1e-3",), "settings": (), "threads": None, "dask": None}
    options |= {"out": tmp_path / "a.nc", "resume": True, "as_json": False, "plot": None}
    for there, said in ((False, "nothing written"), (True, "--resume goes on with")):
        if there:
            (tmp_path / "a.nc").write_text("points")
        with pytest.raises(KeyboardInterrupt):
            command.callback(tmp_path / "s.toml", **options)
        assert said in capsys.readouterr().err
