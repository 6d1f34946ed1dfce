"""The function `stickslip.sweep`."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING

from stickslip._util.files import check_writable
from stickslip._util.numbers import worker_count
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Value, check_kind, shown
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.simulate import STAGE, Progress
from stickslip.sweeping.executors import ChunkExecutor, LocalThreads, OutsideExecutor
from stickslip.sweeping.lock import file_lock
from stickslip.sweeping.points import Points, as_list, from_changes, from_scenarios, grid
from stickslip.sweeping.results import Results
from stickslip.sweeping.scheduling import compute

if TYPE_CHECKING:
    from concurrent.futures import Executor

    import xarray

Vary = Mapping[str, Iterable[Value]] | Sequence[Mapping[str, Value]]
"""Values of each key for a grid, or changes of each point for a list."""


def sweep(
    scenario: Scenario | Iterable[Scenario],
    vary: Vary | None = None,
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
    scenario : Scenario or iterable of Scenario
        What the points have in common; or the points themselves, without `vary`. What it records
        is ignored: a sweep keeps summaries only.
    vary : mapping or sequence of mappings
        Values by dotted key: all combinations are simulated, in the order given, the last key
        fastest. Or a list with the changes of each point, as `Scenario.replace` takes them.
    threads : int, optional
        How many simulations go on at a time; as many as there are processors, if not given. With
        an `executor`, how many workers it has, where it does not say so itself.
    executor : concurrent.futures.Executor, optional
        Who simulates, in place of threads of this process: processes of Python or of loky, MPI
        (mpi4py), Dask (``Client.get_executor()``). It stays open. Points of a worker that dies are
        given to another, up to three times.
    out : path-like, optional
        netCDF file for the result. It is written after half a second, then every second or more,
        such that writing takes at most 3 % of the time, and when the sweep is stopped by an
        interrupt or an error; whole or not at all, with a checksum at its end.
    resume : bool
        Go on with the sweep whose file is `out`: points that it has are not simulated again. It is
        begun where there is no such file. A file that is complete is read and left alone.
    progress : callable, optional
        Called with the fraction of the points that is done, 0 to 1, and the stage, "simulating",
        some twenty times a second. What it raises stops the sweep and passes through.

    Returns
    -------
    xarray.Dataset
        A grid has a dimension for each key, with its values as coordinate; a list has the dimension
        ``point`` and its values along it. A key is named by its last word (``frequency``), with its
        section before it where other keys share that word (``surface_tilt_angle``).

        Variables are the numbers of `Run.summary` with their units, `events` (counts, with another
        dimension ``event``) and `painleve_events`. `mean_velocity` is along x
        and `mean_velocity_y` across it; where a pulsed drive moves a robot out of the plane y = 0,
        `velocity_along` and `velocity_across` are those along the heading of each point's drive and
        to its left (m/s), as `Run.velocity` has them. `status` is 0 for a point
        that is sound; its attributes name the others. There the numbers are NaN, and a variable
        `message` says what happened. Attributes hold scenario, values and versions.

    Raises
    ------
    ScenarioError
        If there is no point, a key is unknown, a value not allowed or twice on one axis; if
        `resume` meets a file that is not of this sweep, or not as it was written; or if another
        sweep is writing `out`, or the lock against that cannot be made beside it.
    ValueError
        If `threads` is not a whole number above zero, or `resume` comes without `out`.
    FileExistsError
        If `out` is there and `resume` is false.
    OSError
        If `out` cannot be written; the last file that could be is kept.
    RuntimeError
        If workers die again and again with the same points, or have another version of this
        package.
    KeyboardInterrupt
        On Ctrl-C, within a fraction of a second with threads; `out` then holds what was done.

    Examples
    --------
    >>> from stickslip import Drive, Scenario, sweep
    >>> base = Scenario(drive=Drive(base=0.5e-3, pulses=20))
    >>> data = sweep(base, {"drive.frequency": [30.0, 100.0], "drive.clamp": ["down", "up"]})
    >>> print(f"{data.mean_velocity.sel(frequency=100, drive_clamp='down').item() * 1e3:.2f} mm/s")
    1.91 mm/s
    """
    return sweep_points(points_of(scenario, vary), threads, executor, out, resume, progress)


def sweep_points(
    points: Points,
    threads: int | None,
    executor: Executor | None,
    out: str | PathLike[str] | None,
    resume: bool,
    progress: Progress | None,
) -> xarray.Dataset:
    """`sweep` of points that are known already."""
    from stickslip.sweeping.dataset import dataset

    count = worker_count(threads, "threads")
    if resume and out is None:
        raise ValueError("resume = True: allowed with a file `out` only, which it goes on with")
    with file_lock(out):
        results = _existing_results(points, out, resume)
        if not results.complete:
            workers: ChunkExecutor = (
                LocalThreads(count) if executor is None else OutsideExecutor(executor, threads)
            )
            _run(points, results, workers, out, progress)
        elif progress is not None:
            progress(1.0, STAGE)
    return dataset(points, results)


def simulated(points: Points, threads: int | None, progress: Progress | None) -> Results:
    """The results of points, which stay in memory."""
    results = Results(points.count)
    _run(points, results, LocalThreads(worker_count(threads, "threads")), None, progress)
    return results


def points_of(scenario: Scenario | Iterable[Scenario], vary: Vary | None) -> Points:
    """The points that `sweep` simulates."""
    if isinstance(scenario, Scenario):
        if isinstance(vary, Mapping):
            return grid(scenario, vary)
        rows = as_list("vary", vary, "values by key, or a list of changes by key")
        for place, row in enumerate(rows):
            if not isinstance(row, Mapping):
                raise ScenarioError(f"vary, point {place} = {shown(row)}: allowed is a mapping")
        return from_changes(scenario, rows)
    scenarios = as_list("scenario", scenario, "a Scenario or a list of them")
    for place, each in enumerate(scenarios):
        check_kind(f"scenario {place}", each, Scenario)
    if vary is not None:
        raise ScenarioError("vary: allowed with one scenario only, not with a list of them")
    return from_scenarios(scenarios)


def _existing_results(points: Points, out: str | PathLike[str] | None, resume: bool) -> Results:
    """The results that there are already."""
    results = Results(points.count)
    if out is None:
        return results
    if os.path.isfile(out):
        if not resume:
            raise FileExistsError(
                f"{out} is already there: resume it, remove it, or choose another name"
            )
        from stickslip.sweeping.checkpoint import read

        results = read(out, points)
    if not results.complete:
        check_writable(out)
    return results


def _run(
    points: Points,
    results: Results,
    workers: ChunkExecutor,
    out: str | PathLike[str] | None,
    progress: Progress | None,
) -> None:
    checkpoint = None
    if out is not None:
        from stickslip.sweeping.checkpoint import Checkpoint

        checkpoint = Checkpoint(out, points, results)

    def report() -> None:
        if checkpoint is not None:
            checkpoint.write_if_due()
        if progress is not None:
            progress(results.finished / points.count, STAGE)

    try:
        compute(points, results, workers, report)
    except BaseException:
        if checkpoint is not None and checkpoint.has_unsaved_results:
            # What stopped the sweep matters more than that this cannot be written either.
            with contextlib.suppress(OSError):
                checkpoint.write()
        raise
    if checkpoint is not None:
        checkpoint.write()
