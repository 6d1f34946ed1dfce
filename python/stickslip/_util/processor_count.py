"""Number of simulations that run at a time."""

from __future__ import annotations

import os


def worker_count(count: int | None, name: str) -> int:
    """`count` if it is given, else the number of processors that this process may use.

    A ValueError with the `name` says that it is not a whole number above zero.
    """
    if count is None:
        if hasattr(os, "sched_getaffinity"):
            return len(os.sched_getaffinity(0))
        return os.cpu_count() or 1
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise ValueError(f"{name} = {count!r}: allowed is a whole number from 1")
    return count
