"""Counts of answers beside the truth."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
from blind.scoring import interval

ROWS = ("right", "right set", "dominant", "cannot tell", "wrong", "false alarm")
CLAIMS = ("named", "dominant", "pair")


def judged(answer: dict[str, Any], truth: dict[str, Any]) -> str:
    """One of `ROWS`."""
    said, causes, cause = answer["said"], answer["causes"], truth["cause"]
    there = bool(cause) and truth["listed"]
    claimed = said in CLAIMS or (said == "ambiguous" and causes)
    if not cause:
        return "false alarm" if claimed else "right"
    if not claimed:
        # Who cannot list the cause is right to say so.
        return "cannot tell" if there else "right"
    if not there or cause not in causes:
        return "wrong"
    if said == "ambiguous" or len(causes) > 1:
        return "right set" if said in ("ambiguous", "pair") else "wrong"
    return "dominant" if said == "dominant" else "right"


def table(answers: dict[str, dict[str, Any]], truths: dict[str, Any]) -> str:
    """The counts of each group of sets, in Markdown."""
    groups = {
        f"{of}{what}": (walks, belongs)
        for of, walks in (("", False), ("walkers: ", True))
        for what, belongs in (
            ("nothing hidden", lambda t: not t["cause"]),
            ("one cause", lambda t: t["cause"] and t["listed"] and not t["model_error"]),
            ("and a model error", lambda t: t["cause"] and t["listed"] and t["model_error"]),
            ("cause not listed", lambda t: t["cause"] and not t["listed"]),
        )
    }
    lines = ["| sets | answered | " + " | ".join(ROWS) + " | CPU s, median |",
             "| --- | --- | " + " | ".join("---" for _ in ROWS) + " | --- |"]  # fmt: skip
    for group, (walks, belongs) in groups.items():
        names = [name for name, truth in truths.items()
                 if belongs(truth) and name.startswith("walker") is walks]  # fmt: skip
        have = [name for name in names if name in answers]
        if not have:
            continue
        counts = Counter(judged(answers[name], truths[name]) for name in have)
        cells = []
        for row in ROWS:
            low, high = interval(counts[row], len(have))
            said = f"{counts[row]} ({100 * low:.0f} to {100 * high:.0f} %)"
            cells.append(said if counts[row] else "0")
        cpu = float(np.median([answers[name]["cpu"] for name in have]))
        lines.append(f"| {group} | {len(have)} of {len(names)} | {' | '.join(cells)} | {cpu:.1f} |")
    return "\n".join(lines)
