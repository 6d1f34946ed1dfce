"""Each piece of work in a process of its own, which is ended when its time is over.

A process that hangs in the compiled core hears no signal of Python's, so nothing short of that will
do. It is a fork of this one, which has everything imported: some milliseconds.
"""

from __future__ import annotations

import json
import multiprocessing.connection
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

_PATIENCE = 3.0
"""Time in which a run has to hear an interrupt, s; it looks some twenty times a second."""

_MEMORY = 6 << 30
"""Of a child's address space, bytes: more is refused to it, rather than taken from the machine."""

_INTERRUPTED = 130


@dataclass
class Ended:
    """How a child came to its end.

    Attributes
    ----------
    how : str
        "done", "slow" (it took too long and was interrupted), "hang" (it did not hear the
        interrupt) or "crash" (a signal, or an exit without a result).
    result : object
        What the work returned, if done.
    code : int
        Exit status; negative for a signal.
    """

    how: str
    result: Any
    code: int
    seconds: float


@dataclass
class _Child:
    name: Any
    pid: int
    pipe: int
    begun: float
    text: bytes = b""
    interrupted: float = 0.0

    def fileno(self) -> int:
        return self.pipe


def run_all(
    work: Iterable[tuple[Any, Callable[[], Any]]], jobs: int, seconds: float, until: float
) -> Iterator[tuple[Any, Ended]]:
    """Names and ends, as they come, of all that was begun before `until` (monotonic, s)."""
    waiting = iter(work)
    running: list[_Child] = []
    more = True
    try:
        while more or running:
            while more and len(running) < jobs:
                item = next(waiting, None) if time.monotonic() < until else None
                if item is None:
                    more = False
                    break
                running.append(_begin(*item))
            for child in multiprocessing.connection.wait(running, timeout=0.2):
                assert isinstance(child, _Child)
                text = os.read(child.pipe, 1 << 16)
                child.text += text
                if not text:
                    running.remove(child)
                    yield child.name, _reaped(child)
            for child in running:
                _hurry(child, seconds)
    finally:
        for child in running:
            os.kill(child.pid, signal.SIGKILL)
            _reaped(child)


def _begin(name: Any, task: Callable[[], Any]) -> _Child:
    sys.stdout.flush()
    sys.stderr.flush()
    reading, writing = os.pipe()
    pid = os.fork()
    if pid:
        os.close(writing)
        return _Child(name, pid, reading, time.monotonic())
    code = 1
    try:
        os.close(reading)
        # A shell's background job inherits that interrupts are ignored.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, resource.RLIM_INFINITY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        result = task()
        with os.fdopen(writing, "w") as out:
            json.dump(result, out)
        code = 0
    except KeyboardInterrupt:
        code = _INTERRUPTED
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(code)


def _hurry(child: _Child, seconds: float) -> None:
    now = time.monotonic()
    if child.interrupted and now > child.interrupted + _PATIENCE:
        os.kill(child.pid, signal.SIGKILL)
    elif not child.interrupted and now > child.begun + seconds:
        child.interrupted = now
        os.kill(child.pid, signal.SIGINT)


def _reaped(child: _Child) -> Ended:
    os.close(child.pipe)
    _, status = os.waitpid(child.pid, 0)
    code = os.waitstatus_to_exitcode(status)
    seconds = time.monotonic() - child.begun
    if code == 0 and child.text:
        return Ended("done", json.loads(child.text), code, seconds)
    if child.interrupted:
        how = "hang" if code == -signal.SIGKILL else "slow"
        return Ended(how, None, code, seconds)
    return Ended("crash", None, code, seconds)
