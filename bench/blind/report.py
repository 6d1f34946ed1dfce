"""The tables of a blind study in Markdown.

``python -m blind.report RECORD`` prints those of a record.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from blind.questions import Row, causes_said, found
from blind.scoring import by_cause, calibration, counted, judged, read

# What a diagnosis may cost, CPU seconds: in the median, and at most (two minutes on two cores).
_MEDIAN, _MOST = 20.0, 240.0


# Families of kinds in a reader's words.
FAMILY_WORDS = {
    "none": "nothing",
    "none, hard": "nothing, hard noise",
    "none, correlated": "nothing, errors correlated",
    "constant 3 sd": "a constant 3 sd off",
    "constant 5 sd": "a constant 5 sd off",
    "single": "one cause, S of 6 or more",
    "single, correlated": "one cause, errors correlated",
    "weak": "one cause, S = 4",
    "near twins": "one of near twins",
    "exact twins": "one of exact twins",
    "pair": "two causes",
    "hiding": "two, of which one hides the other",
    "unknown": "a wave that no cause has",
    "law": "a law outside the library",
    "instrument": "an instrument",
    "none, correlated strong": "nothing, errors strongly correlated",
    "model error": "one cause, and an error of the model",
    "unlisted": "a strong cause that no list has",
    "shuffled": "nothing, readings shuffled",
}


def table(rows: Sequence[Row]) -> str:
    """Counts of each family beside what is asked, calibration of the probabilities, and cost."""
    lines = _counts(rows, pooled=True)
    lines += ["", "| most likely, thought to be so by | on average | true |", "| --- | --- | --- |"]
    lines += [
        f"| {each['from']:.0%} to {each['to']:.0%} | {each['mean']:.0%} "
        f"| {each['count']} of {each['total']}, {each['count'] / each['total']:.0%} |"
        for each in calibration(rows)
    ]
    return "\n".join([*lines, *_cost(rows)])


def _counts(rows: Sequence[Row], pooled: bool) -> list[str]:
    """Counts beside what is asked, by kind or pooled by family."""
    lines = [
        "| hidden | counted | count | share | 95 % interval | asked | met |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for each in judged(rows, pooled):
        bound = "at most" if each["at_most"] else "at least"
        asked = "-" if each["asked"] is None else f"{bound} {each['asked']:.0%}"
        met = {None: "-", True: "yes", False: "no"}[each["met"]]
        lines.append(
            f"| {FAMILY_WORDS[each['kind']] if pooled else each['kind']} | {each['what']} "
            f"| {each['count']} of {each['total']} | {each['count'] / each['total']:.0%} "
            f"| {each['low']:.0%} to {each['high']:.0%} | {asked} | {met} |"
        )
    return lines


def _cost(rows: Sequence[Row]) -> list[str]:
    seconds = [row["cpu_seconds"] for row in rows]
    if not seconds:
        return []
    some = [row["cpu_seconds"] for row in rows if found(row)] or [0.0]
    return [
        "",
        f"{len(rows)} data sets of up to 30 conditions; a diagnosis took {np.median(seconds):.0f} "
        f"s CPU time in the median (asked: {_MEDIAN:.0f}), {np.median(some):.0f} s where "
        f"something is found, {max(seconds):.0f} s at most (asked: {_MOST:.0f}).",
    ]


def cause_table(rows: Sequence[Row]) -> str:
    """Counts by cause and kind."""
    lines = [
        "| cause | hidden as | data sets | in the set | named | wrong claims |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    lines += [
        f"| {each['cause']} | {each['kind']} | {each['total']} | {each['in_set']} "
        f"| {each['named']} | {each['wrong']} |"
        for each in by_cause(rows)
    ]
    return "\n".join(lines)


def misses(rows: Sequence[Row]) -> str:
    """Every data set that missed what is asked: kind, seed, truth, and what was said."""
    by_name = {(row["answer"]["kind"], row["answer"]["seed"]): row for row in rows}
    failed: dict[tuple[str, int], list[str]] = {}
    for each in judged(rows):
        for seed in each["missed"]:
            failed.setdefault((each["kind"], seed), []).append(each["what"])
    lines = [
        "| kind | seed | truth | S | said | missed |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for (kind, seed), what in sorted(failed.items()):
        row = by_name[kind, seed]
        truth = row["answer"].get("hook") or " + ".join(row["answer"]["answer"]) or "-"
        said = " ".join([row["said"]["verdict"], ", ".join(sorted(causes_said(row)))])
        lines.append(
            f"| {kind} | {seed} | {truth} | {row['answer']['strength']:.1f} | {said} "
            f"| {'; '.join(what)} |"
        )
    return "\n".join(lines)


def report(rows: Sequence[Row]) -> str:
    """All tables, and what they are of."""
    parts = [table(rows)]
    left = len(rows) - len(counted(rows))
    if left:
        parts.append(
            f"Not counted: {left} data sets whose hidden cause cannot be as strong as asked for."
        )
    states = {tuple(sorted(row.get("state", {}).items())) for row in rows}
    parts += [", ".join(f"{key} {value}" for key, value in each) for each in sorted(states) if each]
    kinds = "\n".join(["Each kind by itself:", "", *_counts(rows, pooled=False)])
    return "\n\n".join([*parts, kinds, cause_table(rows), misses(rows)])


if __name__ == "__main__":
    print(report(read(Path(sys.argv[1]))))
