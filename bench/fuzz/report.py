"""What a search came to: one table for a reader, one file for a program."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import measure
import numpy

import stickslip
from stickslip import _core

Row = dict[str, Any]

# Failures that are printed of each check and population.
_SHOWN = 20

_OVER = (1e-3, 1e-2)


def judged(row: Row) -> list[str]:
    """Why a row failed; empty if it did not."""
    extreme = row["name"].startswith("extreme") or row["check"] == "files"
    if row["how"] == "hang":
        return ["hangs, and hears no interrupt"]
    if row["how"] == "crash":
        return [f"crash, exit status {row['code']}"]
    if row["how"] == "slow" and not extreme:
        return [f"not done after {row['seconds']:.0f} s"]
    return list(row["failures"])


def groups(rows: list[Row]) -> dict[tuple[str, str], list[Row]]:
    """Rows by check and population, or by check and kind of file."""
    result: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        result.setdefault((row["check"], row["name"].split(":")[0]), []).append(row)
    return dict(sorted(result.items()))


def figures(rows: list[Row]) -> Row:
    """Counts of one group, and for compared velocities the shares that are off."""
    failed = [row for row in rows if judged(row)]
    result: Row = {
        "count": len(rows),
        "failed": len(failed),
        "kinds": dict(Counter(row["kind"] or row["how"] for row in rows)),
        "slowest": max(row["seconds"] for row in rows),
        "failures": [{"name": row["name"], "why": judged(row)} for row in failed],
    }
    compared = [row for row in rows if "difference" in row]
    if compared:
        worst = sorted(compared, key=lambda row: -row["difference"])
        result["worst"] = [(row["name"], row["difference"], row["kind"]) for row in worst[:_SHOWN]]
        for limit in _OVER:
            off = sum(row["difference"] > limit for row in compared)
            certain = sum(
                row["difference"] > limit and row["kind"] != "sensitive" for row in compared
            )
            result[f"over {limit:g}"] = {
                "share": off / len(compared),
                "share_not_sensitive": certain / len(compared),
            }
    return result


def table(rows: list[Row]) -> str:
    """Counts, then failures by name, then shares."""
    lines = [f"{'check':12} {'of':12} {'count':>7} {'failed':>7} {'slowest':>8}  kinds"]
    tail: list[str] = []
    for (check, kind), mine in groups(rows).items():
        got = figures(mine)
        kinds = ", ".join(f"{name} {count}" for name, count in sorted(got["kinds"].items()))
        lines.append(
            f"{check:12} {kind:12} {got['count']:7} {got['failed']:7} "
            f"{got['slowest']:6.1f} s  {kinds}"
        )
        for each in got["failures"][:_SHOWN]:
            tail.append(f"  {check} {each['name']}: {'; '.join(each['why'])[:300]}")
        for limit in _OVER:
            share = got.get(f"over {limit:g}")
            if share:
                tail.append(
                    f"  {check} {kind}: {share['share']:.2%} off by more than {limit:.1%}, "
                    f"{share['share_not_sensitive']:.2%} without those that are sensitive"
                )
    return "\n".join([*lines, "", *tail]) if tail else "\n".join(lines)


def write(folder: Path, rows: list[Row], options: dict[str, Any]) -> None:
    """Counts and failures with machine and versions, to ``summary.json``."""
    content = {
        "machine": measure.machine(),
        "versions": {
            "stickslip": stickslip.__version__,
            "arkode": _core.has_arkode,
            "numpy": numpy.__version__,
        },
        "options": {key: str(value) for key, value in options.items()},
        "groups": {" ".join(key): figures(mine) for key, mine in groups(rows).items()},
    }
    (folder / "summary.json").write_text(json.dumps(content, indent=2) + "\n")
