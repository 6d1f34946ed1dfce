"""``python -m bench planned``: does a planned table tell more than an even one?

Of a walker with one hidden cause, 12 drives that `plan` proposes and 12 even ones are measured,
each in three blocks, and diagnosed. Rows are kept as they come; a study that was stopped goes on.
"""

from __future__ import annotations

import argparse
import itertools
import json
import time
from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd
from blind.seeds import used
from blind.settings import priors
from measure import add_out, saved
from scores import Answer, share, until
from stale import digest, stale

from stickslip import Cause, Drive, Measurement, Scenario, diagnose, simulate_batch
from stickslip._util.toml import parse_toml
from stickslip.walker.experiments import CHOICES
from stickslip.walker.planning import NOISE, plan
from stickslip.walker.problem import posed_by

FIRST = 27200  # seeds; of no other study
COUNT, TRIALS, PULSES = 12, 3, 8
USUAL = 1.0, 2.0  # of the usual size of a cause
FLOOR = 0.5  # of the median speed, below which the noise falls no more
KEYS = [key.partition(".")[2] for key in CHOICES]


def stated() -> Scenario:
    """The walker as it is believed."""
    uncertain = {name: parse_toml(f"prior = {each.stated}")["prior"]
                 for name, each in priors(("velocity",)).items()}  # fmt: skip
    return Scenario(drive=Drive(base=0.5e-3, pulses=PULSES), uncertain=uncertain)


def even(scenario: Scenario) -> pd.DataFrame:
    """All combinations of two modes, two directions and three frequencies, in blocks."""
    drive = scenario.drive
    rows = [
        {"mode": mode, "direction": direction, "frequency": pace, "peak": drive.peak,
         "base": drive.base, "hold": drive.hold, "trial": trial, "block": f"block-{trial}"}
        for trial in range(1, TRIALS + 1)
        for mode, direction, pace in itertools.product(
            ("IPP", "OPP"), ("+x", "-x"), (50.0, 100.0, 150.0)
        )
    ]  # fmt: skip
    return pd.DataFrame(rows)


def hidden(scenario: Scenario, causes: list[Cause], seed: int) -> tuple[str, Scenario]:
    """A cause, and the walker that has it: constants by the priors, a size that is usual."""
    random = np.random.default_rng(seed)
    cause = causes[random.integers(len(causes))]
    (robot,) = scenario.draws(1, seed=seed)
    sign, size = random.choice([-1.0, 1.0]), random.uniform(*USUAL)
    changed = {}
    for each in cause.parameters:
        low, high = each.limits
        u = 0.0
        if each.is_amplitude:
            u = max((np.clip(way * size, low, high) for way in (sign, -sign)), key=abs)
        changed[each.name] = float(each.value(np.array([u]))[0])
    return cause.name, robot.replace(changed)


def measured(robot: Scenario, table: pd.DataFrame, random: np.random.Generator) -> pd.DataFrame:
    """The table with velocities of a robot."""
    used = [each for each in KEYS if each in table]
    drives = table[used].drop_duplicates()
    runs = simulate_batch(
        [robot.replace({f"drive.{key}": row[key] for key in used})
         for row in drives.to_dict("records")],
        threads=1,
    )  # fmt: skip
    known = drives.assign(v=[run.mean_velocity for run in runs])
    level = table[used].merge(known, how="left", on=used)["v"].to_numpy()
    sd = NOISE * np.maximum(np.abs(level), FLOOR * np.median(np.abs(level)))
    return table.assign(velocity=level + sd * random.standard_normal(len(table)))


def main(arguments: Iterable[str] | None = None) -> None:
    """Measure, diagnose, keep and count."""
    parser = argparse.ArgumentParser(prog="python -m bench planned", description=__doc__)
    parser.add_argument("--robots", type=int, default=60)
    parser.add_argument("--minutes", type=float, default=15.0, help="begin none after this time")
    add_out(parser, "planned")
    options = parser.parse_args(None if arguments is None else list(arguments))
    kept = json.loads(options.out.read_text()) if options.out.is_file() else {}
    rows: dict[str, Any] = kept.get("rows", {})
    print(*used("planned", range(FIRST, FIRST + options.robots)), sep="\n")
    scenario = stated()
    tables = {"planned": plan(scenario, COUNT, trials=TRIALS, threads=1).table(),
              "even": even(scenario)}  # fmt: skip
    about = Measurement.from_dataframe(tables["even"].assign(velocity=1e-3), scenario)
    known = set(Scenario.keys())
    # What acts on the robot, and not on what is read of it.
    causes = [each for each in posed_by(about).causes
              if each.parameters and {p.name for p in each.parameters} <= known]  # fmt: skip
    seeds = (seed for seed in range(FIRST, FIRST + options.robots) if str(seed) not in rows)
    for seed in until(options.minutes, seeds):
        cause, robot = hidden(scenario, causes, seed)
        row: dict[str, Any] = {"cause": cause, "golden": digest()}
        for name, table in tables.items():
            random, begin = np.random.default_rng([seed, 1]), time.process_time()
            seen = measured(robot, table, random)
            verdict = diagnose(Measurement.from_dataframe(seen, scenario), threads=1).verdict
            row[name] = {"said": verdict.kind, "causes": list(verdict.causes),
                         "cpu": round(time.process_time() - begin, 1)}  # fmt: skip
        rows[str(seed)] = row
        saved(options.out, "planned", {"counts": counts(rows), "rows": rows}, said=False)
        print(seed, row, flush=True)
    if rows:
        print(*stale(rows.values()), pd.DataFrame(counts(rows)).T.to_string(), sep="\n")


def counts(rows: dict[str, Any]) -> dict[str, dict[str, str]]:
    """Counts of each table: named rightly, named wrongly, one of a set."""
    found = {}
    for name in ("planned", "even"):
        told = [Answer(each[name]["said"], each[name]["causes"], [each["cause"]]).outcome
                for each in rows.values()]  # fmt: skip
        found[name] = {
            what: share(told.count(outcome), len(told)).replace(" ", f" of {len(told)} ", 1)
            for what, outcome in (("named rightly", "right name"), ("one of a set", "right set"),
                                  ("named wrongly", "wrong name"))
        }  # fmt: skip
    return found


if __name__ == "__main__":
    main()
