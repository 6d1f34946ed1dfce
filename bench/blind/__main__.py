"""``python -m blind``: data sets of every kind, diagnosed without their answers, then scored.

Every data set is one line of the record, which says the state of engine and generator. A study that
was stopped goes on where it stood; what another state could have said otherwise is made anew.
"""

from __future__ import annotations

import argparse
import fcntl
import json
import os
import time
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from pathlib import Path
from typing import Any

from blind.case import same_state, state, study
from blind.kinds import KINDS, plan
from blind.report import report
from blind.scoring import judged, read, slim
from blind.writing import write_case

RECORD = "record.jsonl"


def main() -> None:
    """Run the study, or write its data sets."""
    parser = argparse.ArgumentParser(prog="python -m blind", description=__doc__)
    parser.add_argument("--seeds", type=int, default=1000, help="data sets of a kind, at most")
    parser.add_argument("--first", type=int, default=23000, help="first seed")
    parser.add_argument("--kinds", default=";".join(KINDS), help="separated by semicolons")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="data sets at a time")
    parser.add_argument("--minutes", type=float, default=600.0, help="begin none after this time")
    parser.add_argument("--write", type=Path, help="only write the data sets, into this folder")
    parser.add_argument("--out", type=Path, default=Path("bench/results/blind"))
    options = parser.parse_args()
    options.kinds = options.kinds.split(";")
    if not set(options.kinds) <= set(KINDS):
        parser.error(f"--kinds: allowed are {'; '.join(KINDS)}")
    asked = list(plan(options.first, options.seeds, options.kinds))
    if options.write is not None:
        _write(options.write, asked)
        return
    out: Path = options.out
    out.mkdir(parents=True, exist_ok=True)
    with (out / "lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            parser.error(f"--out {out}: another study is at work there")
        _run(out, asked, options)


def _write(folder: Path, asked: list[tuple[str, int]]) -> None:
    """Data sets whose names say nothing, and the answers in a folder of their own."""
    answers = folder / "answers"
    answers.mkdir(parents=True, exist_ok=True)
    for kind, seed in asked:
        number = len(list(answers.iterdir()))
        answer = write_case(folder / f"{number:04d}", kind, seed)
        (answers / f"{number:04d}.json").write_text(json.dumps(answer, indent=2) + "\n")
        print(folder / f"{number:04d}" / "measurement.toml", flush=True)


def _run(out: Path, asked: list[tuple[str, int]], options: argparse.Namespace) -> None:
    jobs, record, now = options.jobs, out / RECORD, state()
    rows = [row for row in _recorded(record) if same_state(row, now)]
    done = {(row["answer"]["kind"], row["answer"]["seed"]) for row in rows}
    waiting = [each for each in asked if each not in done]
    failed: list[str] = []
    end = time.monotonic() + 60.0 * options.minutes
    running: dict[Future[dict[str, Any]], tuple[str, int]] = {}
    with ProcessPoolExecutor(jobs) as pool, record.open("a") as file:
        while running or waiting:
            while waiting and len(running) < jobs and time.monotonic() < end:
                kind, seed = waiting.pop(0)
                future = pool.submit(study, kind, seed)
                running[future] = (kind, seed)
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
                row = {"state": now, **slim(future.result())}
                rows.append(row)
                file.write(json.dumps(row) + "\n")
                file.flush()
                print(_line(*what, row), flush=True)
    (out / "table.md").write_text(report(rows) + "\n")
    (out / "judged.json").write_text(json.dumps(judged(rows), indent=2) + "\n")
    print(report(rows))
    if failed:
        raise SystemExit("\n".join([f"{len(failed)} data sets failed:", *failed]))


def _recorded(record: Path) -> list[dict[str, Any]]:
    """Rows of a record, which loses a last line that was not written to its end."""
    if not record.exists():
        return []
    text = record.read_text()
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        record.write_text(whole)
    return read(record)


def _line(kind: str, seed: int, row: dict[str, Any]) -> str:
    said = row["said"]
    hidden = row["answer"]["answer"] or [row["answer"]["hook"] or "-"]
    return (
        f"{kind} {seed}: {' + '.join(hidden)} (S = {row['answer']['strength']:.1f}) -> "
        f"{said['verdict']} {said['cause'] or ''}, p = {said['p_value']:.2g}, "
        f"{row['cpu_seconds']:.0f} CPU s"
    )


if __name__ == "__main__":
    main()
