"""Whoever simulates the points of a sweep, and whoever dies of it, the bits are the same."""

import multiprocessing
import os
import signal
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor

import distributed
import loky
import numpy as np
import pytest
import xarray

from stickslip import Drive, Scenario, sweep
from stickslip.sweeping import worker

# Short steps, so that a point takes some 20 ms and a worker can be killed in the midst of it.
SLOW = Scenario(drive=Drive(base=0.5e-3, pulses=4)).replace({"solver.max_step": 5e-6})
VARY = {"drive.frequency": np.linspace(20.0, 200.0, 31), "drive.mode": ["IPP", "OPP"]}


@pytest.fixture(scope="module")
def expected():
    return sweep(SLOW, VARY, threads=1)


def spawning(workers=2):
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


class Killer:
    """A progress callback that once, in the midst of the sweep, kills a process."""

    def __init__(self, processes):
        self.processes = processes
        self.killed = None

    def __call__(self, fraction, stage):
        if self.killed is None and 0.2 < fraction < 0.8:
            self.killed = next(iter(self.processes()))
            os.kill(self.killed, signal.SIGKILL)


def test_threads(expected):
    for threads in (2, 3):
        xarray.testing.assert_identical(sweep(SLOW, VARY, threads=threads), expected)


def test_any_chunks(expected, monkeypatch):
    monkeypatch.setattr(worker, "_POINTS_PER_CALL", 2)
    monkeypatch.setattr(worker, "_MAX_SECONDS", 0.0)  # every chunk ends early
    xarray.testing.assert_identical(sweep(SLOW, VARY, threads=2), expected)


def test_spawned_processes_give_the_same_results(expected):
    with spawning() as executor:
        xarray.testing.assert_identical(sweep(SLOW, VARY, executor=executor), expected)
        assert executor.submit(int, 3).result() == 3  # it stays open


def test_a_process_that_dies(expected):
    with spawning() as executor:
        killer = Killer(lambda: executor._processes)
        data = sweep(SLOW, VARY, executor=executor, progress=killer)
    assert killer.killed is not None
    xarray.testing.assert_identical(data, expected)


def test_workers_that_always_die():
    class Deadly(Executor):
        def submit(self, function, /, *arguments):
            future = Future()
            future.set_exception(type("KilledWorker", (Exception,), {})("gone"))
            return future

    with pytest.raises(RuntimeError, match="workers died 4 times with the same points: gone"):
        sweep(SLOW, VARY, executor=Deadly())


def test_an_error_of_a_worker_passes_through():
    class Failing(ThreadPoolExecutor):
        def submit(self, function, /, *arguments):
            return super().submit(int, "three")

    with Failing(1) as executor, pytest.raises(ValueError, match="three"):
        sweep(SLOW, VARY, executor=executor)


def test_a_worker_of_another_version_is_refused(monkeypatch):
    monkeypatch.setattr("stickslip.sweeping.scheduling._core", type("", (), {"__version__": "9.9"}))
    with pytest.raises(RuntimeError, match=r"and this process 9\.9"):
        sweep(SLOW, VARY)


def test_loky(expected):
    executor = loky.ProcessPoolExecutor(2)
    try:
        killer = Killer(lambda: executor._processes)
        data = sweep(SLOW, VARY, executor=executor, progress=killer)
    finally:
        executor.shutdown(kill_workers=True)
    assert killer.killed is not None
    xarray.testing.assert_identical(data, expected)


def test_dask_with_a_worker_that_is_killed(expected):
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        processes = list(client.run(os.getpid).values())
        assert len(processes) == 2
        killer = Killer(lambda: processes)
        data = sweep(SLOW, VARY, executor=client.get_executor(), progress=killer)
        assert killer.killed is not None
    xarray.testing.assert_identical(data, expected)
