"""The blind study of the diagnosis: data sets of an independent simulator, diagnosed unseen.

`make` draws data sets into a folder, `diagnose` reads their files alone, `judge` opens the answers
and prints the tables. `tables` prints those of a record, `write` lays out one data set as files,
`store` keeps sets of old seeds with what the present engine says of them, `compare` sets the
verdicts and fits of a later engine beside these. `own` diagnoses sets of models of one's own,
`twins` logs of near twins beside a distorted sensor, `late` logs whose input acts late, `units`
logs in a unit that nobody stated, and `intervals` logs beside an error of the model; each prints
its counts. The folder is that of the stored study
unless another one is given; a step that was stopped goes on where it stood.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from stale import stale

from blind import intervals, late, twins, units
from blind.kinds import KINDS, OLD, STUDY, plan
from blind.own import study as study_own
from blind.scoring import read, report
from blind.stored import compare, store
from blind.study import HERE, Row, diagnose_sets, judge, make
from blind.writing import write_case

OF_LOGS = {
    "twins": (twins.study, twins.FIRST + 60, "logs of near twins"),
    "late": (late.study, late.FIRST, "logs whose input acts late"),
    "intervals": (intervals.study, intervals.FIRST, "sizes beside an error of the model"),
    "units": (units.study, units.FIRST, "logs in a unit that nobody stated"),
}
"""Of each study of logs: what does it, its first seed, and what it has."""


def show(rows: list[Row]) -> None:
    """The tables, below what of them is stale."""
    print(*stale(rows), report(rows), sep="\n\n")


def main() -> None:
    """Do one step of the study."""
    parser = argparse.ArgumentParser(
        prog="python -m bench blind",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    steps = parser.add_subparsers(dest="step", required=True)
    folder, time, some = (argparse.ArgumentParser(add_help=False) for _ in range(3))
    folder.add_argument("--folder", type=Path, default=HERE / "study")
    time.add_argument("--minutes", type=float, default=15.0, help="begin none after this time")
    some.add_argument("--kinds", default=";".join(KINDS), help="separated by semicolons")
    made = steps.add_parser("make", parents=[folder, time, some], help="draw data sets")
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
    short = argparse.ArgumentParser(add_help=False)
    short.add_argument("--most", type=float, default=60.0, help="CPU seconds of a diagnosis")
    kept = steps.add_parser("store", parents=[time, some, short], help="keep sets and verdicts")
    kept.add_argument("--seeds", type=int, default=2, help="data sets of a kind, at most")
    own = steps.add_parser("own", parents=[folder, time], help="sets of models of one's own")
    own.add_argument("--sets", type=int, default=250, help="at most")
    for name, (_, first, text) in OF_LOGS.items():
        step = steps.add_parser(name, parents=[folder, time], help=text)
        step.add_argument("--first", type=int, default=first, help="seed")
        step.add_argument("--sets", type=int, default=60, help="at most")
    again = steps.add_parser("compare", parents=[time, some, short], help="before and now")
    again.add_argument("--out", type=Path, default=Path("bench/results/stored.jsonl"))
    options = parser.parse_args()
    kinds = options.kinds.split(";") if "kinds" in options else []
    if not set(kinds) <= set(KINDS):
        parser.error(f"--kinds: allowed are {'; '.join(KINDS)}")
    if options.step == "make":
        asked = plan(options.first, options.seeds, kinds, study=options.first >= STUDY)
        make(options.folder, asked, options.minutes)
    elif options.step == "diagnose":
        part, parts = map(int, options.part.split("/"))
        diagnose_sets(options.folder, options.minutes, part, parts)
    elif options.step == "judge":
        show(judge(options.folder))
    elif options.step == "tables":
        show(read(options.record))
    elif options.step == "own":
        study_own(options.folder / "own.jsonl", options.minutes, options.sets)
    elif options.step in OF_LOGS:
        study, *_ = OF_LOGS[options.step]
        rows = options.folder / f"{options.step}.jsonl"
        study(rows, options.minutes, options.first, options.sets)
    elif options.step == "write":
        answer = write_case(options.into / "data", options.kind, options.seed)
        (options.into / "answer.json").write_text(json.dumps(answer, indent=2) + "\n")
        print(options.into / "data" / "measurement.toml")
    elif options.step == "store":
        store(plan(OLD, options.seeds, kinds), options.minutes, options.most)
    else:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        compare(options.out, kinds, options.minutes, options.most)


if __name__ == "__main__":
    main()
