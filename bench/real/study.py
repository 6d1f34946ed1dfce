"""``python -m bench real [SET ...]``: measured sets with a known cause, diagnosed and judged.

Each set is diagnosed twice: with the cause that acts among those that are listed, and without it.
Rows are written as they come, into a file that keeps those of other sets. `walkers` are rollers,
tumbler, drops and the walk of the README, whose rows go into a file of their own. The status is 1
where a wrong cause is claimed.
"""

from __future__ import annotations

import argparse
import json
import runpy
import sys
from dataclasses import asdict, fields
from functools import partial
from pathlib import Path
from typing import Any

from cases.axis import case as axis
from cases.tanks import case as tanks
from measure import add_out, saved
from stale import digest

from . import impacts, robots, slider
from .flights import read_drops
from .score import Measured, Row, Truth, row

HERE = Path(__file__).parent
DATA = HERE.parents[1] / "tests" / "data"
DROPS = DATA / "square_drops.csv.gz"
MACHINES = {path.parent.name: path for path in sorted(HERE.glob("machines/*/machine.py"))}
NAMES = ("tumbler", "rollers", "axis", "tanks", "slider", "drops", *MACHINES)
WALKERS = ("tumbler", "rollers", "drops", "walk")

AXIS = Truth(("viscous_asymmetry",), values={"viscous_asymmetry.half": (36.86, 0.87)})
TANKS = Truth(("upper_overflow", "lower_overflow", "sensor_end"))


def measured_sets(name: str, drops: Path = DROPS) -> list[Measured]:
    """The sets of a name, as tables or in time."""
    if name == "tumbler":
        turned = partial(robots.diagnose_files, robots.TUMBLER_CASE, "angle")
        return [Measured("tumbler", (57.2958, "degrees"), robots.TUMBLER, turned)]
    if name == "walk":
        path = robots.EXAMPLES / "measurement.toml"
        walked = partial(robots.diagnose_files, path, "fraction")
        return [Measured("walk of the README, simulated", (1e6, "um/s"), robots.WALK, walked)]
    if name == "rollers":
        path = DATA / "roller_velocity.csv"
        rolled = partial(robots.diagnose_rollers, path)
        return [Measured("rollers", (1e6, "um/s"), robots.ROLLERS, rolled)]
    if name == "axis":
        return [
            Measured(f"axis, {how}", (1.0, "N"), AXIS, diagnosed)
            for how, diagnosed in (
                ("ten segments", axis.diagnosed),
                ("20 Hz", axis.diagnose_in_time),
                ("four repeats", axis.diagnose_repeats),
            )
        ]
    if name == "tanks":
        return [Measured("tanks", (1.0, "V"), TANKS, tanks.diagnosed)]
    if name == "slider":
        slid = partial(slider.diagnose_slider, DATA / "slider_events.csv")
        return [Measured("slider", (1e3, "mN/N"), slider.TRUTH, slid)]
    if name in MACHINES:
        return list(runpy.run_path(str(MACHINES[name]))["SETS"])
    read = read_drops(drops)
    first = impacts.first_impacts(read)
    return [
        Measured(
            f"{len(read)} drops, {what}", unit, truth,
            partial(impacts.diagnose_impacts, pose, first),
        )
        for what, unit, truth, pose in (
            ("heights", (1e3, "mm"), impacts.HEIGHTS, impacts.heights),
            ("velocities", (1e3, "mm/s"), impacts.VELOCITIES, impacts.velocities),
        )
    ]  # fmt: skip


def text(found: Row) -> str:
    """A row as Markdown, without what speaks against a claim."""
    cells = [str(value) for key, value in asdict(found).items() if key != "reasons"]
    return "| " + " | ".join(cells) + " |"


def heads() -> str:
    """The head of the table as Markdown."""
    names = [each.name.replace("_", " ") for each in fields(Row) if each.name != "reasons"]
    return "\n".join("| " + " | ".join(line) + " |" for line in (names, ["---"] * len(names)))


def main(arguments: list[str] | None = None) -> int:
    """Diagnose, print and write; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m bench real", description=__doc__)
    known = ("walkers", *NAMES)
    parser.add_argument("sets", nargs="*", metavar="SET", help=", ".join(known))
    parser.add_argument("--drops", type=Path, default=DROPS, help="CSV of drops")
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
        print(heads())
        for name in options.sets or NAMES:
            for measured in measured_sets(name, options.drops):
                for listed in (True, False):
                    made = row(measured, listed)
                    wrong |= made.judgement.startswith("wrong")
                    print(text(made), flush=True)
                    key = f"{made.set}, listed: {made.listed}"
                    found[key] = {**asdict(made), "golden": digest()}
                    saved(options.out, program, {"rows": found}, said=False)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    print(f"written: {options.out}")
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
