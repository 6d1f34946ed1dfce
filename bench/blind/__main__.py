"""``python -m blind``: data sets of every kind, diagnosed without their answers, then scored.

Each data set is a folder that says nothing of what is hidden in it; the answers lie in a file
beside the folders. A study that was stopped goes on where it stood.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from pathlib import Path
from typing import Any

from blind.case import study
from blind.scoring import judged, read, slim, table
from blind.truth import KINDS

# How many data sets of a kind there are for one seed.
_SHARES = {kind: 1.0 if kind in ("none", "single") else 0.25 for kind in KINDS}


def plan(first: int, seeds: int, kinds: list[str]) -> Iterator[tuple[str, int]]:
    """Kinds and seeds, the kinds mixed, so that a study that is cut short has all of them."""
    for number in range(seeds):
        for kind in kinds:
            share = _SHARES[kind]
            if int((number + 1) * share) > int(number * share):
                yield kind, first + number


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(prog="python -m blind", description=__doc__)
    parser.add_argument("--seeds", type=int, default=4, help="data sets of the kinds none, single")
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--kinds", default=";".join(KINDS), help="separated by semicolons")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="data sets at a time")
    parser.add_argument("--minutes", type=float, default=600.0, help="begin none after this time")
    parser.add_argument("--out", type=Path, default=Path("bench/results/blind"))
    options = parser.parse_args()
    out: Path = options.out
    out.mkdir(parents=True, exist_ok=True)
    record = out / "answers.jsonl"
    rows = read(record) if record.exists() else []
    done = {(row["answer"]["kind"], row["answer"]["seed"]) for row in rows}
    kinds = options.kinds.split(";")
    if not set(kinds) <= set(KINDS):
        parser.error(f"--kinds: allowed are {'; '.join(KINDS)}")
    waiting = [each for each in plan(options.first, options.seeds, kinds) if each not in done]
    failed: list[str] = []
    end = time.monotonic() + 60.0 * options.minutes
    running: dict[Future[dict[str, Any]], tuple[str, int]] = {}
    number = 1 + max((int(row["folder"]) for row in rows), default=-1)
    with (
        ProcessPoolExecutor(options.jobs) as pool,
        record.open("a") as file,
    ):
        while running or waiting:
            while waiting and len(running) < options.jobs and time.monotonic() < end:
                kind, seed = waiting.pop(0)
                folder = out / "data" / f"{number:05d}"
                running[pool.submit(study, folder, kind, seed)] = (kind, seed)
                number += 1
            if not running:
                break
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                what = running.pop(future)
                error = future.exception()
                if error is not None:
                    # The others are worth keeping; this one is tried again by the next call.
                    failed.append(f"{what[0]} {what[1]}: {error!r}")
                    print(failed[-1], flush=True)
                    continue
                row = future.result()
                rows.append(row)
                file.write(json.dumps(row) + "\n")
                file.flush()
                print(_line(*what, row), flush=True)
    text = table(rows)
    (out / "measured.jsonl").write_text("".join(json.dumps(slim(row)) + "\n" for row in rows))
    (out / "table.md").write_text(text + "\n")
    (out / "judged.json").write_text(json.dumps(judged(rows), indent=2) + "\n")
    print(text)
    if failed:
        raise SystemExit("\n".join([f"{len(failed)} data sets failed:", *failed]))


def _line(kind: str, seed: int, row: dict[str, Any]) -> str:
    said = row["said"]
    return (
        f"{kind} {seed}: {' + '.join(row['answer']['answer']) or '-'} (S = "
        f"{row['answer']['strength']:.1f}) -> {said['verdict']} {said['cause'] or ''}, "
        f"p = {said['p_value']:.2g}, {row['cpu_seconds']:.0f} CPU s"
    )


if __name__ == "__main__":
    main()
