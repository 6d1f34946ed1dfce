"""Cost of diagnoses: CPU time and simulations of each measurement below a folder, on one thread.

``python -m bench diagnosis FOLDER`` diagnoses the data sets that ``python -m bench blind --write
FOLDER`` wrote. With ``PYTHONPATH=<another tree>/python`` another state of the package diagnoses the
same data.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
from pathlib import Path
from typing import Any

from stickslip import diagnose, read_measurement


def diagnosed(path: Path) -> dict[str, Any]:
    """Verdict, CPU seconds and simulations of one data set."""
    measurement = read_measurement(path)
    start = time.process_time()
    result = diagnose(measurement, threads=1)
    seconds = time.process_time() - start
    simulator = result.posed.simulator
    return {
        "data": path.parent.name,
        "verdict": result.verdict.kind,
        "causes": list(result.verdict.causes),
        "cpu_s": round(seconds, 2),
        "simulations": 0 if simulator is None else simulator.simulated,
    }


def main() -> None:
    """Diagnose and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="with folders that have a measurement.toml")
    rows = []
    for path in sorted(parser.parse_args().folder.glob("*/measurement.toml")):
        rows.append(diagnosed(path))
        print(json.dumps(rows[-1]), flush=True)
    # Where nothing is found no cause is fitted.
    found = [row for row in rows if row["verdict"] != "none"]
    for key in ("cpu_s", "simulations"):
        values = [row[key] for row in found]
        print(f"{key} of {len(found)}: median {statistics.median(values)}, largest {max(values)}")


if __name__ == "__main__":
    main()
