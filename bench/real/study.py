"""``python -m bench real [SET ...]``: measured sets with a known cause, diagnosed and judged.

Each set is diagnosed twice: with the cause that acts among those that are listed, and without it.
Rows are written as they come, into a file that keeps those of other sets; the counts at the end are
of all of them. `walkers` are rollers, tumbler, drops and the walk of the README, whose rows go into
a file of their own. The status is 1 where a wrong cause is claimed.
"""

from __future__ import annotations

import argparse
import json
import runpy
import sys
from collections.abc import Iterable
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from measure import add_out, saved
from stale import digest

from .score import Measured, Row, by_tool, row

MACHINES = {path.parent.name: path
            for path in sorted(Path(__file__).parent.glob("machines/*/machine.py"))}  # fmt: skip
WALKERS = ("tumbler", "rollers", "drops", "walk")
SHOWN = [each.name for each in fields(Row) if each.name != "reasons"]
NAMES = tuple(name for name in MACHINES if name != "walk")  # which is simulated


def measured_sets(name: str, drops: Path | None = None) -> list[Measured]:
    """The sets of a machine, of which drops may be others."""
    machine = runpy.run_path(str(MACHINES[name]))
    own = machine["sets"](drops) if drops and "sets" in machine else machine["SETS"]
    return list(own)


def line(cells: Iterable[object]) -> str:
    """A row of a table in Markdown."""
    return f"| {' | '.join(map(str, cells))} |"


def main(arguments: list[str] | None = None) -> int:
    """Diagnose, print and write; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m bench real", description=__doc__)
    known = ("walkers", *NAMES)
    parser.add_argument("sets", nargs="*", metavar="SET", help=", ".join(known))
    parser.add_argument("--drops", type=Path, help="CSV of other drops")
    add_out(parser, "real")
    options = parser.parse_args(arguments)
    program = "real"
    for name in options.sets:
        if name not in known:
            parser.error(f"{name}: allowed are {', '.join(known)}")
    if options.sets == ["walkers"]:
        program, options.sets = "real walkers", WALKERS
        options.out = options.out.with_name("walkers.json")
    kept = json.loads(options.out.read_text()) if options.out.is_file() else {}
    found: dict[str, Any] = kept.get("rows", {})
    wrong = False
    try:
        print(line(name.replace("_", " ") for name in SHOWN), line(["---"] * len(SHOWN)), sep="\n")
        for name in options.sets or NAMES:
            for measured in measured_sets(name, options.drops):
                for listed in (True, False):
                    made = row(measured, listed)
                    wrong |= made.judgement.startswith("wrong")
                    print(line(getattr(made, name) for name in SHOWN), flush=True)
                    key = f"{made.set}, listed: {made.listed}"
                    found[key] = {**asdict(made), "golden": digest()}
                    saved(options.out, program, {"rows": found}, said=False)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    print("", by_tool(found.values()), f"written: {options.out}", sep="\n")
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
