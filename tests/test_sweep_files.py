"""The file of a sweep: whole at any time, resumed without repeating a point, never overwritten."""

import contextlib
import os
import resource
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import h5netcdf
import numpy as np
import pytest
import xarray

from stickslip import Drive, Scenario, ScenarioError, Waveform, sweep

# Some 20 ms a point.
SLOW = Scenario(drive=Drive(base=0.5e-3, pulses=4)).replace({"solver.max_step": 5e-6})
QUICK = SLOW.replace({"solver.max_step": 0.0})
VARY = {"drive.frequency": np.linspace(20.0, 200.0, 31), "contact.static_friction": [0.3, 0.1]}


class Counting(ThreadPoolExecutor):
    """Counts the points that were simulated."""

    points = 0

    def submit(self, function, /, chunk):
        return super().submit(self._run, function, chunk)

    def _run(self, function, chunk):
        part = function(chunk)
        self.points += len(part.columns["status"])
        return part


def finished_points(path):
    with h5netcdf.File(path, "r") as file:
        return int(file.attrs["finished_points"])


def begin(path, scenario=SLOW, vary=VARY, fraction=0.4):
    """A sweep that is stopped in its midst."""

    def stop(done, stage):
        if done > fraction:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(scenario, vary, threads=1, out=path, progress=stop)


def assert_resumes(path, expected, scenario=SLOW, vary=VARY):
    """The sweep is completed, and the points of the file are not simulated again."""
    before = finished_points(path)
    with Counting(2) as executor:
        data = sweep(scenario, vary, executor=executor, out=path, resume=True)
        assert executor.points == expected["status"].size - before
    xarray.testing.assert_identical(data, expected)
    with xarray.open_dataset(path, engine="h5netcdf") as stored:
        xarray.testing.assert_identical(stored.load(), expected.load())


@pytest.fixture(scope="module")
def expected():
    return sweep(SLOW, VARY)


def test_a_file_holds_the_dataset(tmp_path):
    data = sweep(QUICK, VARY, out=tmp_path / "a.nc")
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as stored:
        xarray.testing.assert_identical(stored.load(), data)
    assert [each.name for each in tmp_path.iterdir()] == ["a.nc"]


def test_a_file_does_not_depend_on_who_wrote_it(tmp_path):
    sweep(QUICK, VARY, out=tmp_path / "a.nc", threads=1)
    sweep(QUICK, VARY, out=tmp_path / "b.nc", threads=2)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_an_interrupt_keeps_what_was_done(tmp_path, expected):
    begin(tmp_path / "a.nc")
    assert 0 < finished_points(tmp_path / "a.nc") < 62
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as stored:
        names = stored["status"].attrs["flag_meanings"].split()
        codes = dict(zip(names, stored["status"].attrs["flag_values"], strict=True))
        not_run = stored["status"] == codes["not_run"]
        assert np.isnan(stored["mean_velocity"].values[not_run.values]).all()
        assert int(not_run.sum()) == 62 - finished_points(tmp_path / "a.nc")
    assert_resumes(tmp_path / "a.nc", expected)


