"""Counts of a blind study beside what is asked, with 95 % intervals (Clopper and Pearson).

``python -m blind.scoring RECORD`` prints the table of a record.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import beta

Row = dict[str, Any]

# Parameters whose library form is the generator's too, so that their values can be compared.
_SAME_FORM = {
    "surface_tilt.angle", "ambient_field.Bx", "ambient_field.Bz", "misalignment.angle",
    "rotational_drag.coefficient", "eddy_lag.time", "edge_time.time", "field_gain.clamp",
    "field_gain.in_plane", "restitution.coefficient",
}  # fmt: skip


def interval(count: int, total: int) -> tuple[float, float]:
    """95 % interval of a share."""
    low = 0.0 if count == 0 else float(beta.ppf(0.025, count, total - count + 1))
    high = 1.0 if count == total else float(beta.ppf(0.975, count + 1, total - count))
    return low, high


def _truth(row: Row) -> set[str]:
    return set(row["answer"]["answer"])


def _verdict(row: Row) -> str:
    return str(row["said"]["verdict"])


def _said(row: Row) -> set[str]:
    cause = row["said"]["cause"]
    return set() if cause is None else {cause} if isinstance(cause, str) else set(cause)


def _alarm(row: Row) -> bool:
    return _verdict(row) != "none"


def _named(row: Row) -> bool:
    return _verdict(row) == "named"


def _right(row: Row) -> bool:
    return _named(row) and _said(row) == _truth(row)


def _claimed(row: Row) -> bool:
    return _verdict(row) in ("named", "pair")


def _wrong(row: Row) -> bool:
    return _claimed(row) and _said(row) != _truth(row)


def _structure(row: Row) -> bool:
    """A claim of something that is no constant, or a set that has none."""
    structural = ["." not in name for name in _said(row)]
    return any(structural) if _claimed(row) else bool(structural) and all(structural)


def _found(row: Row) -> bool:
    return _verdict(row) not in ("none", "data-problem")


def _in_set(row: Row) -> bool:
    """The truth is what is said or among it."""
    truth = _truth(row)
    return bool(truth) and truth <= _said(row)


def _first(row: Row) -> bool:
    chance = {name: p for name, p in row["said"]["probabilities"].items()
              if name not in ("none", "unknown")}  # fmt: skip
    return max(chance, key=lambda name: chance[name], default="") in _truth(row)


def _within(row: Row) -> bool:
    """All comparable parameters of a right name within two standard deviations."""
    return all(abs(gap) <= 2.0 for gap in _pulls(row))


def _pulls(row: Row) -> list[float]:
    result = []
    for name, each in row["said"]["parameters"].items():
        if name in _SAME_FORM:
            effect, parameter = name.split(".")
            truth = row["answer"]["effects"].get(effect, {}).get(parameter, 0.0)
            result.append((each["value"] - truth) / max(each["sd"], 1e-300))
    return result


def _comparable(row: Row) -> bool:
    return _right(row) and bool(_pulls(row))


def _gained(row: Row) -> bool:
    gain = row["said"]["gain"]
    return bool(gain["heldout_chi2_after"] < gain["heldout_chi2_before"])


def _consistent(row: Row) -> bool:
    return bool(row["gain"]["p_value"] > 0.05)


def _followed(row: Row) -> bool:
    return "followed" in row


def _right_after(row: Row) -> bool:
    after = {**row, "said": row["followed"]}
    return _right(after)


# kind, what is counted, among which, share asked for, whether at most
_DEMANDS: tuple[tuple[str, str, Callable[[Row], bool], Callable[[Row], bool] | None, float, bool],
                ...] = (
    ("none", "false alarm", _alarm, None, 0.05, True),
    ("none, hard", "false alarm", _alarm, None, 0.08, True),
    ("constant 3 sd", "structure blamed", _structure, None, 0.05, True),
    ("constant 5 sd", "that constant named", _right, None, 0.80, False),
    ("constant 5 sd", "structure blamed", _structure, None, 0.05, True),
    ("single", "first in rank", _first, None, 0.92, False),
    ("single", "named", _named, None, 0.75, False),
    ("single", "right when named", _right, _named, 0.98, False),
    ("single", "parameters within 2 sd when rightly named", _within, _comparable, 0.90, False),
    ("single", "held-out error consistent when rightly named", _consistent, _right, 0.90, False),
    ("single", "held-out better when rightly named", _gained, _right, 0.89, False),
    ("single", "a pair claimed", lambda row: _verdict(row) == "pair", None, float("nan"), True),
    ("weak", "detected", _found, None, 0.70, False),
    ("weak", "in the set when detected", _in_set, _found, 0.92, False),
    ("weak", "wrongly named", _wrong, None, 0.02, True),
    ("near twins", "in the set or right, of detected", _in_set, _found, 0.90, False),
    ("near twins", "wrongly named", _wrong, None, 0.03, True),
    ("near twins", "rightly named before more experiments", _right, _followed, float("nan"), False),
    ("near twins", "rightly named after three proposed", _right_after, _followed, float("nan"),
     False),
    ("exact twins", "in the set or right, of detected", _in_set, _found, 0.90, False),
    ("exact twins", "wrongly named", _wrong, None, 0.03, True),
    ("pair", "exact pair", lambda row: _verdict(row) == "pair" and _said(row) == _truth(row), None,
     0.80, False),
    ("pair", "both in what is said", _in_set, None, float("nan"), False),
    ("pair", "a single cause named", _named, None, float("nan"), True),
    ("unknown", "unexplained", lambda row: _verdict(row) == "unexplained", None, 0.85, False),
    ("unknown", "wrongly named", _named, None, 0.05, True),
    ("unknown", "a pair claimed", lambda row: _verdict(row) == "pair", None, 0.08, True),
    ("shuffled", "named", _claimed, None, 0.0, True),
)  # fmt: skip


def slim(row: Row) -> Row:
    """What the counts need of a row, and what makes the data set again."""
    answer = {key: row["answer"][key] for key in ("kind", "seed", "strength", "answer", "effects")}
    result = {
        "folder": row["folder"],
        "answer": answer,
        "said": _slim(row["said"]),
        "gain": row["gain"],
        "cpu_seconds": round(row["cpu_seconds"], 1),
    }
    return {**result, "followed": _slim(row["followed"])} if _followed(row) else result


def _slim(said: dict[str, Any]) -> dict[str, Any]:
    keys = ("verdict", "cause", "p_value", "parameters", "gain")
    likely = sorted(said["probabilities"].items(), key=lambda item: -item[1])[:5]
    return {**{key: said[key] for key in keys}, "probabilities": dict(likely)}


def read(path: Path) -> list[Row]:
    """Rows of a record of a study."""
    return [json.loads(line) for line in path.read_text().splitlines()]


def judged(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Count, total, interval and demand of each line of the table."""
    result = []
    for kind, what, counts, among, asked, at_most in _DEMANDS:
        mine = [row for row in rows if row["answer"]["kind"] == kind]
        mine = [row for row in mine if among is None or among(row)]
        if not mine:
            continue
        count = sum(counts(row) for row in mine)
        low, high = interval(count, len(mine))
        result.append(
            {
                "kind": kind, "what": what, "count": count, "total": len(mine), "low": low,
                "high": high, "asked": asked, "at_most": at_most,
            }
        )  # fmt: skip
    return result


