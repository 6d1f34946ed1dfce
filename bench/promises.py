"""Promises about time: `python -m bench promises`. Exit status 1 if one is broken.

A busy machine can only make a measurement worse. So the best of several repeats counts where wall
time is promised, the median ratio of CPU times taken in turn where a ratio is.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from measure import figure_of, filled, saved, timed
from sweep import against_single_runs, overhead
from works import WORKS

REPEATS = 5

IMPORT = (
    "import time; begin = time.perf_counter(); import stickslip; print(time.perf_counter() - begin)"
)

# Runs that would take hours: one that moves, and one that rests for as many pulses as the default
# of solver.max_steps allows.
ENDLESS = {
    "moving": ["solver.max_step=1e-7", "drive.pulses=5000"],
    "at rest": ["drive.peak=0.6e-3", "drive.hold=1e-6", "drive.pulses=499e6"],
}


def importing() -> float:
    """Wall time of `import stickslip`, s."""
    command = [sys.executable, "-c", IMPORT]
    return min(float(subprocess.check_output(command, text=True)) for _ in range(REPEATS))


def interrupting(settings: list[str]) -> float:
    """Wall time from Ctrl-C to the end of a run, s."""
    taken = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scenario.toml"
        path.write_text("stickslip = 1\n[drive]\nbase = 0.5e-3\npulses = 12\n")
        command = [sys.executable, "-m", "stickslip", "run", str(path)]
        command += [f"--set={setting}" for setting in settings]
        for _ in range(REPEATS):
            with subprocess.Popen(
                command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
            ) as process:
                assert process.stderr is not None
                seen = b""
                while b"simulating" not in seen:
                    part = os.read(process.stderr.fileno(), 64)
                    if not part:
                        raise RuntimeError("the run ended before its bar appeared")
                    seen += part
                begin = time.perf_counter()
                process.send_signal(signal.SIGINT)
                process.communicate()
                taken.append(time.perf_counter() - begin)
    return min(taken)


def lengthening() -> float:
    """CPU time of 20 000 pulses over that of 200."""
    short, long = WORKS["short"].call, WORKS["long"].call
    of_short = filled(lambda: short(1e-8))
    return figure_of([timed(lambda: long(1e-8)) / of_short() for _ in range(REPEATS)]).median


def stepping() -> float:
    """CPU time of a step beside the core's own, us."""
    work = WORKS["bare steps"]
    return 1e6 * figure_of([timed(lambda: work.call(1e-8)) for _ in range(9)]).median / work.count


def turning() -> float:
    """CPU time in the whole plane, at 30 degrees and rtol 1e-6, a simulated second; the best."""
    call = WORKS["plane"].call
    simulated, _ = call(1e-6)
    sample = filled(lambda: call(1e-6))
    return min(sample() for _ in range(9)) / simulated


PROMISES: list[tuple[str, Callable[[], float], float]] = [
    ("import stickslip (s)", importing, 0.3),
    *((f"Ctrl-C ends a run, {name} (s)", lambda settings=settings: interrupting(settings),
       0.2) for name, settings in ENDLESS.items()),
    ("100 times as many pulses (times the CPU time)", lengthening, 105.0),
    (
        "a sweep (times the CPU time of its runs)",
        lambda: against_single_runs(REPEATS, REPEATS)["ratio"],
        1.1,
    ),
    ("a point of a sweep beyond its run (CPU us)", lambda: overhead(1)["cpu_microseconds_a_point"],
     20.0),
    ("a step beside the physics (CPU us)", stepping, 5.0),
    ("a simulated second in the whole plane (CPU s)", turning, 5e-3),
]  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m bench promises", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("bench/results/promises.json"))
    options = parser.parse_args()
    rows = []
    for name, measure, limit in PROMISES:
        value = measure()
        rows.append({"promise": name, "measured": value, "limit": limit, "kept": value <= limit})
        word = "kept" if value <= limit else "BROKEN"
        print(f"{name:48} {value:10.3g}   at most {limit:<8.3g} {word}")
    saved(options.out, "promises", {"promises": rows})
    return 0 if all(row["kept"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
