"""The function `stickslip.sweep`, and the one loop over slabs that simulates its points."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip._util.arrays import Array, Indices, worker_count
from stickslip._util.files import NETCDF_SUFFIXES, check_suffix, check_writable
from stickslip._util.messages import check_kind
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.simulate import STAGE, Progress, check_progress
from stickslip.sweeping.checkpoint import MIN_INTERVAL, checkpoint, locked, take_over, write
from stickslip.sweeping.dataset import NOT_RUN, empty, finished, flat, put, things_of
from stickslip.sweeping.points import Points, Vary, points_of

if TYPE_CHECKING:
    import xarray

_SECONDS = 1.0
"""Time that a slab should take, s; chosen: a checkpoint waits for no more."""

_FEWEST, _LONGEST = 8, 10.0
"""Points of a slab for each thread of this process, so that few threads wait at its end, unless
these take longer, s. Both chosen."""

_MOST = 2000
"""Points of the largest slab; chosen: what is sent to a worker stays small."""

_GROWTH = 8
"""How many times larger a slab may be than the one before, whose cost is all that is known of it;
chosen."""

_WAITING = 1000
"""Slabs that an executor has at a time, of which it does not say how many it works on; chosen: more
than any cluster has workers."""

_TICK = 0.05
"""Time between two reports while an executor works, s."""


def sweep(
    scenario: Scenario,
    vary: Vary,
    *,
    threads: int | None = None,
    executor: Executor | None = None,
    out: str | PathLike[str] | None = None,
    resume: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """Simulate many variants of a scenario and keep the summary of each.

    Results are bit-identical for any executor and any number of workers, and those of `simulate`.
    A point that fails, or whose values make no scenario together, is a status, not an exception.

    Parameters
    ----------
    scenario : Scenario
        What the points have in common. A sweep keeps summaries. Of ``[record]`` only
        ``pull_share`` counts: it adds `pull_share`.
    vary : mapping, or sequence of mappings, or pandas.DataFrame
        Values by dotted key: all combinations are simulated, in the order given, the last key
        fastest. Or a list with the changes of each point, as `Scenario.replace` takes them; or a
        table with a row for each point and a column for each key.
    threads : int, optional
        How many simulations go on at a time; as many as there are processors, if not given. With
        an `executor`, on each of its workers, 1 if not given.
    executor : concurrent.futures.Executor, optional
        Who simulates, in place of this process: processes of Python, MPI (mpi4py), Dask
        (``Client.get_executor()``). It stays open. What it raises, such as BrokenExecutor where a
        worker died, ends the sweep; Dask gives the points of a dead worker to another by itself.
    out : path-like, optional
        netCDF file for the result. It is written every second or more rarely, such that writing
        takes at most 3 % of the time, and when the sweep ends, is interrupted or fails; whole or
        not at all.
    resume : bool
        Go on with the sweep whose file is `out`: points that it has are not simulated again. It is
        begun where there is no such file. A file that is complete is read and left alone.
    progress : callable, optional
        Called with the fraction of the points that is done, 0 to 1, and the stage, "simulating",
        some twenty times a second. What it raises stops the sweep and passes through.

    Returns
    -------
    xarray.Dataset
        A grid has a dimension for each key, with its values as coordinate, named by the whole key:
        ``drive_frequency``. A list has the dimension ``point`` and its values along it.

        Variables are the numbers of `Run.summary` with their units, `events` (counts, with another
        dimension ``event``) and `painleve_events`. `mean_velocity` is along x
        and `mean_velocity_y` across it; where a pulsed drive moves a robot out of the plane y = 0,
        `velocity_along` and `velocity_across` are those along the heading of each point's drive and
        to its left (m/s), as `Run.velocity` has them. `status` is 0 for a point
        that is sound; its attributes name the others. There the numbers are NaN, and a variable
        `message` says what happened. Attributes: `failed_points`, `finished_points`; as JSON
        `statuses`, how many points have which, `notes`, and `sweep`, the scenario (TOML), its
        voltages and map, the values of the keys, and the version.

    Raises
    ------
    ScenarioError
        If there is no point, a key is unknown, a value not allowed or twice on one axis; if
        `resume` meets a file that is not of this sweep; or if another sweep is writing `out`.
    ValueError
        If `threads` is not a whole number above zero, `resume` comes without `out`, or the name
        `out` does not end in ``.nc``, ``.nc4`` or ``.h5``.
    FileExistsError
        If `out` is there and `resume` is false.
    OSError
        If `out` cannot be written; the last file that could be is kept.
    RuntimeError
        If a worker has another version of this package.
    KeyboardInterrupt
        On Ctrl-C, within a fraction of a second; `out` then holds what was done, and the text says
        how much that is.

    Examples
    --------
    >>> from stickslip import Drive, Scenario, sweep
    >>> base = Scenario(drive=Drive(base=0.5e-3, pulses=20))
    >>> data = sweep(base, {"drive.frequency": [30.0, 100.0], "drive.clamp": ["down", "up"]})
    >>> speed = data.mean_velocity.sel(drive_frequency=100, drive_clamp="down")
    >>> print(f"{speed.item() * 1e3:.2f} mm/s")
    1.91 mm/s
    """
    points = points_of(scenario, vary)
    return sweep_points(points, threads, executor, out, resume, progress)


def sweep_points(
    points: Points,
    threads: int | None,
    executor: Executor | None,
    out: str | PathLike[str] | None,
    resume: bool,
    progress: Progress | None,
) -> xarray.Dataset:
    """`sweep` of points that are known already."""
    # An executor has workers of its own.
    count = worker_count(1 if executor is not None and threads is None else threads, "threads")
    if resume and out is None:
        raise ValueError("resume = True: allowed with a file `out` only, which it goes on with")
    if executor is not None:
        check_kind("executor", executor, Executor)
    check_progress(progress)
    if out is not None:
        check_suffix(out, NETCDF_SUFFIXES)
    with locked(out):
        data = empty(points)
        if out is not None and os.path.isfile(out):
            if not resume:
                raise FileExistsError(
                    f"{out} already exists: resume it, remove it, or choose another name"
                )
            take_over(out, data)
        if out is not None and NOT_RUN in data["status"].values:
            check_writable(out)
        before = np.count_nonzero(data["status"] == NOT_RUN)
        try:
            _simulate(points, data, executor, count, out, progress)
        except KeyboardInterrupt:
            done = np.count_nonzero(data["status"] != NOT_RUN)
            if out is None or not done:
                raise
            kept = f"{out} has {done} of {points.count} {things_of(points)}"
            raise KeyboardInterrupt(f"{kept}; resume=True, or --resume, goes on with it") from None
        finally:
            if out is not None and np.count_nonzero(data["status"] == NOT_RUN) < before:
                write(finished(data, points), out)
    return finished(data, points)


def simulate_slab(
    scenario: Scenario,
    keys: tuple[str, ...],
    rows: Array,
    threads: int,
    version: str,
    poll: Callable[[float], object] | None = None,
) -> tuple[dict[str, NDArray[Any]], dict[int, str], float]:
    """Columns and messages of some points, perhaps on another machine, and how long it took, s.

    `rows` has a row for each point and a column for each key, `version` is that of the package that
    asks. `poll` is called some twenty times a second; what it raises stops the work.
    """
    if version != _core.__version__:
        raise RuntimeError(
            f"a worker has stickslip {_core.__version__} and this process {version}: results need "
            "the same version everywhere"
        )
    start = time.perf_counter()
    columns, messages = _core.sweep(scenario.to_core(), keys, rows, threads, poll)
    return columns, messages, time.perf_counter() - start


def _simulate(
    points: Points,
    data: xarray.Dataset,
    executor: Executor | None,
    threads: int,
    out: str | PathLike[str] | None,
    progress: Progress | None,
) -> None:
    """Simulate all points that `data` has not, slab by slab, and put them there.

    Which points make a slab, and who simulates it, has no influence on results.
    """
    left = np.flatnonzero(flat(data, "status") == NOT_RUN)
    # Along a grid the cost of a point changes; in any order a slab tells what the next one costs.
    left = np.random.default_rng(0).permutation(left)
    done = points.count - len(left)

    def report(_: float = 0.0) -> None:
        if progress is not None:
            progress(done / points.count, STAGE)

    waiting, fewest = (1, _FEWEST * threads) if executor is None else (_WAITING, threads)
    size, due = threads, time.monotonic() + MIN_INTERVAL
    running: dict[Future[Any], Indices] = {}
    report()
    try:
        while len(left) or running:
            while len(left) and len(running) < waiting:
                indices, left = left[:size], left[size:]
                rows = points.rows(indices)
                slab = (points.scenario, points.keys, rows, threads, _core.__version__)
                if executor is None:
                    future: Future[Any] = Future()
                    future.set_result(simulate_slab(*slab, report))
                else:
                    future = executor.submit(simulate_slab, *slab)
                running[future] = indices
            for future in wait(running, _TICK, FIRST_COMPLETED).done:
                indices, (columns, messages, seconds) = running.pop(future), future.result()
                put(data, indices, columns, messages)
                done += len(indices)
                rate = len(indices) / max(seconds, 1e-9)
                asked = max(math.ceil(_SECONDS * rate), min(fewest, math.ceil(_LONGEST * rate)))
                size = max(threads, min(asked, _GROWTH * len(indices), _MOST))
            if out is not None and time.monotonic() >= due:
                due = checkpoint(finished(data, points), out)
            report()
    finally:
        for future in running:
            future.cancel()
