"""Counts of a blind study beside what is asked, with 95 % intervals of Wilson (1927)."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from blind.kinds import KINDS
from blind.questions import (
    Row,
    alarm,
    alike,
    any_claim,
    any_row,
    band_holds,
    band_holds_all,
    comparable,
    comparable_beside,
    consistent,
    dominant,
    exact_pair,
    false_cause,
    false_term,
    few_members,
    first_in_rank,
    followed,
    followed_right,
    form_right,
    form_said,
    found,
    gained,
    halved,
    halved_by_truth,
    hook_right,
    in_few,
    in_set,
    instrument_said,
    named,
    pair_claimed,
    parameters_within,
    physical_claimed,
    right_beside_error,
    right_shape,
    right_when_dominant,
    rightly_named,
    second_said,
    set_said,
    strong_enough,
    structure_blamed,
    unexplained,
    unlike,
    wrongly_claimed,
    wrongly_dominant_beside_error,
    wrongly_dominant_unlisted,
    wrongly_named_beside_error,
    wrongly_named_unlisted,
)

Counts = Callable[[Row], bool]

_NORMAL = 1.959964  # 97.5 % point


def interval(count: int, total: int) -> tuple[float, float]:
    """95 % interval of a share, by Wilson's score."""
    share, square = count / total, _NORMAL**2
    middle = share + square / (2 * total)
    half = _NORMAL * np.sqrt(share * (1.0 - share) / total + square / (4 * total**2))
    scale = 1.0 + square / total
    low, high = (middle - half) / scale, (middle + half) / scale
    # At the ends the formula gives 0 and 1 up to rounding.
    return (0.0 if count == 0 else float(low)), (1.0 if count == total else float(high))