@pytest.mark.nightly
def test_a_killed_sweep_resumes(tmp_path):
    slower = SLOW.replace({"solver.max_step": 1e-6})
    # Runs that step together end together: enough of them that some end long after the first.
    many = {"drive.frequency": np.linspace(20.0, 200.0, 200), "contact.static_friction": [0.3, 0.1]}
    script = (
        "import numpy as np\n"
        "import stickslip.sweeping.checkpoint as checkpoint\n"
        "from stickslip import Scenario, sweep\n"
        "checkpoint._MIN_INTERVAL, checkpoint._MAX_SHARE = 0.05, 1.0\n"
        "scenario = Scenario.from_toml('s.toml')\n"
        "vary = {'drive.frequency': np.linspace(20.0, 200.0, 200),"
        " 'contact.static_friction': [0.3, 0.1]}\n"
        "sweep(scenario, vary, threads=1, out='a.nc')\n"
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
        process.send_signal(signal.SIGKILL)
    finally:
        process.kill()
        process.wait()
    assert 8 <= finished_points(tmp_path / "a.nc") < 400
    assert_resumes(tmp_path / "a.nc", sweep(slower, many), slower, many)


def test_a_finished_file_is_read_and_left_alone(tmp_path):
    data = sweep(QUICK, VARY, out=tmp_path / "a.nc")
    before = os.stat(tmp_path / "a.nc")
    seen = []
    with Counting(1) as executor:
        again = sweep(
            QUICK,
            VARY,
            executor=executor,
            out=tmp_path / "a.nc",
            resume=True,
            progress=lambda *each: seen.append(each),
        )
        assert executor.points == 0
    xarray.testing.assert_identical(again, data)
    after = os.stat(tmp_path / "a.nc")
    assert (after.st_mtime_ns, after.st_ino) == (before.st_mtime_ns, before.st_ino)
    assert seen == [(1.0, "simulating")]


def test_resuming_without_a_file_begins(tmp_path):
    data = sweep(QUICK, VARY, out=tmp_path / "a.nc", resume=True)
    assert data.attrs["finished_points"] == 62
    with pytest.raises(ValueError, match="resume"):
        sweep(QUICK, VARY, resume=True)


def test_lists_resume_too(tmp_path):
    rows = [{"drive.frequency": f} for f in np.linspace(20.0, 200.0, 40)]
    begin(tmp_path / "a.nc", vary=rows)
    assert_resumes(tmp_path / "a.nc", sweep(SLOW, rows), vary=rows)


PROGRAM = Scenario(drive=Drive(mode="program", program=Waveform.ipp(base=0.5e-3, pulses=2)))
FRICTION = {"contact.static_friction": [0.3, 0.1]}
OTHERS = {
    "scenario": (QUICK.replace({"drive.hold": 2e-3}), VARY, r"\[drive\] hold = 0.001 there"),
    "extension": (QUICK.replace({"effects.surface_tilt.angle": 0.1}), VARY, "extensions"),
    "values": (QUICK, {**VARY, "contact.static_friction": [0.3, 0.2]}, "contact.static_friction"),
    "order": (QUICK, dict(reversed(VARY.items())), "there, contact.static_friction, drive.freq"),
    "key": (QUICK, {**VARY, "drive.mode": ["IPP"]}, "drive.mode here"),
}


@pytest.mark.parametrize("name", OTHERS)
def test_the_file_of_another_sweep_is_refused(tmp_path, name):
    sweep(QUICK, VARY, out=tmp_path / "a.nc")
    scenario, vary, words = OTHERS[name]
    assert_refused(tmp_path / "a.nc", scenario, vary, words)


def assert_refused(path, scenario, vary, words):
    before = path.read_bytes()
    with pytest.raises(ScenarioError, match=f"a.nc cannot be resumed: .*{words}") as error:
        sweep(scenario, vary, out=path, resume=True)
    assert "\n" not in str(error.value)
    assert path.read_bytes() == before


def test_other_voltages_are_another_sweep(tmp_path):
    sweep(PROGRAM, FRICTION, out=tmp_path / "a.nc")
    other = PROGRAM.replace({"drive.program": 2 * PROGRAM.drive.program})
    assert_refused(tmp_path / "a.nc", other, FRICTION, "voltages")


def test_a_list_and_a_grid_are_other_sweeps(tmp_path):
    sweep(QUICK, FRICTION, out=tmp_path / "a.nc")
    rows = [{"contact.static_friction": value} for value in (0.3, 0.1)]
    assert_refused(tmp_path / "a.nc", QUICK, rows, "a list and a grid")


def test_the_file_of_another_version_is_refused(tmp_path, monkeypatch):
    sweep(QUICK, FRICTION, out=tmp_path / "a.nc")
    newer = type("", (), {"__version__": "9.9"})
    monkeypatch.setattr("stickslip.sweeping.checkpoint._core", newer)
    assert_refused(tmp_path / "a.nc", QUICK, FRICTION, r"stickslip .*, and this is 9\.9")


@pytest.mark.parametrize("damage", ["text", "empty", "cut", "run"])
def test_what_is_no_file_of_a_sweep_is_refused(tmp_path, damage):
    path = tmp_path / "a.nc"
    if damage == "run":
        from stickslip import simulate

        simulate(QUICK.replace({"record.rate": 1e3})).save(path)
    else:
        sweep(QUICK, FRICTION, out=path)
        whole = path.read_bytes()
        path.write_bytes({"text": b"a,b\n1,2\n", "empty": b"", "cut": whole[:9000]}[damage])
    assert_refused(path, QUICK, FRICTION, "not the file of a sweep")


def test_a_file_that_is_there_is_not_overwritten(tmp_path):
    (tmp_path / "a.nc").write_text("mine")
    with pytest.raises(FileExistsError, match=r"a\.nc is already there"):
        sweep(QUICK, FRICTION, out=tmp_path / "a.nc")
    assert (tmp_path / "a.nc").read_text() == "mine"
    for path, error in [(tmp_path, IsADirectoryError), (tmp_path / "no/a.nc", FileNotFoundError)]:
        with pytest.raises(error):
            sweep(QUICK, FRICTION, out=path)


def test_a_full_disk_keeps_the_last_good_file(tmp_path, expected):
    path = tmp_path / "a.nc"
    begin(path)
    before = path.read_bytes()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, limits[1]))
    try:
        with pytest.raises(OSError, match=r"cannot write .*a\.nc: File too large"):
            sweep(SLOW, VARY, out=path, resume=True)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["a.nc"]
    assert_resumes(path, expected)
