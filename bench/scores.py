"""Scores of answers beside the truth: the one place where answers of a diagnosis are counted.

A claim is right if it has all that is hidden and nothing else, a set if it holds it and has at most
`FEW` members. Silence is right where nothing that is listed is hidden, and else worth nothing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from stickslip.diagnosis.decision.verdict import CLAIMS

Row = dict[str, Any]
"""A row of the score: see `score.rows`."""
FEW = 3
"""Members of a set that is an answer. Chosen: standards of testability, as MIL-STD-2165, ask for
faults isolated to one, two or three units."""
OUTCOMES = ("right name", "right set", "large set", "silent", "wrong set", "wrong name",
            "rightly silent")  # fmt: skip
UNIT = "unit of "  # begins what is said of a wrong unit
RIVAL = "unlisted "  # begins the names of effects that nobody listed: one member of a set
LOW = 0.05  # p-value of a test that finds something
NEAR = 2.0  # standard errors between sizes that two forms of one log give


class Answer(NamedTuple):
    """A verdict or a word of another tool, its causes, and what is hidden of what is listed.

    also: Causes that may act besides; where they are stated, a part of what is hidden is an answer.
    """

    said: str
    causes: Collection[str]
    truth: Collection[str]
    also: Collection[str] | None = None

    @property
    def claims(self) -> bool:
        # A wrong unit is said without a claim.
        return self.said in CLAIMS or any(cause.startswith(UNIT) for cause in self.causes)

    @property
    def outcome(self) -> str:
        """One of `OUTCOMES`."""
        causes, truth = set(self.causes), set(self.truth)
        if self.also is not None:
            causes -= set(self.also)
            truth = truth & causes or truth
        rivals = {name for name in causes if name.startswith(RIVAL)}
        causes -= rivals
        if rivals and not truth:
            return "rightly silent"
        if not causes or not (self.claims or self.said == "ambiguous"):
            return "silent" if truth else "rightly silent"
        if self.claims:
            return "right name" if truth and causes == truth else "wrong name"
        if not truth or not truth <= causes:
            return "wrong set"
        return "right set" if len(causes) + bool(rivals) <= FEW else "large set"

    @property
    def credit(self) -> float:
        """1 for a right name, the share of a set that is true, 0 where it lacks the truth.

        Of one cause in a set this is the utility of ambiguity groups of the diagnostic competition
        DXC 2026 (https://github.com/jdekleer/dxc26synth, after Feldman and others, International
        Journal of Prognostics and Health Management 1, 2010), with silence at 0.
        """
        if self.outcome in ("right set", "large set"):
            return len(self.truth) / len(self.causes)
        return float(self.outcome == "right name")


def answer(row: Row) -> Answer:
    """The answer of a row.

    A size that is far from a known one makes a claim wrong. Of two logs, what both sides have is no
    difference; if their inputs are alike, `unexplained` is a change too.
    """
    said, causes = row["said"], [*row["causes"], *row.get("far", ())]
    truth = row["truth"] if row["listed"] else []
    if "alike" in row:
        causes = [name for name in causes if "[" in name]
        if said in (*CLAIMS, "ambiguous") and not causes:
            said = "none"
        if not truth and said == "unexplained" and row["alike"]:
            said, causes = "ambiguous", ["?"]
    return Answer(said, causes, truth, also=row.get("also"))


def counts(rows: Iterable[Row], plain: Mapping[str, Row]) -> Counter[str]:
    """Counts of each outcome, of sizes within their 95 % intervals, and of others.

    `plain` has the rows of the plain logs that others were made of, by problem.
    """
    found: Counter[str] = Counter()
    for row in rows:
        found["rows"] += 1
        if "state" in row:
            found[row["state"]] += 1
            continue
        found[answer(row).outcome] += 1
        if not row["truth"]:
            found["nothing"] += 1
            found["none"] += row["said"] == "none"
            found["low p"] += row.get("p", 1.0) < LOW
        for size in row.get("sizes", ()):
            found["sizes"] += 1
            found["held"] += size["low"] <= size["true"] <= size["high"]
        if row.get("plain") in plain:
            found["logs"] += 1
            found["as plain"] += is_like(row, plain[row["plain"]])
    return found


def is_like(row: Row, plain: Row) -> bool:
    """Whether a row says what that of the plain log says, with sizes near to its own."""
    sizes = [{size["name"]: size for size in each.get("sizes", ())} for each in (row, plain)]
    both = ((one, sizes[1][name]) for name, one in sizes[0].items() if name in sizes[1])
    said = [(each["said"], sorted(each["causes"])) for each in (row, plain)]
    return said[0] == said[1] and all(
        abs(one["estimate"] - other["estimate"]) <= NEAR * max(one["sd"], other["sd"])
        for one, other in both
    )


def interval(count: float, total: int) -> tuple[float, float]:
    """95 % interval of a share, by Wilson's score (1927); of a mean credit it is wide enough."""
    share, square = count / total, 1.959964**2
    middle = share + square / (2 * total)
    half = np.sqrt(square * (share * (1.0 - share) / total + square / (4 * total**2)))
    low, high = (float(end / (1.0 + square / total)) for end in (middle - half, middle + half))
    # At the ends the formula gives 0 and 1 up to rounding.
    return (0.0 if count == 0 else low), (1.0 if count == total else high)


def markdown(heads: str, rows: Sequence[Sequence[object]]) -> str:
    columns = heads.split(";")
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)