# Family, what is counted, by which questions, of which rows, limit, and whether that is the most.
_OPEN = float("nan")
# Of two grades of a claim, the lower one; of sets, those that are small enough to be an answer.
_DOMINANT = ("right when dominant", right_when_dominant, dominant, _OPEN, False)
_MEMBERS = ("sets of at most six causes", few_members, set_said, _OPEN, False)
_SINGLE = (
    ("first in rank", first_in_rank, any_row, 0.92, False),
    ("named", named, any_row, 0.75, False),
    ("right when named", rightly_named, named, 0.98, False),
    ("parameters within 2 sd when rightly named", parameters_within, comparable, 0.90, False),
    ("held-out error consistent when rightly named", consistent, rightly_named, 0.90, False),
    ("held-out better when rightly named", gained, rightly_named, 0.89, False),
    ("a pair claimed", pair_claimed, any_row, _OPEN, True),
    _DOMINANT,
    _MEMBERS,
)
_TWINS = (
    ("in the set or right, of detected", in_set, found, 0.90, False),
    ("wrongly named", wrongly_claimed, any_row, 0.03, True),
    _DOMINANT,
    _MEMBERS,
)
_Demand = tuple[str, Counts, Counts, float, bool]
DEMANDS: dict[str, tuple[_Demand, ...]] = {
    "none": (("false alarm", alarm, any_row, 0.05, True),),
    "none, hard": (("false alarm", alarm, any_row, 0.08, True),),
    "none, correlated": (
        ("false alarm", alarm, any_row, 0.05, True),
        ("wrongly named", any_claim, any_row, 0.02, True),
    ),
    "constant 3 sd": (("structure blamed", structure_blamed, any_row, 0.05, True),),
    "constant 5 sd": (
        ("that constant named", rightly_named, any_row, 0.80, False),
        ("structure blamed", structure_blamed, any_row, 0.05, True),
    ),
    "single": _SINGLE,
    "single, correlated": (
        ("in the set when detected", in_set, found, _OPEN, False),
        ("wrongly named", wrongly_claimed, any_row, 0.02, True),
        _DOMINANT,
        _MEMBERS,
    ),
    "weak": (
        ("detected", found, any_row, 0.70, False),
        ("in the set when detected", in_set, found, 0.92, False),
        ("the same, in at most six causes", in_few, found, _OPEN, False),
        ("wrongly named", wrongly_claimed, any_row, 0.02, True),
        _DOMINANT,
        _MEMBERS,
    ),
    "near twins": (
        *_TWINS,
        ("rightly named before more experiments", rightly_named, any_row, _OPEN, False),
        ("rightly named after three proposed", followed_right, any_row, 0.90, False),
    ),
    "exact twins": _TWINS,
    "pair": (
        ("exact pair", exact_pair, any_row, 0.80, False),
        ("both in what is said", in_set, any_row, _OPEN, False),
        ("a single cause named", named, any_row, _OPEN, True),
        _DOMINANT,
        _MEMBERS,
    ),
    "hiding": (
        ("the second said", second_said, any_row, 0.75, False),
        ("exact pair", exact_pair, any_row, _OPEN, False),
        ("a wrong cause claimed", false_cause, any_row, _OPEN, True),
        _DOMINANT,
        _MEMBERS,
    ),
    "unknown": (
        ("unexplained", unexplained, any_row, 0.85, False),
        ("wrongly named", named, any_row, 0.05, True),
        ("a pair claimed", pair_claimed, any_row, 0.08, True),
        _DOMINANT,
    ),
    "law": (
        ("hook right", hook_right, any_row, 0.70, False),
        ("false terms", false_term, any_row, 0.05, True),
        ("its formula has the right form", form_right, right_shape, 0.50, False),
        ("this formula or one nearly as likely has it", form_said, right_shape, _OPEN, False),
        ("the band holds the truth on 80 % of its range", band_holds, right_shape, _OPEN, False),
        ("the band holds all of it", band_holds_all, right_shape, 0.90, False),
        ("held-out error at least halved", halved, any_row, 0.80, False),
        ("the same, where the truth itself halves it", halved, halved_by_truth, _OPEN, False),
        ("unexplained", unexplained, any_row, _OPEN, False),
    ),
    "instrument": (
        ("in the set or named", instrument_said, any_row, 0.90, False),
        ("a physical cause claimed in its place", physical_claimed, any_row, 0.02, True),
        ("detected or a problem of the data", alarm, any_row, _OPEN, False),
        ("right when dominant", instrument_said, dominant, _OPEN, False),
    ),
    "none, correlated strong": (
        ("false alarm", alarm, any_row, _OPEN, True),
        ("named, a pair or dominant", any_claim, any_row, 0.02, True),
    ),
    "model error": (
        ("right as named or dominant", right_beside_error, any_row, 0.75, False),
        ("wrongly named", wrongly_named_beside_error, any_row, 0.03, True),
        ("wrongly dominant", wrongly_dominant_beside_error, any_row, 0.03, True),
        ("first in rank", first_in_rank, any_row, _OPEN, False),
        ("parameters within 2 sd when right", parameters_within, comparable_beside, 0.90, False),
        ("unexplained", unexplained, any_row, _OPEN, False),
    ),
    "unlisted": (
        ("unlike all causes: wrongly named", wrongly_named_unlisted, unlike, 0.03, True),
        ("unlike all causes: wrongly dominant", wrongly_dominant_unlisted, unlike, 0.10, True),
        ("unlike all causes: unexplained", unexplained, unlike, _OPEN, False),
        ("like a cause: wrongly named", wrongly_named_unlisted, alike, 0.03, True),
        ("like a cause: said to act like one", dominant, alike, _OPEN, False),
        ("like a cause: unexplained", unexplained, alike, _OPEN, False),
    ),
    "shuffled": (("named", any_claim, any_row, 0.0, True),),
}  # fmt: skip


def read(path: Path) -> list[Row]:
    """Rows of a record of a study, of each data set the last one."""
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    return list({(row["answer"]["kind"], row["answer"]["seed"]): row for row in rows}.values())


