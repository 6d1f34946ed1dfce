"""Points are divided into chunks, whose size follows their cost, and given to free workers."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, wait
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip.sweeping.executors import ChunkExecutor, is_worker_death
from stickslip.sweeping.points import Points
from stickslip.sweeping.results import Results
from stickslip.sweeping.worker import Chunk, ChunkResult

_TICK = 0.05
"""Longest time between two reports, s: some twenty a second, as `sweep` promises."""

_MAX_CHUNK_SECONDS = 1.0
"""Longest time that a chunk should take, s; chosen: results and progress come as often."""

_MOST_POINTS = 20_000
"""Points of the largest chunk, so that what is sent to a worker stays at some MB."""

_MAX_GROWTH = 8
"""How many times larger a chunk may be than the largest before, whose cost is all that is known of
it; chosen."""

_CHUNKS_PER_WORKER = 2
"""Chunks for each worker: the one that is simulated, and the next, so that no worker waits."""

_MAX_WORKER_DEATHS = 3
"""How often the workers of a chunk may die before the sweep gives up, as `sweep` promises."""


class _Job(NamedTuple):
    indices: NDArray[np.int64]
    attempt: int


class _ChunkSize:
    """How many points make a chunk: one at first, then by the cost of the points before."""

    def __init__(self) -> None:
        self._cost = 0.0  # s a point
        self._largest = 0

    def size(self, left: int, executor: ChunkExecutor) -> int:
        if self._largest == 0:
            return 1
        cost = max(self._cost, 1e-9)
        # Shrinking towards the end, so that all workers end at about the same time.
        fair = math.ceil(left / (2 * executor.size()))
        worthwhile = math.ceil(executor.min_chunk_seconds / cost)
        longest = int(_MAX_CHUNK_SECONDS / cost)
        points = min(longest, max(fair, worthwhile), _MAX_GROWTH * self._largest, _MOST_POINTS)
        return max(points, 1)

    def measured(self, points: int, seconds: float) -> None:
        cost = seconds / points
        self._cost = cost if self._largest == 0 else 0.5 * (self._cost + cost)
        self._largest = max(self._largest, points)


def compute(
    points: Points, results: Results, executor: ChunkExecutor, report: Callable[[], object]
) -> None:
    """Simulate all points that `results` has not, and put them there.

    Which worker simulates a point, and together with which others, has no influence on its result.
    `report` is called some twenty times a second; what it raises stops the work, and so does what a
    worker raises, or one that dies again and again with the same chunk. `results` then holds all
    that was done before.
    """
    queue = deque([_Job(_shuffled(results.pending()), 0)])
    left = len(queue[0].indices)
    chunk_size = _ChunkSize()
    running: dict[Future[ChunkResult], _Job] = {}
    try:
        report()
        while left or running:
            while left and len(running) < _CHUNKS_PER_WORKER * executor.size():
                job = _next_job(queue, chunk_size.size(left, executor))
                left -= len(job.indices)
                rows = points.rows(job.indices)
                chunk = Chunk(points.scenario, points.keys, rows, _core.__version__, job.attempt)
                running[executor.submit(chunk)] = job
            finished, _ = wait(running, timeout=_TICK, return_when=FIRST_COMPLETED)
            for future in finished:
                again = _collect(future, running.pop(future), results, chunk_size)
                queue.appendleft(again)
                left += len(again.indices)
            report()
    except BaseException:
        for future in running:
            future.cancel()
        executor.close()
        for future, job in running.items():
            if future.done() and not future.cancelled() and future.exception() is None:
                _put(future.result(), job, results)
        raise
    executor.close()


def _shuffled(indices: NDArray[np.int64]) -> NDArray[np.int64]:
    """The same points in an order in which each stretch is a representative sample of all.

    Along a grid the cost of a point can change a hundredfold. In this order the cost of the points
    so far predicts that of the rest, and chunks of equal size take about equally long.
    """
    count = len(indices)
    # Steps of the golden section spread evenly; without a common divisor they meet every point.
    step = max(1, round(count * 0.5 * (math.sqrt(5.0) - 1.0)))
    while math.gcd(step, count) > 1:
        step += 1
    return indices[np.arange(count) * step % max(count, 1)]


def _next_job(queue: deque[_Job], size: int) -> _Job:
    """Up to `size` points from the front of the queue."""
    job = queue.popleft()
    while not len(job.indices):
        job = queue.popleft()
    if len(job.indices) > size:
        queue.appendleft(job._replace(indices=job.indices[size:]))
    return job._replace(indices=job.indices[:size])


def _collect(
    future: Future[ChunkResult], job: _Job, results: Results, chunk_size: _ChunkSize
) -> _Job:
    """Store a chunk's results; return the points of it that remain to be simulated."""
    try:
        part = future.result()
    except Exception as error:
        if not is_worker_death(error):
            raise
        if job.attempt == _MAX_WORKER_DEATHS:
            raise RuntimeError(
                f"workers died {job.attempt + 1} times with the same points: {error}"
            ) from error
        return job._replace(attempt=job.attempt + 1)
    done = _put(part, job, results)
    chunk_size.measured(done, part.seconds)
    return job._replace(indices=job.indices[done:])


def _put(part: ChunkResult, job: _Job, results: Results) -> int:
    done = len(part.columns["status"])
    results.put(job.indices[:done], part)
    return done
