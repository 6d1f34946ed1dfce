"""Jobs that ``make test`` omits, in a fixed rotation: ``python tests/nightly.py --minutes 25``.

Every hour and every day the rotation begins at another job: short nights visit all of them. A job
begins only if its usual time still fits. Exit status 1 if one failed; the others still run.
"""

from __future__ import annotations

import argparse
import shlex
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PYTHON = shlex.quote(sys.executable)
HOUR, DAY, WEEK = 3600, 24 * 3600, 7 * 24 * 3600
PARTS = 8


def jobs(seed: int) -> dict[str, tuple[int, str]]:
    """Minutes on two cores and command of each job; `seed` is that of the random scenarios."""
    pytest = f"{PYTHON} -m pytest -n 2 --dist worksteal -q -m nightly"
    random = (
        f"{PYTHON} -m pytest -n 2 -q -m '' tests/test_random_scenarios.py"
        f" --hypothesis-profile nightly --hypothesis-seed {seed}"
    )
    result = {f"part-{k}": (10, f"{pytest} --part {k}/{PARTS}") for k in range(1, PARTS + 1)}
    return result | {
        "asan": (10, _preset("asan", "stickslip_tests") + " && ctest --preset asan -j 2"),
        "tsan": (8, _preset("tsan", "stickslip_tests") + " && ctest --preset tsan -j 2"),
        # New scenarios each week may find something: for long nights, not for each change.
        "random": (30, f"{_preset('asan', 'stickslip_fuzz')} && {random}"),
        "wheel": (6, "make wheel"),
        "docs": (5, "make docs"),
        "lint": (15, "make lint"),
        "paper": (1, f"{PYTHON} -m bench paper"),
        "golden": (12, f"{PYTHON} -m bench golden --jobs 2"),
    }


def _preset(name: str, target: str) -> str:
    return f"cmake --preset {name} && cmake --build --preset {name} --target {target}"


def main() -> int:
    """Run the jobs; print a line for each."""
    now = time.time()
    every = jobs(seed=int(now // WEEK))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=600.0, help="for all jobs together")
    parser.add_argument("--start", choices=every, help="first job; without it, by the hour")
    parser.add_argument("--only", choices=every, help="one job")
    parser.add_argument("--without", choices=every, help="all jobs but one")
    options = parser.parse_args()
    names = [options.only] if options.only else [name for name in every if name != options.without]
    first = (
        names.index(options.start)
        if options.start in names
        else int(now // HOUR + now // DAY) % len(names)
    )
    order = names[first:] + names[:first]
    print(f"nightly: from {order[0]} on; `--start {order[0]}` repeats this order", flush=True)
    end = time.monotonic() + 60 * options.minutes
    rows = []
    for name in order:
        minutes, command = every[name]
        begun = time.monotonic()
        if begun + 60 * minutes > end:
            rows.append((name, "left out", 0.0))
            continue
        print(f"nightly: {name}: {command}", flush=True)
        done = subprocess.run(command, shell=True, cwd=ROOT, check=False)
        said = "failed" if done.returncode else "passed"
        rows.append((name, said, (time.monotonic() - begun) / 60))
    for name, said, minutes in rows:
        print(f"nightly: {name:<16}{said:<10}{minutes:5.1f} min")
    return int(any(said == "failed" for _, said, _ in rows))


if __name__ == "__main__":
    sys.exit(main())
