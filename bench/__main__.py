"""Benchmarks and studies by name: ``python -m bench NAME [options]``; without a name, their list.

Each is a module of this folder. It runs in a process of its own with one thread of the linear
algebra, so that the CPU time that it measures is its own; child processes inherit the thread limit.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROGRAMS = {
    "now": ("now", "cost of diagnoses"),
    "speed": ("speed", "both integrators at equal accuracy"),
    "sweep": ("sweep", "sweeps: cost of a run and of a point, threads"),
    "against": ("against", "this version beside an earlier commit (against COMMIT)"),
    "golden": ("golden", "whether the diagnosis says of stored problems what it said before"),
    "paper": ("paper", "the paper's simulations redone, its statements tested, its figures"),
    "peers": ("peers", "SciPy, heyoka, MuJoCo and magpylib at equal accuracy"),
    "score": ("score", "the diagnosis beside known truths, by class: one scored table"),
    "rules": ("rules", "which rules of the diagnosis decide anything, counted on the score"),
    "blind": ("blind.writing", "a made data set of a walker as files (blind KIND SEED INTO)"),
    "causes": ("causes", "a benchmark for any tool that names causes: make, or a tool"),
    "drawn": ("drawn", "drawn tables and logs of known truth: right, noted or refused"),
    "mutations": ("mutations", "whether the tests see a change of the C++ or Python sources"),
    "lines": ("lines", "lines of each wing of the project"),
}
"""Name, module and what it shows."""


def main(arguments: list[str]) -> int:
    """Print the list, or become the program; 2 for an unknown name."""
    if not arguments or arguments[0] in ("list", "-h", "--help"):
        print("usage: python -m bench NAME [options]\n")
        print(*(f"{name:<14}{text}" for name, (_, text) in PROGRAMS.items()), sep="\n")
        return 0
    name, *rest = arguments
    if name not in PROGRAMS:
        print(f"bench: {name}: allowed is one of {', '.join(PROGRAMS)}", file=sys.stderr)
        return 2
    paths = [str(HERE), os.environ.get("PYTHONPATH")]
    environment = {
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        **os.environ,
        "PYTHONPATH": os.pathsep.join(path for path in paths if path),
    }
    command = [sys.executable, "-m", PROGRAMS[name][0], *rest]
    os.execve(sys.executable, command, environment)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
