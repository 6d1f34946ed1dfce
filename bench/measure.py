"""CPU time on a shared, noisy machine: pinned, repeated, medians."""

from __future__ import annotations

import json
import os
import platform
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import stickslip


def pin(cpu: int | None = None) -> int:
    """Keep this process and its threads on one core; by default the last of those allowed."""
    allowed = sorted(os.sched_getaffinity(0))
    chosen = allowed[-1] if cpu is None else cpu
    os.sched_setaffinity(0, {chosen})
    return chosen


def timed(work: Callable[[], object], clock: Callable[[], float] = time.process_time) -> float:
    """Seconds of one call."""
    started = clock()
    work()
    return clock() - started


def cpu_seconds(work: Callable[[], object], repeats: int = 7) -> float:
    """Median CPU seconds of `work` over `repeats` calls after one that is not counted.

    Work that is short is repeated within one measurement until it fills 50 ms.
    """
    once = max(timed(work), 1e-6)
    inner = max(1, round(0.05 / once))
    samples = []
    for _ in range(repeats):
        samples.append(timed(lambda: [work() for _ in range(inner)]) / inner)
    return statistics.median(samples)


def cpu_seconds_in_turn(works: list[Callable[[], object]], repeats: int = 7) -> list[float]:
    """Median CPU seconds of each of `works`, measured in turn so that drift meets them alike."""
    samples: list[list[float]] = [[] for _ in works]
    for _ in range(repeats):
        for work, mine in zip(works, samples, strict=True):
            mine.append(cpu_seconds(work, repeats=1))
    return [statistics.median(mine) for mine in samples]


def machine() -> dict[str, str]:
    """What the figures were measured on."""
    model = platform.processor()
    try:
        with open("/proc/cpuinfo") as info:
            names = [
                line.split(":", 1)[1].strip() for line in info if line.startswith("model name")
            ]
        model = names[0] if names else model
    except OSError:
        pass
    return {
        "processor": model,
        "system": platform.platform(),
        "python": platform.python_version(),
        "cores_allowed": str(len(os.sched_getaffinity(0))),
    }


def saved(path: Path, result: dict[str, Any], said: bool = True) -> None:
    """Write a result with the machine and the version that it was measured with."""
    path.parent.mkdir(parents=True, exist_ok=True)
    stated = {"machine": machine(), "stickslip": stickslip.__version__, **result}
    path.write_text(json.dumps(stated, indent=2) + "\n")
    if said:
        print(f"written: {path}")
