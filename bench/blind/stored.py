"""The stored data sets of the study: ``python -m bench blind-study``.

They are diagnosed from their files alone, in calls of some minutes; each row is kept as it comes,
in `study/said.jsonl`, with the state of the engine. ``--judge`` then opens the answers, of what was
diagnosed by the present engine, and writes `study/record.jsonl` and its tables.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

from blind.case import diagnosed, same_state, state, with_answer
from blind.frozen import HERE, STUDY_SETS, answers, sets, unpacked
from blind.report import report
from blind.scoring import slim

SAID, RECORD = HERE / "study" / "said.jsonl", HERE / "study" / "record.jsonl"


def said(now: dict[str, str]) -> dict[str, dict[str, Any]]:
    """Rows of the present engine by the names of their data sets."""
    text = SAID.read_text() if SAID.exists() else ""
    rows = [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]
    return {row["name"]: row for row in rows if same_state(row, now)}


def diagnose_stored(minutes: float, part: int, parts: int) -> None:
    """Diagnose what has no row yet, every `parts`-th data set from `part` on."""
    now, end = state(), time.monotonic() + 60.0 * minutes
    done = said(now)
    for number, one in enumerate(sets(STUDY_SETS)):
        if one["name"] in done or number % parts != part:
            continue
        if time.monotonic() > end:
            break
        with tempfile.TemporaryDirectory() as work:
            row = diagnosed(unpacked(one, Path(work) / "data").parent)
        # Nothing of the verdict is shown before all are judged.
        kept = {**slim(row), "next_experiments": row["said"]["next_experiments"]}
        with SAID.open("a") as file:
            file.write(json.dumps({"name": one["name"], "state": now, **kept}) + "\n")
        print(f"{one['name']}: {row['cpu_seconds']:.0f} CPU s", flush=True)


def judge() -> None:
    """Open the answers of what was diagnosed, and write the record and its tables."""
    now = state()
    rows, known = said(now), answers()
    with RECORD.open("w") as file:
        for one in sets(STUDY_SETS):
            row = rows.get(one["name"])
            if row is None:
                continue
            row["said"]["next_experiments"] = row.pop("next_experiments")
            with tempfile.TemporaryDirectory() as work:
                folder = unpacked(one, Path(work) / "data").parent
                whole = with_answer(row, known[one["name"]], folder, Path(work) / "more")
            file.write(json.dumps(slim(whole)) + "\n")
    print(report([json.loads(line) for line in RECORD.read_text().splitlines()]))


def main() -> None:
    """Diagnose a part of the study, or judge it."""
    parser = argparse.ArgumentParser(prog="python -m bench blind-study", description=__doc__)
    parser.add_argument("--minutes", type=float, default=15.0, help="begin none after this time")
    parser.add_argument("--part", type=int, default=0, help="of so many --parts, from 0")
    parser.add_argument("--parts", type=int, default=1, help="processes that share the work")
    parser.add_argument("--judge", action="store_true", help="open the answers")
    options = parser.parse_args()
    if options.judge:
        judge()
    else:
        diagnose_stored(options.minutes, options.part, options.parts)


if __name__ == "__main__":
    main()
