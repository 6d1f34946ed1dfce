"""``python -m blind``: data sets of every kind, diagnosed without their answers, then scored.

Each data set is a folder that says nothing of what is hidden in it; the answers lie beside these
folders. A study that was stopped goes on where it stood.
"""

from __future__ import annotations

import argparse
import fcntl
import json
import os
import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from pathlib import Path
from typing import Any

from blind.case import make, study
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
    parser.add_argument("--only-make", action="store_true", help="leave the diagnosis for later")
    parser.add_argument("--out", type=Path, default=Path("bench/results/blind"))
    options = parser.parse_args()
    options.kinds = options.kinds.split(";")
    if not set(options.kinds) <= set(KINDS):
        parser.error(f"--kinds: allowed are {'; '.join(KINDS)}")
    out: Path = options.out
    out.mkdir(parents=True, exist_ok=True)
    with (out / "lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            parser.error(f"--out {out}: another study is at work there")
        _run(out, options)


def _run(out: Path, options: argparse.Namespace) -> None:
    record = out / "answers.jsonl"
    rows = _recorded(record)
    done = {_name(row["answer"]) for row in rows}
    folders = _made(out)
    used = [path.name[:5] for path in out.glob("data/*")]
    used += [*folders.values(), *(row["folder"] for row in rows)]
    number = 1 + max(map(int, used), default=-1)
    done |= set(folders) if options.only_make else set()
    waiting = [
        each for each in plan(options.first, options.seeds, options.kinds) if each not in done
    ]
    failed: list[str] = []
    end = time.monotonic() + 60.0 * options.minutes
    running: dict[Future[dict[str, Any]], tuple[str, int]] = {}
    with (
        ProcessPoolExecutor(options.jobs) as pool,
        record.open("a") as file,
    ):
        while running or waiting:
            while waiting and len(running) < options.jobs and time.monotonic() < end:
                kind, seed = waiting.pop(0)
                if (kind, seed) not in folders:
                    folders[kind, seed] = f"{number:05d}"
                    number += 1
                folder = out / "data" / folders[kind, seed]
                task = make if options.only_make else study
                running[pool.submit(task, folder, kind, seed)] = (kind, seed)
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
                if options.only_make:
                    continue
                row = future.result()
                rows.append(row)
                file.write(json.dumps(row) + "\n")
                file.flush()
                print(_line(*what, row), flush=True)
    if not options.only_make:
        _report(out, rows)
    if failed:
        raise SystemExit("\n".join([f"{len(failed)} data sets failed:", *failed]))


def _report(out: Path, rows: list[dict[str, Any]]) -> None:
    text = table(rows)
    (out / "measured.jsonl").write_text("".join(json.dumps(slim(row)) + "\n" for row in rows))
    (out / "table.md").write_text(text + "\n")
    (out / "judged.json").write_text(json.dumps(judged(rows), indent=2) + "\n")
    print(text)


def _recorded(record: Path) -> list[dict[str, Any]]:
    """Rows of a record, which loses a last line that was not written to its end."""
    if not record.exists():
        return []
    text = record.read_text()
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        record.write_text(whole)
    return read(record)


def _made(out: Path) -> dict[tuple[str, int], str]:
    """Folders of the data sets that were made before."""
    answers = {path.stem: json.loads(path.read_text()) for path in out.glob("sealed/*.json")}
    return {_name(answer): folder for folder, answer in answers.items()}


def _name(answer: dict[str, Any]) -> tuple[str, int]:
    return answer["kind"], answer["seed"]


def _line(kind: str, seed: int, row: dict[str, Any]) -> str:
    said = row["said"]
    return (
        f"{kind} {seed}: {' + '.join(row['answer']['answer']) or '-'} (S = "
        f"{row['answer']['strength']:.1f}) -> {said['verdict']} {said['cause'] or ''}, "
        f"p = {said['p_value']:.2g}, {row['cpu_seconds']:.0f} CPU s"
    )


if __name__ == "__main__":
    main()
