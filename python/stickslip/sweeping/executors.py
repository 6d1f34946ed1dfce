"""Where chunks are simulated: in threads of this process, or by an executor of the user's."""

from __future__ import annotations

import importlib
import threading
import time
from concurrent.futures import (
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
)
from typing import Any

from stickslip.sweeping.worker import Chunk, ChunkResult, run_chunk

_SIZE_IF_UNKNOWN = 16
"""Workers of an executor that does not say; if it has fewer, chunks wait, which costs little."""

_RECOUNT_SECONDS = 5.0
"""Time after which the size of an executor, which may grow, is asked again, s; chosen."""

# Errors of Dask, which is not imported for this: the worker died, or the cluster lost the work.
_WORKER_DEATHS = ("KilledWorker", "FutureCancelledError", "FuturesCancelledError")


class LocalThreads:
    """Threads of this process; the core does not hold Python's lock while it simulates."""

    min_chunk_seconds = 2e-3
    """Time below which sending a chunk to a worker costs too much beside its simulation, s."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._stop = threading.Event()
        self._executor = ThreadPoolExecutor(count, thread_name_prefix="stickslip-sweep")

    def size(self) -> int:
        """How many chunks are worked on at a time."""
        return self._count

    def submit(self, chunk: Chunk) -> Future[ChunkResult]:
        """Begin with a chunk as soon as there is room."""
        return self._executor.submit(run_chunk, chunk, self._poll)

    def close(self) -> None:
        """Stop what can be stopped, and wait until it has ended."""
        self._stop.set()
        self._executor.shutdown(wait=True, cancel_futures=True)

    def _poll(self, simulated: float) -> None:
        if self._stop.is_set():
            raise CancelledError


class OutsideExecutor:
    """The workers of an executor, which stays open; used as `LocalThreads` are.

    A pool of processes that is broken by the death of one of them takes no more work; a new pool
    then takes its place until the sweep ends.
    """

    min_chunk_seconds = 20e-3

    def __init__(self, executor: Executor, workers: int | None) -> None:
        self._executor = executor
        self._workers = workers
        self._replacement: Executor | None = None
        self._size = workers or size_of(executor)
        self._counted = time.monotonic()

    def size(self) -> int:
        if self._workers is None and time.monotonic() - self._counted > _RECOUNT_SECONDS:
            self._size = size_of(self._executor)
            self._counted = time.monotonic()
        return self._size

    def submit(self, chunk: Chunk) -> Future[ChunkResult]:
        try:
            return self._executor.submit(run_chunk, chunk)
        except BrokenExecutor:
            self.close()
            self._executor = self._replacement = _new_pool_like(self._executor, self._size)
            return self._executor.submit(run_chunk, chunk)

    def close(self) -> None:
        if self._replacement is not None:
            self._replacement.shutdown(wait=True)


ChunkExecutor = LocalThreads | OutsideExecutor


def is_worker_death(error: BaseException) -> bool:
    """Whether this error of a chunk says that its worker died, so that it can be tried again."""
    return (
        isinstance(error, BrokenExecutor | CancelledError)
        or type(error).__name__ in _WORKER_DEATHS
    )  # fmt: skip


def size_of(executor: Executor) -> int:
    """How many workers an executor has: one of Python, loky, MPI or Dask; others do not say."""
    client = getattr(executor, "_client", None)
    if client is not None:
        threads: dict[str, int] = client.nthreads()
        return max(1, sum(threads.values()))
    size: int | None = getattr(executor, "_max_workers", None)
    return size or getattr(executor, "num_workers", None) or _SIZE_IF_UNKNOWN


def _new_pool_like(broken: Any, size: int) -> Executor:
    if type(broken).__module__.startswith("loky"):
        pool: Executor = importlib.import_module("loky").ProcessPoolExecutor(size)
        return pool
    return ProcessPoolExecutor(
        size,
        mp_context=getattr(broken, "_mp_context", None),
        initializer=getattr(broken, "_initializer", None),
        initargs=getattr(broken, "_initargs", ()),
    )
