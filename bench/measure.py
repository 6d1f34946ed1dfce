"""CPU time on a shared, noisy machine: pinned, in turn, medians with their 95 % intervals."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import platform
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Any, NamedTuple

import stickslip
from stickslip import _core

ROOT = Path(__file__).resolve().parents[1]
MEASURED = ROOT / "docs" / "measured"
"""Results that the pages show."""

FEWEST, MOST, WIDTH = 21, 201, 0.02
"""Samples at least and at most of a figure, and how wide its interval may be, over the median."""
LONGEST = 60.0  # s by the clock, after which only samples up to `FEWEST` are taken
SHORTEST = 0.05  # s, below which work is repeated within one sample


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


def filled(work: Callable[[], object]) -> Callable[[], float]:
    """CPU seconds of a call, from as many as fill `SHORTEST`; `work` is called once before."""
    work()
    inner = max(1, math.ceil(SHORTEST / max(timed(work), 1e-6)))
    return lambda: timed(lambda: [work() for _ in range(inner)]) / inner


class Figure(NamedTuple):
    """The median of n samples and its 95 % interval."""

    median: float
    low: float
    high: float
    n: int

    @property
    def width(self) -> float:
        return (self.high - self.low) / self.median


def figure_of(samples: Sequence[float]) -> Figure:
    """Median with the order statistics between which it lies with 95 % (binomial).

    Of fewer than six samples they are the extremes, with less.
    """
    ranked, n = sorted(samples), len(samples)
    below = 0.0
    for rank in range(n // 2 + 1):
        below += math.comb(n, rank) * 0.5**n
        if below > 0.025:
            break
    place = max(rank - 1, 0)
    return Figure(statistics.median(ranked), ranked[place], ranked[n - 1 - place], n)


def in_turn(
    works: Sequence[Callable[[], float]], fewest: int = FEWEST, most: int = MOST
) -> Iterator[list[float]]:
    """Samples of all works, a list at a time, so that drift meets them alike.

    They end where the ratio of each work to the last one is known to `WIDTH`, at `most` or after
    `LONGEST` at the latest.
    """
    ends = time.monotonic() + LONGEST
    rows: list[list[float]] = []
    while len(rows) < most:
        rows.append([work() for work in works])
        yield rows[-1]
        known = (ratios(rows, k).width <= WIDTH for k in range(len(works)))
        if len(rows) >= fewest and (time.monotonic() > ends or all(known)):
            return


def ratios(samples: Sequence[Sequence[float]], first: int = 0, second: int = -1) -> Figure:
    """Ratio of the first work to the second, from the pairs of each turn."""
    return figure_of([row[first] / row[second] for row in samples])


def cpu_seconds_in_turn(works: Sequence[Callable[[], object]], repeats: int = 7) -> list[float]:
    """Median CPU seconds of each of `works`."""
    samples = list(in_turn([filled(work) for work in works], repeats, repeats))
    return [statistics.median(mine) for mine in zip(*samples, strict=True)]


def processor() -> tuple[str, int]:
    """Name of the processor, and the most runs that a pack of the core has on it."""
    name = platform.processor()
    with contextlib.suppress(OSError):
        for each in Path("/proc/cpuinfo").read_text().splitlines():
            key, _, value = map(str.strip, each.partition(":"))
            if key == "model name":
                name = value
    return name, _core.kernel()[1]


def machine() -> dict[str, str]:
    """The machine that the figures were measured on."""
    return {
        "processor": processor()[0],
        "system": platform.platform(),
        "python": platform.python_version(),
        "cores_allowed": str(len(os.sched_getaffinity(0))),
    }


def add_out(parser: argparse.ArgumentParser, name: str) -> None:
    """``--out``, by default a file that git ignores, and ``--write`` for the one of the pages."""
    path = ROOT / "bench" / "results" / f"{name}.json"
    parser.add_argument("--out", type=Path, default=path)
    parser.add_argument("--write", dest="out", action="store_const", const=MEASURED / path.name,
                        help="into docs/measured")  # fmt: skip


def saved(path: Path, program: str, result: dict[str, Any], said: bool = True) -> None:
    """Write a result with its day, the machine, the version and the program that measured it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    day = datetime.now(timezone.utc).date().isoformat()
    stated = {"date": day, "command": f"python -m bench {program}", "machine": machine()}
    stated |= {"stickslip": stickslip.__version__, **result}
    path.write_text(json.dumps(stated, indent=1) + "\n")
    if said:
        print(f"written: {path}")
