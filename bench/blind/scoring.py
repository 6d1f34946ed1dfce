"""Counts of a blind study, with 95 % binomial intervals (Clopper and Pearson)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from scipy.stats import beta


def interval(count: int, total: int) -> tuple[float, float]:
    """95 % interval of a share."""
    low = 0.0 if count == 0 else float(beta.ppf(0.025, count, total - count + 1))
    high = 1.0 if count == total else float(beta.ppf(0.975, count + 1, total - count))
    return low, high


def judge(answer: dict[str, Any], said: dict[str, Any]) -> str:
    """right, wrong, in the set, not in the set, missed, or unexplained, for one data set."""
    verdict, cause, truth = said["verdict"], said["cause"], set(answer["answer"])
    kind = answer["kind"]
    if kind in ("none", "shuffled"):
        return "quiet" if verdict in ("none", "data-problem", "unexplained") else "alarm"
    if verdict in ("none", "data-problem"):
        return "missed"
    if verdict == "unexplained":
        return "right" if kind == "unknown" else "unexplained"
    if verdict == "ambiguous":
        return "in the set" if truth and truth <= set(cause) else "not in the set"
    named = {cause} if verdict == "named" else set(cause)
    return "right" if named == truth else "wrong"


def table(rows: Sequence[dict[str, Any]]) -> str:
    """One line for each kind and outcome."""
    lines = [
        "| kind | outcome | count | share | 95 % interval |",
        "| --- | --- | --- | --- | --- |",
    ]
    for kind in dict.fromkeys(row["kind"] for row in rows):
        mine = [row for row in rows if row["kind"] == kind]
        for outcome in sorted({row["outcome"] for row in mine}):
            count = sum(row["outcome"] == outcome for row in mine)
            low, high = interval(count, len(mine))
            lines.append(
                f"| {kind} | {outcome} | {count}/{len(mine)} | {count / len(mine):.0%} "
                f"| {low:.0%} to {high:.0%} |"
            )
    return "\n".join(lines)
