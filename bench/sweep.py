"""Cost of parameter sweeps: `python -m bench sweep`.

The works `modes` and `apart` of works.py, in turn, on one thread: CPU time of a sweep over that of
its runs one by one. The speed-up is the wall time with one thread over that with several, for ten
times as many frequencies, in turn; the median and the best are given, as other work on the machine
can only lower it. The overhead is the CPU time of the work `points`, a point.
"""

from __future__ import annotations

import argparse
import os
import time

from measure import add_out, figure_of, in_turn, ratios, saved, timed
from works import WORKS, modes_swept

RTOL = 1e-8


def against_single_runs(fewest: int, most: int) -> dict[str, float]:
    """A sweep beside the same runs one by one."""
    works = [WORKS[name].call for name in ("modes", "apart")]
    simulated, _ = works[0](RTOL)  # and imports
    samples = list(
        in_turn([lambda each=each: timed(lambda: each(RTOL)) for each in works], fewest, most)
    )
    together, single = (figure_of(mine).median for mine in zip(*samples, strict=True))
    return {
        "simulated_seconds": simulated,
        "sweep_cpu_seconds": together,
        "single_runs_cpu_seconds": single,
        "sweep_simulated_per_cpu_second": simulated / together,
        "ratio": ratios(samples).median,
    }


def speed_up(repeats: int, jobs: int) -> dict[str, float]:
    """Wall time with one thread and with several."""

    def wall(threads: int) -> float:
        return timed(lambda: modes_swept(RTOL, threads, times=10), time.perf_counter)

    pairs = [(wall(1), wall(jobs)) for _ in range(repeats)]
    return {
        "threads": jobs,
        "one_thread_seconds": min(one for one, _ in pairs),
        "seconds": min(several for _, several in pairs),
        "speed_up_median": ratios(pairs).median,
        "speed_up_best": max(one / several for one, several in pairs),
    }


def overhead(repeats: int) -> dict[str, float]:
    """CPU time of a point without motion."""
    points = WORKS["points"]
    cost = figure_of([timed(lambda: points.call(RTOL)) for _ in range(repeats)]).median
    return {"points": points.count, "cpu_microseconds_a_point": cost / points.count * 1e6}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench sweep", description=__doc__)
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--jobs", type=int, default=2)
    add_out(parser, "sweep")
    options = parser.parse_args()
    load = os.getloadavg()[0]
    single = against_single_runs(options.repeats, options.repeats)
    result = {"load_before": load, "against_single_runs": single,
              "threads": speed_up(options.repeats, options.jobs),
              "overhead": overhead(3)}  # fmt: skip
    for name, figures in result.items():
        print(name, figures)
    saved(options.out, "sweep", result)


if __name__ == "__main__":
    main()
