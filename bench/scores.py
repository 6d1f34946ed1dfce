"""Scores of answers beside the truth: the one place where answers of a diagnosis are counted.

A claim is right if it has all that is hidden and nothing else, a set if it holds it and has at most
`FEW` members. Silence is right where nothing that is listed is hidden, and else worth nothing.
"""

from __future__ import annotations

import itertools
import time
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from stickslip.diagnosis.decision.verdict import CLAIMS

T = TypeVar("T")
FEW = 3
"""Members of a set that is an answer. Chosen: standards of testability, as MIL-STD-2165, ask for
faults isolated to one, two or three units."""
OUTCOMES = ("right name", "right set", "large set", "silent", "wrong set", "wrong name",
            "rightly silent")  # fmt: skip


class Answer(NamedTuple):
    """A verdict or a word of another tool, its causes, and what is hidden of what is listed.

    twins: Causes that no reading can tell from those that are hidden.
    """

    said: str
    causes: Collection[str]
    truth: Collection[str]
    twins: Collection[str] = ()

    @property
    def claims(self) -> bool:
        return self.said in CLAIMS

    @property
    def outcome(self) -> str:
        """One of `OUTCOMES`."""
        causes, truth = set(self.causes), set(self.truth)
        if not self.claims and not (self.said == "ambiguous" and causes):
            return "silent" if truth else "rightly silent"
        if self.claims:
            return "right name" if truth and causes == truth else "wrong name"
        if not truth or not truth <= causes:
            return "wrong set"
        return "right set" if len(causes) <= FEW else "large set"

    @property
    def credit(self) -> float:
        """The share of the named group that is true, 0 to 1; 0 where it lacks what is hidden.

        1 for a right name and for a whole group of exact twins, 1/n for one cause in a set of n.
        Of one cause among many this is the utility of ambiguity groups of the diagnostic
        competition DXC 2026 (https://github.com/jdekleer/dxc26synth, after Feldman and others,
        International Journal of Prognostics and Health Management 1, 2010), with silence at 0.
        """
        causes, truth = set(self.causes), set(self.truth)
        if not truth or self.said not in (*CLAIMS, "ambiguous") or not truth <= causes:
            return 0.0
        return len(causes & (truth | set(self.twins))) / len(causes)


def until(minutes: float, items: Iterable[T]) -> Iterator[T]:
    """Items, of which none is begun after some minutes."""
    end = time.monotonic() + 60.0 * minutes
    return itertools.takewhile(lambda _: time.monotonic() <= end, items)


def interval(count: float, total: int) -> tuple[float, float]:
    """95 % interval of a share, by Wilson's score (1927); of a mean credit it is wide enough."""
    share, square = count / total, 1.959964**2
    middle = share + square / (2 * total)
    half = np.sqrt(square * (share * (1.0 - share) / total + square / (4 * total**2)))
    low, high = (float(end / (1.0 + square / total)) for end in (middle - half, middle + half))
    # At the ends the formula gives 0 and 1 up to rounding.
    return (0.0 if count == 0 else low), (1.0 if count == total else high)


def share(count: float, total: int) -> str:
    """A count or a sum of credits with its interval."""
    low, high = interval(count, total)
    said = f"{count}" if isinstance(count, int) else f"{count / total:.2f}"
    return f"{said} ({100 * low:.0f} to {100 * high:.0f} %)"


def markdown(heads: str, rows: Sequence[Sequence[object]]) -> str:
    columns = heads.split(";")
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def table(groups: Mapping[str, Sequence[Answer]]) -> str:
    """Markdown table of groups of answers: the count of each outcome, and the mean credit."""
    counts = {name: Counter(each.outcome for each in group) for name, group in groups.items()}
    shown = [each for each in OUTCOMES if any(count[each] for count in counts.values())]
    rows = []
    for name, group in groups.items():
        if group:
            cells = [share(counts[name][each], len(group)) if counts[name][each] else "0"
                     for each in shown]  # fmt: skip
            hides = all(each.truth for each in group)
            credit = share(float(sum(each.credit for each in group)), len(group))
            rows.append((name, len(group), *cells, credit if hides else "-"))
    return markdown(";".join(("sets", "number", *shown, "score of groups")), rows)
