"""Whoever simulates the points of a sweep, in whatever slabs, and whoever dies of it: same bits."""

import multiprocessing
import os
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest
import xarray

from stickslip import Drive, Scenario, sweep
from stickslip.sweeping import run_sweep

# Short steps, so that a point takes some 20 ms and a worker can be killed in the midst of it.
SLOW = Scenario(drive=Drive(base=0.5e-3, pulses=4)).replace({"solver.max_step": 5e-6})
VARY = {"drive.frequency": np.linspace(20.0, 200.0, 31), "drive.mode": ["IPP", "OPP"]}


@pytest.fixture(scope="module")
def expected():
    return sweep(SLOW, VARY, threads=1)


@pytest.fixture
def spawned():
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as executor:
        yield executor


def test_threads(expected):
    for threads in (2, 3):
        xarray.testing.assert_identical(sweep(SLOW, VARY, threads=threads), expected)


@pytest.mark.parametrize("seconds", [0.0, 0.05])
def test_any_slabs(expected, monkeypatch, seconds):
    sizes = []

    def counted(scenario, keys, rows, *how):
        sizes.append(len(rows))
        return simulate_slab(scenario, keys, rows, *how)

    simulate_slab = run_sweep.simulate_slab
    monkeypatch.setattr(run_sweep, "simulate_slab", counted)
    monkeypatch.setattr(run_sweep, "_SECONDS", seconds)
    monkeypatch.setattr(run_sweep, "_FEWEST", 1)
    xarray.testing.assert_identical(sweep(SLOW, VARY, threads=1), expected)
    assert sum(sizes) == expected["status"].size
    assert (len(sizes) == sum(sizes)) == (seconds == 0.0)


def test_spawned_processes_give_the_same_results(expected, spawned):
    xarray.testing.assert_identical(sweep(SLOW, VARY, executor=spawned), expected)
    again = sweep(SLOW, VARY, executor=spawned, threads=2)  # it stayed open
    xarray.testing.assert_identical(again, expected)


def test_a_process_that_dies_ends_the_sweep_which_goes_on_with_another(
    expected, spawned, tmp_path, monkeypatch
):
    submit, slabs = spawned.submit, []

    def dying(*work):
        """The fourth slab, given out once two are done, kills the process that takes it."""
        slabs.append(work)
        return submit(*work) if len(slabs) < 4 else submit(os._exit, 1)

    monkeypatch.setattr(run_sweep, "_WAITING", 2)
    monkeypatch.setattr(spawned, "submit", dying)
    with pytest.raises(BrokenExecutor):
        sweep(SLOW, VARY, executor=spawned, out=tmp_path / "a.nc")
    assert 0 < xarray.load_dataset(tmp_path / "a.nc").attrs["finished_points"] < 62
    data = sweep(SLOW, VARY, out=tmp_path / "a.nc", resume=True)
    xarray.testing.assert_identical(data, expected)


def test_an_error_of_a_worker_passes_through():
    class Failing(ThreadPoolExecutor):
        def submit(self, function, /, *arguments):
            return super().submit(int, "three")

    with Failing(1) as executor, pytest.raises(ValueError, match="three"):
        sweep(SLOW, VARY, executor=executor)


def test_a_worker_of_another_version_is_refused():
    class Newer(ThreadPoolExecutor):
        def submit(self, function, /, *arguments):
            return super().submit(function, *arguments[:-1], "9.9")

    with Newer(1) as executor, pytest.raises(RuntimeError, match=r"and this process 9\.9"):
        sweep(SLOW, VARY, executor=executor)