_SURE = ((0.0, 0.5), (0.5, 0.8), (0.8, 0.95), (0.95, 1.0))


def calibration(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """How often what was thought most likely was true, by how likely it was thought to be.

    Of data sets with one answer: a cause, none, or one that is not in the library.
    """
    thought = []
    for row in rows:
        kind = row["answer"]["kind"]
        truth = {"none": "none", "none, hard": "none", "unknown": "unknown"}.get(kind)
        if kind in ("constant 5 sd", "single", "weak", "near twins"):
            (truth,) = row["answer"]["answer"]
        if truth is not None:
            chance = row["said"]["probabilities"]
            best = max(chance, key=lambda name: chance[name])
            thought.append((chance[best], best == truth))
    result = []
    for low, high in _SURE:
        inside = [(p, right) for p, right in thought if low <= p < high or p == high == 1.0]
        if inside:
            count = sum(right for _, right in inside)
            result.append(
                {
                    "from": low, "to": high, "mean": float(np.mean([p for p, _ in inside])),
                    "count": count, "total": len(inside),
                }
            )  # fmt: skip
    return result


def table(rows: Sequence[Row]) -> str:
    """The study in Markdown."""
    lines = [
        "| hidden | counted | count | share | 95 % interval | asked |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for each in judged(rows):
        bound = "at most" if each["at_most"] else "at least"
        asked = "-" if each["asked"] != each["asked"] else f"{bound} {each['asked']:.0%}"
        lines.append(
            f"| {each['kind']} | {each['what']} | {each['count']} of {each['total']} "
            f"| {each['count'] / each['total']:.0%} | {each['low']:.0%} to {each['high']:.0%} "
            f"| {asked} |"
        )
    lines += ["", "| most likely, thought to be so by | on average | true |", "| --- | --- | --- |"]
    lines += [
        f"| {each['from']:.0%} to {each['to']:.0%} | {each['mean']:.0%} "
        f"| {each['count']} of {each['total']}, {each['count'] / each['total']:.0%} |"
        for each in calibration(rows)
    ]
    seconds = [row["cpu_seconds"] for row in rows]
    found = [row["cpu_seconds"] for row in rows if _found(row)]
    if seconds:
        lines.append("")
        lines.append(
            f"{len(rows)} data sets of up to 30 conditions; where something is found, a diagnosis "
            f"takes {np.median(found) if found else 0.0:.0f} s CPU time in the median, "
            f"{max(seconds):.0f} s at most."
        )
    return "\n".join(lines)


if __name__ == "__main__":
    print(table(read(Path(sys.argv[1]))))
