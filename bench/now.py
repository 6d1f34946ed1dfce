"""Cost of diagnoses of this version: `python -m bench now`.

Each figure is written into bench/now.json as it comes, with the commit of the sources, the
processor and the width of the packs. What ran out of its time goes on at the next call, at the same
commit on the same machine; else it begins anew. CPU times are figures over that of the best BIC on
the same problem, and in seconds beside; those of runs and sweeps are measured by `python -m bench
against`.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import diagnoses
from measure import ROOT, figure_of, processor, ratios
from stale import digest, stale

HERE = Path(__file__).resolve().parent
NOW = HERE / "now.json"
REPEATS = 3  # of a diagnosis; chosen, as each takes up to minutes

Row = dict[str, Any]
"""A figure: its unit, median, low, high, n; CPU times have seconds besides."""


def cpu_row(samples: Sequence[Sequence[float]], rival: str) -> Row:
    """Row of a work's CPU time over that of a rival, from CPU seconds of both."""
    seconds = figure_of([row[0] for row in samples])
    return {"unit": rival, **ratios(samples)._asdict(), "seconds": seconds._asdict()}


def in_process(code: str) -> Any:
    """Run a program of this folder in a process of its own; the JSON that it prints last."""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=HERE, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode != 0:
        sys.exit(done.stderr)
    return json.loads(done.stdout.splitlines()[-1])


def figures(done: dict[str, Row], ends: float) -> Iterator[tuple[str, Row]]:
    """CPU time of whole diagnoses with one thread over that of a rival, and their memory.

    None is begun after a time of the monotonic clock, s.
    """
    for turn in range(REPEATS):
        for name in diagnoses.CASES:
            row = done.get(name, {"samples": []})
            if len(row["samples"]) > turn or time.monotonic() >= ends:
                continue
            found = in_process(f"import diagnoses; diagnoses.main({name!r})")
            samples = [*row["samples"], found["cpu_seconds"]]
            row = cpu_row(samples, "best BIC")
            yield name, {**row, "verdict": found["verdict"], "samples": samples}
            memory = dict.fromkeys(("median", "low", "high"), found["memory"])
            yield f"{name}, peak memory", {"unit": "MB", **memory, "n": 1}


def commit() -> str:
    """The last commit that changed the sources, and whether they have changed since."""
    git = ["git", "-C", str(ROOT)]
    sources = ["--", "cpp", "python", "cmake", "CMakeLists.txt", "pyproject.toml"]
    last = subprocess.run([*git, "log", "-1", "--format=%h", *sources], capture_output=True,
                          text=True, check=True).stdout.strip()  # fmt: skip
    changed = subprocess.run([*git, "diff", "--quiet", "HEAD", *sources], check=False).returncode
    return last + ("+" if changed else "")


def read(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text()) if path.is_file() else {}


def rounded(value: Any) -> Any:
    """Numbers to six digits, as more are noise."""
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, list):
        return list(map(rounded, value))
    return float(f"{value:.6g}") if isinstance(value, float) else value


def written(path: Path, whole: dict[str, Any]) -> None:
    """Write whole, one figure a line."""
    head = "".join(f" {json.dumps(key)}: {json.dumps(value)},\n"
                   for key, value in whole.items() if key != "rows")  # fmt: skip
    rows = ",\n".join(f"  {json.dumps(figure)}: {json.dumps(row)}"
                      for figure, row in whole["rows"].items())  # fmt: skip
    part = path.with_suffix(".part")
    part.write_text(f'{{\n{head} "rows": {{\n{rows}\n }}\n}}\n')
    part.replace(path)


def line(figure: str, row: Row) -> str:
    """Figure with its interval."""
    between = f"{row['low']:.5g} to {row['high']:.5g}"
    return f"{figure:42}{row['median']:11.5g}  {between:22} {row['unit']}"


def measured(path: Path, ends: float) -> dict[str, Any]:
    """Begin or continue, and write each figure as it comes; what there is then."""
    model, width = processor()
    stated = {"commit": commit(), "processor": model, "kernel width": width, "golden": digest()}
    whole = json.loads(path.read_text()) if path.is_file() else {}
    rows = whole.get("rows", {})
    done = all(len(rows.get(name, {}).get("samples", ())) >= REPEATS for name in diagnoses.CASES)
    if done or any(whole.get(key) != stated[key] for key in stated):
        rows = {}
    whole = {**stated, "date": datetime.now(timezone.utc).date().isoformat(), "rows": rows}
    for figure, row in figures(rows, ends):
        rows[figure] = rounded(row)
        written(path, whole)
        print(line(figure, row), flush=True)
    return whole


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m bench now", description=__doc__)
    parser.add_argument("--minutes", type=float, default=15.0)
    parser.add_argument("--out", type=Path, default=NOW)
    options = parser.parse_args()
    print(f"{'figure':42}{'median':>11}  95 % interval")
    whole = measured(options.out, time.monotonic() + 60.0 * options.minutes)
    for said in stale([whole] * len(whole["rows"])):
        print(said)
    return 0


if __name__ == "__main__":
    sys.exit(main())
