"""Tables of finished studies, from their rows. Their programs are in earlier commits:

`intervals.py` of b7b828df: sizes of a cause beside an error of the model that nobody lists.
`changes.py` of 50a47554: pairs of logs, or of measurements of a walker, with one difference.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scores
from scores import CLAIMS, Answer, interval, markdown, share

from blind.study import Row


def _by(rows: list[Row], key: str) -> dict[Any, list[Row]]:
    """Rows by what they have under a key, in the order in which that comes."""
    return {each: [row for row in rows if row[key] == each]
            for each in dict.fromkeys(row[key] for row in rows)}  # fmt: skip


def intervals(rows: list[Row]) -> str:
    """Table by kind of error: how many sizes are told, how many hold the truth, their width."""
    found = []
    for errors in ("smooth", "correlated", "physical", ""):
        own = [row for row in rows if row["error"] == errors or not errors]
        told = [row for row in own if "z" in row]
        if not told:
            continue
        held = sum(abs(row["z"]) <= 1.0 for row in told)
        low, high = interval(held, len(told))
        found.append((errors or "any", f"{len(told)} of {len(own)}", f"{held} of {len(told)}",
                      f"{low:.0%} to {high:.0%}",
                      f"{np.median([row['wider'] for row in told]):.2f}"))  # fmt: skip
    heads = "error of the model;sizes told;hold the truth;95 % interval;median width over the fit's"
    asked = "Asked: 90% hold the truth, a width of 1.5 at most."
    seconds = sum(row["cpu_seconds"] for row in rows)
    return f"{markdown(heads, found)}\n\n{asked} {seconds:.0f} CPU s."


def answer_of_change(row: Row, whose: str = "causes") -> Answer:
    """What is said beside what is hidden; what both sides have is no difference.

    Without one any verdict but `none` counts as a change, but what both sides have, and what is
    unexplained with other inputs: of that the verdict says that both sides may have it.
    """
    said = [name for name in row[whose] if "[" in name]
    verdict = row["verdict"] if whose == "causes" else "named" if said else "none"
    if verdict in (*CLAIMS, "ambiguous") and not said:
        verdict = "none"
    if not row["change"] and verdict == "unexplained" and row["alike"]:
        verdict, said = "ambiguous", ["?"]
    return Answer(verdict, said, [row["change"]] if row["change"] else [])


def changes(rows: list[Row]) -> str:
    """Counts of ours, and of the others, by what is hidden; and the time."""
    groups = {"all": rows, **_by(rows, "kind")}
    for key, words in {"alike": ("same inputs", "other inputs"),
                       "error": ("model error", "no model error")}.items():  # fmt: skip
        groups |= {word: [row for row in rows if row[key] != bool(k)]
                   for k, word in enumerate(words)}  # fmt: skip
    of_all = {f"{name}: {'one difference' if some else 'none'}":
              [answer_of_change(row) for row in own if bool(row["change"]) == some]
              for name, own in groups.items() for some in (True, False)}  # fmt: skip
    found = []
    for name, whose in {"ours": "causes", "two diagnoses": "absolute", "BIC": "bic"}.items():
        every = [answer_of_change(row, whose).outcome for row in rows if row["change"]]
        rest = [answer_of_change(row, whose).outcome for row in rows if not row["change"]]
        right, sets = every.count("right name"), every.count("right set")
        false = len(rest) - rest.count("rightly silent")
        found.append((name, *(share(k, max(len(every), 1)) for k in
                              (right, right + sets, every.count("wrong name"))),
                      share(false, max(len(rest), 1))))  # fmt: skip
    heads = "by;named;named or in a set of 3;wrong;a change where none is"
    ratio = [row["seconds"] / row["seconds_of_one"] for row in rows]
    whole = sum(row["seconds"] for row in rows) / sum(row["seconds_of_one"] for row in rows)
    cost = f"CPU of a pair over that of one log: median {np.median(ratio):.2f}, of all {whole:.2f}."
    open_ = sum(row["verdict"] == "unexplained" and not row["change"] for row in rows)
    beside = f"{open_} pairs without a difference are unexplained: both sides may have an error."
    parts = scores.table(of_all), markdown(heads, found), f"{len(rows)} pairs. {beside} {cost}"
    return "\n\n".join(parts)
