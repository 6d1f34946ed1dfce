"""Promises about time: `python -m bench promises`. Exit status 1 if one is broken.

A busy machine can only make a measurement worse. So the best of several repeats counts where wall
time is promised, the median ratio of CPU times taken in turn where a ratio is.
"""

from __future__ import annotations

import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from measure import machine

import stickslip
from stickslip import Contact, Drive, Scenario, simulate, sweep

REPEATS = 5

# Slow enough on a sticky surface to stay between the coils for 100 s.
LONG = {"mode": "OPP", "frequency": 200.0, "base": 0.5e-3, "hold": 1.5e-3, "ramp": 0.0}
STICKY = Contact(adhesion=1e-6)

IMPORT = (
    "import time; begin = time.perf_counter(); import stickslip; print(time.perf_counter() - begin)"
)

# Runs that would take hours: one that moves, and one that rests for as many pulses as the default
# of solver.max_steps allows.
ENDLESS = {
    "moving": ["solver.max_step=1e-7", "drive.pulses=5000"],
    "at rest": ["drive.peak=0.6e-3", "drive.hold=1e-6", "drive.pulses=499e6"],
}


def cpu_seconds(work: Callable[[], object]) -> float:
    begin = time.process_time()
    work()
    return time.process_time() - begin


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

    def seconds(pulses: int) -> float:
        scenario = Scenario(drive=Drive(pulses=pulses, **LONG), contact=STICKY)
        return cpu_seconds(lambda: simulate(scenario))

    ratios = []
    for _ in range(REPEATS):
        short = statistics.median(seconds(200) for _ in range(9))
        ratios.append(seconds(20_000) / short)
    return statistics.median(ratios)


def sweeping() -> float:
    """CPU time of a sweep over that of its runs one by one."""
    base = Scenario(drive=Drive(base=0.5e-3, pulses=20))
    frequencies, modes = np.linspace(5.0, 200.0, 40), ["IPP", "OPP"]

    def one_by_one() -> None:
        for frequency in frequencies:
            for mode in modes:
                simulate(base.replace({"drive.frequency": float(frequency), "drive.mode": mode}))

    def together() -> None:
        sweep(base, {"drive.frequency": frequencies, "drive.mode": modes}, threads=1)

    together()
    return statistics.median(
        cpu_seconds(together) / cpu_seconds(one_by_one) for _ in range(REPEATS)
    )


def overhead() -> float:
    """CPU time of a point of a sweep whose runs are a millisecond without field, s."""
    tiny = Scenario(drive=Drive(frequency=1000.0, pulses=1, ramp=0.0, hold=0.0, peak=0.0))
    vary = {
        "drive.frequency": np.linspace(1e3, 2e3, 500),
        "contact.adhesion": np.linspace(0.0, 1e-6, 200),
    }
    with tempfile.TemporaryDirectory() as folder:
        taken = cpu_seconds(lambda: sweep(tiny, vary, threads=1, out=Path(folder) / "tiny.nc"))
    return taken / 100_000


PROMISES: list[tuple[str, Callable[[], float], float]] = [
    ("import stickslip (s)", importing, 0.3),
    *(
        (f"Ctrl-C ends a run, {name} (s)", lambda settings=settings: interrupting(settings), 0.2)
        for name, settings in ENDLESS.items()
    ),
    ("100 times as many pulses (times the CPU time)", lengthening, 105.0),
    ("a sweep (times the CPU time of its runs)", sweeping, 1.1),
    ("a point of a sweep beyond its run (CPU s)", overhead, 20e-6),
]


def main() -> int:
    rows = []
    for name, measure, limit in PROMISES:
        value = measure()
        rows.append({"promise": name, "measured": value, "limit": limit, "kept": value <= limit})
        word = "kept" if value <= limit else "BROKEN"
        print(f"{name:48} {value:10.3g}   at most {limit:<8.3g} {word}")
    out = Path("bench/results/promises.json")
    out.parent.mkdir(parents=True, exist_ok=True)
    result = {"machine": machine(), "stickslip": stickslip.__version__, "promises": rows}
    out.write_text(json.dumps(result, indent=2) + "\n")
    print(f"written: {out}")
    return 0 if all(row["kept"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
