"""Cost of diagnoses: CPU time of each measurement in a folder or below it, on one thread.

``python -m bench diagnosis FOLDER`` diagnoses the data sets that ``python -m bench blind --write
FOLDER`` wrote. With ``--against COMMIT`` an earlier version diagnoses them, too, in turn with this
one, each data set in a process of its own; its package is built as by ``python -m bench against``.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

FILE = "measurement.toml"


def diagnosed(path: Path) -> dict[str, Any]:
    """Verdict and CPU seconds of one data set."""
    from stickslip import diagnose, read_measurement

    measurement = read_measurement(path)
    start = time.process_time()
    result = diagnose(measurement, threads=1)
    seconds = time.process_time() - start
    verdict = result.verdict
    return {
        "data": path.parent.name,
        "verdict": verdict.kind,
        "causes": list(verdict.causes),
        "cpu_s": round(seconds, 2),
    }


def diagnosed_by(package: Path, path: Path) -> dict[str, Any]:
    """The same by the package in a folder, in a process of its own."""
    environment = {**os.environ, "PYTHONPATH": str(package.resolve())}
    command = [sys.executable, __file__, str(path.parent)]
    done = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[0])
    return found


def cost(rows: list[dict[str, Any]]) -> str:
    """Median and largest CPU time where something is found; elsewhere no cause is fitted."""
    seconds = [row["cpu_s"] for row in rows if row["verdict"] != "none"]
    if not seconds:
        return "nothing is found"
    middle, largest = statistics.median(seconds), max(seconds)
    return f"{len(seconds)} with a finding: median {middle:.1f} CPU s, largest {largest:.1f}"


def main() -> None:
    """Diagnose and print."""
    parser = argparse.ArgumentParser(prog="python -m bench diagnosis", description=__doc__)
    parser.add_argument("folder", type=Path, help=f"with a {FILE}, or with folders that have one")
    parser.add_argument("--against", metavar="COMMIT", help="an earlier version, in turn")
    options = parser.parse_args()
    paths = sorted([*options.folder.glob(FILE), *options.folder.glob(f"*/{FILE}")])
    if not paths:
        parser.error(f"{options.folder}: no {FILE} there or in its folders")
    if options.against is None:
        rows = []
        for path in paths:
            rows.append(diagnosed(path))
            print(json.dumps(rows[-1]), flush=True)
        print(cost(rows))
        return
    from against import built

    import stickslip

    packages = (built(options.against), Path(stickslip.__file__).parents[1])
    pairs = []
    for path in paths:
        pairs.append([diagnosed_by(package, path) for package in packages])
        for words, row in zip(("before", "now"), pairs[-1], strict=True):
            print(f"{words:<7}{json.dumps(row)}", flush=True)
    before, now = map(list, zip(*pairs, strict=True))
    print(f"before: {cost(before)}\nnow: {cost(now)}")
    ratios = [after["cpu_s"] / max(first["cpu_s"], 0.01) for first, after in pairs]
    print(f"now over before: median of the ratios {statistics.median(ratios):.2f}")


if __name__ == "__main__":
    main()