def slim(row: Row) -> Row:
    """What the counts need of a row, and what makes the data set again."""
    result = {**row, "said": _slim(row["said"]), "cpu_seconds": round(row["cpu_seconds"], 1)}
    return {**result, "followed": _slim(row["followed"])} if followed(row) else result


def _slim(said: dict[str, Any]) -> dict[str, Any]:
    keys = ("verdict", "cause", "p_value", "parameters", "gain")
    shape = said.get("open_set")
    if shape is not None:
        curve = {name: shape["curve"][name][::5] for name in ("argument", "low", "high")}
        formula = shape["formula"]
        shape = {
            "accepted": shape["accepted"], "gain": shape["gain"], "curve": curve,
            "effect": shape["hooks"][0]["effect"],
            "formula": None if formula is None else formula["text"],
            "others": [] if formula is None else formula["others"],
        }  # fmt: skip
    likely = sorted(said["probabilities"].items(), key=lambda item: -item[1])[:5]
    kept = {key: said[key] for key in keys}
    return {**kept, "probabilities": dict(likely), "open_set": shape}


def counted(rows: Sequence[Row]) -> list[Row]:
    """Rows whose hidden things are as strong as their kind asks for."""
    return [row for row in rows if strong_enough(row)]


def judged(rows: Sequence[Row], pooled: bool = False) -> list[dict[str, Any]]:
    """Count, total, interval and demand of each line of the table, and the seeds that missed it.

    By kind, or `pooled` over all kinds of a family.
    """
    result = []
    name_of = (lambda kind: KINDS[kind].family) if pooled else (lambda kind: kind)
    families = {name_of(kind): plan.family for kind, plan in KINDS.items()}
    for kind, family in families.items():
        mine = [row for row in counted(rows) if name_of(row["answer"]["kind"]) == kind]
        for what, counts, among, asked, at_most in DEMANDS[family]:
            some = [row for row in mine if among(row)]
            if not some:
                continue
            hits = [counts(row) for row in some]
            low, high = interval(sum(hits), len(some))
            share = sum(hits) / len(some)
            limited = asked == asked
            result.append(
                {
                    "kind": kind, "what": what, "count": sum(hits), "total": len(some), "low": low,
                    "high": high, "asked": asked if limited else None, "at_most": at_most,
                    "met": (share <= asked if at_most else share >= asked) if limited else None,
                    "missed": [row["answer"]["seed"] for row, hit in zip(some, hits, strict=True)
                               if limited and hit == at_most],
                }
            )  # fmt: skip
    return result


_SURE = ((0.0, 0.5), (0.5, 0.8), (0.8, 0.95), (0.95, 1.0))
_ONE_ANSWER = ("constant 5 sd", "single", "single, correlated", "weak", "near twins")


def calibration(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """How often what was thought most likely was true, by how likely it was thought to be.

    Of data sets with one answer: a cause, none, or one that is not in the library.
    """
    thought = []
    for row in rows:
        family = KINDS[row["answer"]["kind"]].family
        truth = "unknown" if family == "unknown" else None
        if family.startswith("none"):
            truth = "none"
        if family in _ONE_ANSWER:
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


def by_cause(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Of each cause that is hidden by itself: how often it is in the set, named, and wrongly so."""
    mine: dict[tuple[str, str], list[Row]] = {}
    for row in counted(rows):
        names = row["answer"]["answer"]
        hook = row["answer"].get("hook")
        # Shuffled labels leave nothing to be found.
        if (len(names) == 1 or hook) and row["answer"]["kind"] != "shuffled":
            mine.setdefault((hook or names[0], row["answer"]["kind"]), []).append(row)
    result = []
    for (name, kind), some in sorted(mine.items()):
        law = KINDS[kind].family in ("law", "unlisted")
        right, wrong = (hook_right, false_term) if law else (in_set, wrongly_claimed)
        result.append(
            {
                "cause": name, "kind": kind, "total": len(some), "in_set": sum(map(right, some)),
                "named": sum(map(named, some)), "wrong": sum(map(wrong, some)),
            }
        )  # fmt: skip
    return result
