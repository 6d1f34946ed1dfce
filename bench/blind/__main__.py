"""The blind study of the diagnosis: data sets of an independent simulator, diagnosed unseen.

`make` draws data sets into a folder, `diagnose` reads their files alone, `judge` opens the answers
and prints the tables. `tables` prints those of a record, `write` lays out one data set as files.
The other steps diagnose logs and print their counts. The folder is that of the stored study unless
another one is given; a step that was stopped goes on where it stood. Seeds that were judged before
(`seeds.toml`) are refused.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path

from stale import stale

from blind import finished, own, seeds
from blind.kinds import KINDS, STUDY, plan
from blind.scoring import read, report
from blind.study import HERE, Row, diagnose_sets, in_parts, judge, lines, make
from blind.writing import write_case

OF_LOGS = {
    "own": (own.of_seed, "sets of models of one's own"),
    "servo": (own.of_servo, "logs of servos"),
}
"""Studies in one file: the row of a seed, and the data sets in words."""
TABLES = {
    **dict.fromkeys(OF_LOGS, own.tables), "intervals": finished.intervals,
    "changes": finished.changes,
}  # fmt: skip
"""The table of the rows of a file, by its stem; others are of walkers."""


def show(rows: list[Row], table: Callable[[list[Row]], str] = report) -> None:
    """Print the tables, below a line on rows that are stale."""
    print(*stale(rows), table(rows), sep="\n\n")


def main() -> None:
    """Do one step of the study."""
    parser = argparse.ArgumentParser(
        prog="python -m bench blind",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    steps = parser.add_subparsers(dest="step", required=True)
    folder, time = (argparse.ArgumentParser(add_help=False) for _ in range(2))
    folder.add_argument("--folder", type=Path, default=HERE / "study")
    time.add_argument("--minutes", type=float, default=15.0, help="begin none after this time")
    made = steps.add_parser("make", parents=[folder, time], help="draw data sets")
    made.add_argument(
        "--first", type=int, default=STUDY, help="seed; below that of the study, its plan is wider"
    )
    made.add_argument("--seeds", type=int, default=1000, help="data sets of a kind, at most")
    told = steps.add_parser("diagnose", parents=[folder, time], help="diagnose the data sets")
    told.add_argument("--part", default="1/1", metavar="K/N", help="every Nth from the Kth on")
    steps.add_parser("judge", parents=[folder], help="open the answers, print the tables")
    tables = steps.add_parser("tables", help="the tables of a record")
    tables.add_argument("record", type=Path)
    write = steps.add_parser("write", help="one data set as files, and its answer apart")
    write.add_argument("kind", choices=KINDS)
    write.add_argument("seed", type=int)
    write.add_argument("into", type=Path)
    for name, (_, text) in OF_LOGS.items():
        step = steps.add_parser(name, parents=[folder, time], help=text)
        newest = seeds.ranges(name)[-1]
        step.add_argument("--first", type=int, default=newest.first, help="seed")
        step.add_argument("--sets", type=int, default=newest.count, help="at most")
    options = parser.parse_args()
    if options.step == "make":
        asked = plan(options.first, options.seeds, [*KINDS], study=options.first >= STUDY)
        make(options.folder, asked, options.minutes)
    elif options.step == "diagnose":
        part, parts = map(int, options.part.split("/"))
        diagnose_sets(options.folder, options.minutes, part, parts)
    elif options.step == "judge":
        show(judge(options.folder))
    elif options.step == "tables":
        table = TABLES.get(options.record.stem)
        show(read(options.record)) if table is None else show([*lines(options.record)], table)
    elif options.step in OF_LOGS:
        judged, _ = OF_LOGS[options.step]
        asked = range(options.first, options.first + options.sets)
        path = options.folder / f"{options.step}.jsonl"
        show(in_parts(path, options.minutes, asked, judged), own.tables)
    else:
        answer = write_case(options.into / "data", options.kind, options.seed)
        (options.into / "answer.json").write_text(json.dumps(answer, indent=2) + "\n")
        print(options.into / "data" / "measurement.toml")


if __name__ == "__main__":
    main()
