"""Ctrl-C where one more would undo what the first has left to do."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from typing import Any


@contextlib.contextmanager
def one_interrupt() -> Iterator[Callable[[], object]]:
    """A block in which only the first Ctrl-C acts; none does after a call of what it gives."""
    before = signal.getsignal(signal.SIGINT)
    # Signals go to the main thread, and only there can it be said who takes them.
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield lambda: None
        return

    def ignore() -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)

    def first(number: int, frame: Any) -> None:
        ignore()
        before(number, frame)

    signal.signal(signal.SIGINT, first)
    try:
        yield ignore
    finally:
        signal.signal(signal.SIGINT, before)
