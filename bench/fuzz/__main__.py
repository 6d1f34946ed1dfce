"""``python -m fuzz``: random scenarios and damaged files, each in a process of its own.

What was found is appended to a file as it comes; a search that was stopped goes on with --resume.
Exit status 1 if anything failed.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from fuzz import files
from fuzz.checks import CHECKS, EXTREME_CHECKS
from fuzz.originals import originals
from fuzz.processes import Ended, run_all
from fuzz.report import judged, table, write
from fuzz.sanitized import check_sanitized
from fuzz.scenarios import POPULATIONS, Identity, scenario

Task = tuple[tuple[str, str], Callable[[], Any]]

_EVER = 10**9


def main(arguments: list[str] | None = None) -> int:
    """Search; the exit status."""
    options = _options(arguments)
    if options.toml:
        options.toml.mkdir(parents=True, exist_ok=True)
        for name in options.only:
            scenario(Identity.parse(name)).to_toml(options.toml / f"{name.replace(':', '-')}.toml")
        return 0
    options.out.mkdir(parents=True, exist_ok=True)
    journal = options.out / "found.jsonl"
    rows = _read(journal) if options.resume else []
    done = {(row["check"], row["name"]) for row in rows}
    tasks = (task for task in _tasks(options) if task[0] not in done)
    if "files" in options.check:
        originals()  # once for all the processes that come
    until = time.monotonic() + 60.0 * options.minutes
    with journal.open("a" if options.resume else "w") as out:
        for (check, name), ended in run_all(tasks, options.jobs, options.seconds, until):
            row = _row(check, name, ended)
            rows.append(row)
            out.write(json.dumps(row) + "\n")
            out.flush()
            if judged(row):
                print(f"{check} {name}: {'; '.join(judged(row))}", flush=True)
    write(options.out, rows, vars(options))
    print(table(rows))
    return 1 if any(judged(row) for row in rows) else 0


def _options(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m fuzz", description=__doc__)
    every = [*CHECKS, "files", "sanitized"]
    parser.add_argument("--check", default="status,invariants,files", help=", ".join(every))
    parser.add_argument("--population", default=",".join(POPULATIONS), help="separated by commas")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first of each kind")
    parser.add_argument("--count", type=int, help="of each check and population")
    parser.add_argument("--minutes", type=float, help="begin none after this time")
    parser.add_argument("--seconds", type=float, default=30.0, help="that one may take")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes at a time")
    parser.add_argument("--only", action="append", default=[], help="such as wild:0:123; repeat")
    parser.add_argument("--toml", type=Path, help="write the scenarios of --only to this folder")
    parser.add_argument("--sanitize", action="store_true", help="add the check `sanitized`")
    parser.add_argument("--resume", action="store_true", help="leave out what was done before")
    parser.add_argument("--out", type=Path, default=Path("bench/results/fuzz"))
    options = parser.parse_args(arguments)
    options.check = options.check.split(",") + ["sanitized"] * options.sanitize
    options.population = options.population.split(",")
    if not set(options.check) <= set(every):
        parser.error(f"--check: allowed are {', '.join(every)}")
    if not set(options.population) <= set(POPULATIONS):
        parser.error(f"--population: allowed are {', '.join(POPULATIONS)}")
    if options.count is None and options.minutes is None:
        options.minutes = 5.0
    options.count = _EVER if options.count is None else options.count
    options.minutes = float("inf") if options.minutes is None else options.minutes
    return options


def _tasks(options: argparse.Namespace) -> Iterator[Task]:
    """Number by number, so that a search that is cut short has some of everything."""
    if options.only:
        for name, check in itertools.product(options.only, options.check):
            yield from _task(check, name)
        return
    for number in range(options.first, options.first + options.count):
        for check in options.check:
            kinds = files.KINDS if check == "files" else options.population
            for kind in kinds:
                yield from _task(check, f"{kind}:{options.seed}:{number}")


def _task(check: str, name: str) -> Iterator[Task]:
    kind = name.split(":")[0]
    if (check == "files") != (kind in files.KINDS):
        return
    if check == "files":
        yield (check, name), partial(files.check_file, name)
    elif check == "sanitized":
        yield (check, name), partial(check_sanitized, Identity.parse(name))
    elif kind != "extreme" or check in EXTREME_CHECKS:
        yield (check, name), partial(CHECKS[check], Identity.parse(name))


def _row(check: str, name: str, ended: Ended) -> dict[str, Any]:
    result = ended.result or {"failures": [], "kind": ""}
    return {
        "check": check,
        "name": name,
        "how": ended.how,
        "code": ended.code,
        "seconds": round(ended.seconds, 3),
        **result,
    }


def _read(journal: Path) -> list[dict[str, Any]]:
    """Rows of a journal, without a last one that was not written to its end."""
    if not journal.exists():
        return []
    whole, _, _ = journal.read_text().rpartition("\n")
    journal.write_text(whole + "\n" if whole else "")
    return [json.loads(line) for line in whole.splitlines()]


if __name__ == "__main__":
    sys.exit(main())
