"""Frozen data sets, diagnosed beside what was found before: ``python -m bench frozen``.

Verdicts of hard sets differ between two runs of one engine. So the chi-squares of no cause, of the
truth and of the cause that led stand beside those of before, each that of the best fit with the
errors as stated and with its prior's part. They are compared where the search over models ran.

A data set that the present engine has diagnosed is not diagnosed again. ``--pack FOLDER`` makes
`frozen/` from files of one data set each, ``{"row": ..., "set": ...}``.
"""

from __future__ import annotations

import argparse
import json
import lzma
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from blind import frozen
from blind.case import state
from blind.kinds import KINDS
from stickslip import Diagnosis, diagnose, read_measurement

Row = dict[str, Any]

_CLOSE = 1.0  # growth of a chi-square that does not count


def pack(folder: Path) -> int:
    """Make both files of frozen data sets from a folder; their number."""
    each = [json.loads(path.read_text()) for path in folder.glob("*.json")]
    each.sort(key=lambda one: (list(KINDS).index(one["set"]["kind"]), one["set"]["seed"]))
    frozen.SETS.parent.mkdir(parents=True, exist_ok=True)
    with lzma.open(frozen.SETS, "wt", preset=9) as file:
        file.writelines(json.dumps(one["set"]) + "\n" for one in each)
    frozen.ROWS.write_text("".join(json.dumps(one["row"]) + "\n" for one in each))
    return len(each)


def rerun(end: float, one: Row, old: Row) -> Row | None:
    """One data set, diagnosed; None after the time at which none is begun."""
    if time.monotonic() > end:
        return None
    with tempfile.TemporaryDirectory() as folder:
        measurement = read_measurement(frozen.unpacked(one, Path(folder)))
        begin = time.process_time()
        result = diagnose(measurement, threads=1)
        seconds = time.process_time() - begin
    return {**beside(result, old), "cpu_seconds": [old["cpu_seconds"], round(seconds, 1)]}


def beside(result: Diagnosis, old: Row) -> Row:
    """What is said of a data set and what was said before, each as [before, now]."""
    verdict, before = result.verdict, {each["name"]: each for each in old["candidates"]}
    names = {"none": "none", "leader": old["candidates"][0]["name"]}
    if not old["hook"]:
        names["truth"] = " + ".join(sorted(old["truth"])) or "none"
    searched = verdict.kind not in ("none", "data-problem")
    chi2 = {
        what: [before[name]["chi2"], _chi2(result, name)]
        for what, name in names.items()
        if searched and name in before
    }
    cause = old["cause"]
    said = [] if cause is None else [cause] if isinstance(cause, str) else cause
    return {
        "kind": old["kind"], "seed": old["seed"], "truth": old["truth"] or [old["hook"] or "-"],
        "verdict": [old["verdict"], verdict.kind], "causes": [said, list(verdict.causes)],
        "leader": names["leader"], "chi2": chi2, "share": verdict.share,
        "p_value": [old["p_value"], result.findings.test.p_value],
    }  # fmt: skip


def _chi2(result: Diagnosis, name: str) -> float | None:
    """Chi-square with the prior's part, as the engine before this one counted it."""
    fit = result.findings.models.get(() if name == "none" else name.split(" + "))
    if fit is None:
        return None
    own = fit.x[fit.free]
    return float(fit.chi2 + own @ fit.precision @ own)


def line(row: Row) -> str:
    """A data set in one line."""
    (said, now), (causes, new) = row["verdict"], row["causes"]
    shown = ["-" if not each else ", ".join(each[:4]) for each in (causes, new)]
    pairs = [
        f"{what} {old:.1f} {'-' if found is None else format(found, '.1f')}"
        for what, (old, found) in row["chi2"].items()
    ]
    share = "-" if row["share"] is None else f"{row['share']:.2f}"
    before, after = row["cpu_seconds"]
    return (
        f"{row['kind']} {row['seed']} | {' + '.join(row['truth'])} | {said} {shown[0]} -> "
        f"{now} {shown[1]} | {', '.join(pairs) or '-'} | {share} | {before:.0f} {after:.0f}"
    )


