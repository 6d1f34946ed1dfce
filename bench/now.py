"""Figures of this version: `python -m bench now [PART ...]`.

Each part writes its figures into bench/now.json as they come, with the commit of the sources, the
processor and the width of the packs. A part that ran out of its time goes on at the next call, at
the same commit on the same machine; else it begins anew. CPU times of diagnoses are figures over
that of the best BIC on the same problem, and in seconds beside; those of runs and sweeps are
measured by `python -m bench against`.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import diagnoses
from measure import ROOT, figure_of, processor, ratios
from scores import interval
from stale import digest, stale

HERE = Path(__file__).resolve().parent
NOW = HERE / "now.json"
REPEATS = 3  # of a diagnosis; chosen, as each takes up to minutes
TABLES, BATCH = 2000, 100  # sound tables in all, and between two looks at the clock

Row = dict[str, Any]
"""A figure: its unit, median, low, high, n; CPU times have seconds besides."""


class OutOfTime(Exception):
    """The part goes on at the next call."""


@dataclass
class Budget:
    """When a part has to end."""

    ends: float

    def check(self) -> None:
        if time.monotonic() >= self.ends:
            raise OutOfTime


Part = Callable[[dict[str, Row], Budget], Iterator[tuple[str, Row]]]


def cpu_row(samples: Sequence[Sequence[float]], rival: str) -> Row:
    """Row of a work's CPU time over that of a rival, from CPU seconds of both."""
    seconds = figure_of([row[0] for row in samples])
    return {"unit": rival, **ratios(samples)._asdict(), "seconds": seconds._asdict()}


def share_row(count: int, total: int) -> Row:
    low, high = interval(count, total)
    return {"unit": "share", "median": count / total, "low": low, "high": high, "n": total}


def number_row(value: float, unit: str) -> Row:
    """Row of a number that has no scatter, or was measured once."""
    return {"unit": unit, "median": value, "low": value, "high": value, "n": 1}


def in_process(code: str) -> Any:
    """Run a program of this folder in a process of its own; the JSON that it prints last."""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=HERE, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode != 0:
        sys.exit(done.stderr)
    return json.loads(done.stdout.splitlines()[-1])


def diagnosis(done: dict[str, Row], budget: Budget) -> Iterator[tuple[str, Row]]:
    """CPU time of whole diagnoses with one thread over that of a rival, and their memory."""
    for turn in range(REPEATS):
        for name in diagnoses.CASES:
            row = done.get(name, {"samples": []})
            if len(row["samples"]) > turn:
                continue
            budget.check()
            found = in_process(f"import diagnoses; diagnoses.main({name!r})")
            samples = [*row["samples"], found["cpu_seconds"]]
            row = cpu_row(samples, "best BIC")
            yield name, {**row, "verdict": found["verdict"], "samples": samples}
            yield f"{name}, peak memory", number_row(found["memory"], "MB")


def tables(done: dict[str, Row], budget: Budget) -> Iterator[tuple[str, Row]]:
    """False alarms on sound tables of a model of one's own, and how long each takes."""
    row = done.get("tables, p below 0.05", {"seen": {}})
    seen = Counter[str](row["seen"])
    while seen["tables"] < TABLES:
        budget.check()
        for seed in range(seen["tables"], seen["tables"] + BATCH):
            verdict, p_value, seconds = diagnoses.sound_table(seed)
            seen.update({
                "tables": 1, f"verdict {verdict}": 1, "p below 0.05": int(p_value < 0.05),
                "p below 0.01": int(p_value < 0.01), "CPU time above 0.5 s": int(seconds > 0.5),
            })  # fmt: skip
        for name in sorted(set(seen) - {"tables"}):
            row = share_row(seen[name], seen["tables"])
            yield f"tables, {name}", row | ({"seen": dict(seen)} if "0.05" in name else {})


PARTS: dict[str, Part] = {"diagnosis": diagnosis, "tables": tables}


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


def written(path: Path, parts: dict[str, Any]) -> None:
    """Write whole, one figure a line."""
    shown = []
    for name, part in parts.items():
        head = "".join(f"  {json.dumps(key)}: {json.dumps(value)},\n"
                       for key, value in part.items() if key != "rows")  # fmt: skip
        rows = ",\n".join(f"   {json.dumps(figure)}: {json.dumps(row)}"
                          for figure, row in part["rows"].items())  # fmt: skip
        shown.append(f' {json.dumps(name)}: {{\n{head}  "rows": {{\n{rows}\n  }}\n }}')
    whole = path.with_suffix(".part")
    whole.write_text("{\n" + ",\n".join(shown) + "\n}\n")
    whole.replace(path)


def line(figure: str, row: Row) -> str:
    """Figure with its interval."""
    between = f"{row['low']:.5g} to {row['high']:.5g}"
    return f"{figure:42}{row['median']:11.5g}  {between:22} {row['unit']}"


def measured(name: str, path: Path, budget: Budget) -> None:
    """Begin or continue a part, and write each figure as it comes."""
    parts = read(path)
    model, width = processor()
    stated = {"commit": commit(), "processor": model, "kernel width": width, "golden": digest()}
    part = parts.get(name, {})
    if part.get("complete", True) or any(part.get(key) != stated[key] for key in stated):
        part = {**stated, "rows": {}}
    parts[name] = part = {**part, "complete": False,
                          "date": datetime.now(timezone.utc).date().isoformat()}  # fmt: skip
    try:
        for figure, row in PARTS[name](part["rows"], budget):
            part["rows"][figure] = rounded(row)
            written(path, parts)
            print(line(figure, row), flush=True)
    except OutOfTime:
        print(f"{name}: out of time; the next call goes on")
        return
    part["complete"] = True
    written(path, parts)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m bench now", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--minutes", type=float, default=15.0, help="of each part")
    parser.add_argument("--out", type=Path, default=NOW)
    options = parser.parse_args()
    if not set(options.parts) <= set(PARTS):
        parser.error(f"PART: allowed are {', '.join(PARTS)}")
    print(f"{'figure':42}{'median':>11}  95 % interval")
    for name in options.parts or PARTS:
        ends = time.monotonic() + 60.0 * options.minutes
        measured(name, options.out, Budget(ends))
    kept = read(options.out)
    for name in (each for each in PARTS if each in kept):
        for said in stale([kept[name]] * len(kept[name]["rows"])):
            print(f"{name}: {said}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