def summary(rows: Sequence[Row]) -> str:
    """Which verdicts are others, how many fits are as good as before, and the cost."""
    changed = [row for row in rows if _said(row, 0) != _said(row, 1)]
    lines = [f"{len(rows) - len(changed)} of {len(rows)} verdicts are those of before; others:"]
    lines += [f"  {line(row)}" for row in changed]
    for what, words in (("none", "no cause"), ("truth", "the truth"), ("leader", "the old leader")):
        pairs = [row["chi2"][what] for row in rows if what in row["chi2"]]
        close = sum(new is not None and new <= old + _CLOSE for old, new in pairs)
        missing = sum(new is None for _, new in pairs)
        lines.append(
            f"chi-square of {words} at most {_CLOSE:g} higher: {close} of {len(pairs)}, "
            f"{missing} not fitted"
        )
    costs = np.array([row["cpu_seconds"] for row in rows]).reshape(-1, 2)
    for which, words in (([True] * len(rows), "all"), (_found(rows), "with a finding")):
        some = costs[np.array(which, dtype=bool)]
        if len(some):
            before, after = np.median(some, axis=0)
            ratio = np.median(some[:, 1] / np.maximum(some[:, 0], 0.1))
            most = "{:.0f} and {:.0f}".format(*some.max(axis=0))
            lines.append(
                f"CPU s of {len(some)}, {words}: median {before:.1f} before, {after:.1f} now, "
                f"median ratio {ratio:.2f}; at most {most}"
            )
    return "\n".join(lines)


def _said(row: Row, which: int) -> tuple[str, set[str]]:
    return row["verdict"][which], set(row["causes"][which])


def _found(rows: Sequence[Row]) -> list[bool]:
    return [row["verdict"][1] not in ("none", "data-problem") for row in rows]


def main() -> None:
    """Diagnose, print and keep the rows; or make the files."""
    parser = argparse.ArgumentParser(prog="python -m bench frozen", description=__doc__)
    parser.add_argument("--minutes", type=float, default=600.0, help="begin none after this time")
    parser.add_argument("--kinds", default=";".join(KINDS), help="separated by semicolons")
    parser.add_argument("--jobs", type=int, default=1, help="data sets at a time")
    parser.add_argument("--out", type=Path, default=Path("bench/results/frozen.jsonl"))
    parser.add_argument("--pack", type=Path, help="only make the files, from those of this folder")
    options = parser.parse_args()
    if options.pack is not None:
        print(f"{pack(options.pack)} data sets")
        return
    kinds, engine, before = options.kinds.split(";"), state()["engine"], frozen.rows()
    out: Path = options.out
    out.parent.mkdir(parents=True, exist_ok=True)
    kept = [json.loads(each) for each in out.read_text().splitlines()] if out.exists() else []
    rows = [row for row in kept if row["engine"] == engine and row["kind"] in kinds]
    done = {(row["kind"], row["seed"]) for row in rows}
    waiting = [
        one
        for one in frozen.sets()
        if one["kind"] in kinds and (one["kind"], one["seed"]) not in done
    ]
    old = [before[one["kind"], one["seed"]] for one in waiting]
    print("kind, seed | truth | verdict before -> now | chi-squares | share | CPU s before, now")
    for row in rows:
        print(line(row), flush=True)
    end = time.monotonic() + 60.0 * options.minutes
    with ProcessPoolExecutor(options.jobs) as pool, out.open("a") as file:
        for row in pool.map(partial(rerun, end), waiting, old):
            if row is not None:
                rows.append({"engine": engine, **row})
                file.write(json.dumps(rows[-1]) + "\n")
                file.flush()
                print(line(row), flush=True)
    print(summary(rows))


if __name__ == "__main__":
    main()
