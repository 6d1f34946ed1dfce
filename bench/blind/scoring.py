"""Scores of a study of walkers, one question a case, and their tables in Markdown."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import scores
from scores import Answer, interval, markdown, share

from blind.catalogue import CAUSES, FORMS, HOOK_OF, LAWS, entry, law_change
from blind.kinds import KINDS

Row = dict[str, Any]

# Share of the wanted signal to noise below which a data set is not counted: with its constants the
# cause cannot be as strong as the kind asks for.
_REACHED = 0.9
_SET = 0.95  # probability of a set of forms
_LEFT_OVER = "second-cause-predicts-nothing"
"""Code of a verdict's reason that says that a cause was named and something is left over."""
# Parameters whose library form is the generator's too, so that their values can be compared.
_SAME_FORM = {
    f"{name}.{key}"
    for name, each in CAUSES.items()
    if not each.fixed
    for size in each.sizes
    for key in size
}
_CONSTANT = {
    "friction": "contact.kinetic_friction", "sliding": "contact.kinetic_friction",
    "adhesion": "contact.adhesion", "drag": "drag.linear", "fluid": "drag.linear",
}  # fmt: skip
WORDS = {
    "none": "nothing", "none, hard": "nothing, hard noise",
    "none, correlated": "nothing, errors correlated",
    "none, correlated strong": "nothing, errors strongly correlated",
    "shuffled": "nothing, readings shuffled", "constant 3 sd": "a constant 3 sd off",
    "constant 5 sd": "a constant 5 sd off", "single": "one cause, S of 6 or more",
    "single, correlated": "one cause, errors correlated", "weak": "one cause, S = 4",
    "model error": "one cause, and an error of the model", "near twins": "one of near twins",
    "exact twins": "one of exact twins", "pair": "two causes",
    "hiding": "two, of which one hides the other", "instrument": "an instrument",
    "unknown": "a wave that no cause has", "law": "a law outside the library",
    "unlisted": "a strong cause that no list has",
}  # fmt: skip
"""Families of kinds as a reader calls what is hidden."""


class Case:
    """A row of a record, and what it says: one question each."""

    def __init__(self, row: Row) -> None:
        self.row, self.answer, self.said = row, row["answer"], row["said"]
        self.kind, self.seed = self.answer["kind"], self.answer["seed"]
        self.family = KINDS[self.kind].family
        self.verdict, self.hook = str(self.said["verdict"]), self.answer.get("hook")
        # Shuffled labels leave nothing to be found.
        self.truth = set(self.answer["answer"]) if self.family != "shuffled" else set[str]()
        cause = self.said["cause"]
        self.causes = {cause} if isinstance(cause, str) else set(cause or ())

    @property
    def told(self) -> Answer:
        """The verdict beside the truth; for a law, the place where it acts."""
        if self.hook is not None:
            return Answer(self.verdict, self.places, [self.hook])
        # No velocity tells some causes from others.
        twins = (each for name in self.truth if name in CAUSES for each in entry(name).accepted)
        return Answer(self.verdict, self.causes, self.truth, (*twins,))

    @property
    def counted(self) -> bool:
        """Whether the hidden effect is as strong as its kind asks for."""
        wanted = KINDS[self.kind].wanted
        return wanted is None or self.answer["strength"] >= _REACHED * wanted[0]

    any_claim = property(lambda self: self.told.claims)
    named = property(lambda self: self.verdict == "named")
    rightly_named = property(lambda self: self.named and self.causes == self.truth)

    @property
    def all_hidden(self) -> set[str]:
        """The causes and constants that are hidden, a model error too."""
        return self.truth | set(self.answer["hidden"])

    @property
    def group(self) -> str:
        """Whether something ``listed`` or ``unlisted`` is hidden, or ``nothing``."""
        if self.family.startswith("none") or self.family == "shuffled":
            return "nothing"
        return "listed" if self.truth else "unlisted"

    @cached_property
    def pulls(self) -> list[float]:
        """Gaps of the comparable parameters, in standard deviations."""
        result = []
        for name, each in self.said["parameters"].items():
            if name in _SAME_FORM:
                effect, parameter = name.split(".")
                truth = self.answer["effects"].get(effect, {}).get(parameter, 0.0)
                result.append((each["value"] - truth) / max(each["sd"], 1e-300))
        return result

    @property
    def within(self) -> bool:
        return all(abs(gap) <= 2.0 for gap in self.pulls)

    @property
    def followed_right(self) -> bool:
        said = self.row.get("followed")
        return said is not None and Case({"answer": self.answer, "said": said}).rightly_named

    @property
    def second_said(self) -> bool:
        """The hidden second cause is said, or that something is left beside the first."""
        dominant = self.verdict == "dominant" and self.causes <= self.truth
        if self.answer["answer"][1] in self.causes or dominant:
            return True
        return self.named and _LEFT_OVER in self.row.get("reasons", ())

    @cached_property
    def shape(self) -> dict[str, Any] | None:
        """The law of another shape that is said, and no other cause beside it."""
        shape = self.said.get("open_set")
        alone = self.causes <= set(self.said.get("laws", {}))
        return shape if alone else None

    @property
    def places(self) -> set[str | None]:
        """Places where the causes of the verdict act."""
        laws = self.said.get("laws", {})
        return {HOOK_OF.get(laws.get(name, name)) for name in self.causes}

    hook_right = property(lambda self: self.places == {self.hook})
    # A wave acts nowhere.
    place_right = property(lambda self: self.hook is not None and self.hook_right)
    right_shape = property(lambda self: self.shape is not None and self.hook_right)

    def form_among(self, others: bool) -> bool:
        """Whether its form, or one of those that have 95 % together, is or bends as the truth's."""
        if self.shape is None:
            return False
        said, total = set[str](), 0.0
        for form, chance in self.shape["forms"].items():
            if not said or (others and total < _SET):
                said.add(form)
            total += chance
        return bool(set(FORMS[str(LAWS[self.hook].fixed["form"])]) & said)

    @cached_property
    def inside(self) -> float:
        """Share of the points of its curve at which the band holds the truth."""
        if self.shape is None:
            return 0.0
        law, curve = self.answer["effects"]["law"], self.shape["curve"]
        constant = self.answer["constants"].get(_CONSTANT.get(law["target"], ""), 1.0)
        true = constant * (1.0 + law_change(law, np.array(curve["argument"])))
        return float(np.mean((np.array(curve["low"]) <= true) & (true <= np.array(curve["high"]))))

    @property
    def instrument_said(self) -> bool:
        """The distortion is said, or one that no reading could tell from it."""
        (truth,) = self.truth
        return bool(self.causes & {truth, *entry(truth).accepted})


FACTS: tuple[tuple[str, Callable[[Case], bool], Callable[[Case], bool]], ...] = (
    ("parameters within 2 sd, of rightly named causes", lambda c: c.within,
     lambda c: c.rightly_named and bool(c.pulls)),
    ("near twins rightly named after three proposed drives", lambda c: c.followed_right,
     lambda c: c.family == "near twins"),
    ("the second cause said, of two of which one hides the other", lambda c: c.second_said,
     lambda c: c.family == "hiding"),
    ("a distortion said, or its twin", lambda c: c.instrument_said,
     lambda c: c.family == "instrument"),
    ("laws of a right form, of those that are told where they act", lambda c: c.form_among(False),
     lambda c: c.right_shape),
    ("a right form among those that have 95 %", lambda c: c.form_among(True),
     lambda c: c.right_shape),
    ("the band holds the truth on 80 % of its range", lambda c: c.inside >= 0.8,
     lambda c: c.right_shape),
)  # fmt: skip
"""Counts beside the answers: name, question, and the cases that are asked."""


def read(path: Path) -> list[Row]:
    """Rows of a record of a study, of each data set the last one."""
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    return list({(row["answer"]["kind"], row["answer"]["seed"]): row for row in rows}.values())


def facts(cases: Sequence[Case]) -> dict[str, tuple[int, int]]:
    """Count and total of each of `FACTS` that any case is about."""
    of = {what: [bool(asks(case)) for case in cases if among(case)] for what, asks, among in FACTS}
    return {what: (sum(hits), len(hits)) for what, hits in of.items() if hits}


_SURE = ((0.0, 0.5), (0.5, 0.8), (0.8, 0.95), (0.95, 1.0))
_ONE_ANSWER = ("constant 5 sd", "single", "single, correlated", "weak", "near twins")


def calibration(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """How often what was thought most likely was true, by how likely it was thought to be.

    Of data sets with one answer: a cause, none, or one that is not in the library.
    """
    thought = []
    for row in rows:
        family, chance = KINDS[row["answer"]["kind"]].family, row["said"]["probabilities"]
        if family == "unknown" or family.startswith("none"):
            truth = "none"
        elif family in _ONE_ANSWER:
            (truth,) = row["answer"]["answer"]
        else:
            continue
        best = max(chance, key=lambda name: chance[name])
        thought.append((chance[best], best == truth))
    result = []
    for low, high in _SURE:
        inside = [(p, right) for p, right in thought if low <= p < high or p == high == 1.0]
        if inside:
            result.append(
                {
                    "from": low, "to": high, "mean": float(np.mean([p for p, _ in inside])),
                    "count": sum(right for _, right in inside), "total": len(inside),
                }
            )  # fmt: skip
    return result


def table(rows: Sequence[Row]) -> str:
    """Answers by what is hidden, facts beside them, calibration of probabilities, and cost.

    Data sets whose hidden things are weaker than their kind asks for are not counted.
    """
    every = [Case(row) for row in rows]
    cases = [case for case in every if case.counted]
    groups = {words: [case.told for case in cases if case.family == family]
              for family, words in WORDS.items()}  # fmt: skip
    sure = [
        (
            f"{each['from']:.0%} to {each['to']:.0%}", f"{each['mean']:.0%}",
            f"{each['count']} of {each['total']}, {each['count'] / each['total']:.0%}",
            "yes" if interval(each["count"], each["total"])[1] >= each["from"] else "no",
        )
        for each in calibration(rows)
    ]  # fmt: skip
    beside = [(what, total, share(count, total)) for what, (count, total) in facts(cases).items()]
    seconds = [row["cpu_seconds"] for row in rows] or [0.0]
    return "\n\n".join([
        scores.table(groups), markdown("counted;of;share", beside),
        markdown("most likely, thought to be so by;on average;true;at least so often", sure),
        f"{len(rows)} data sets of up to 30 conditions, {len(every) - len(cases)} of them too weak "
        f"to count; a diagnosis took {np.median(seconds):.0f} s CPU time in the median, "
        f"{max(seconds):.0f} s at most.",
    ])  # fmt: skip


def report(rows: Sequence[Row]) -> str:
    """The tables, and each data set with a wrong answer."""
    wrong = [
        (case.kind, case.seed, case.hook or " + ".join(sorted(case.truth)) or "-",
         f"{case.answer['strength']:.1f}", f"{case.verdict} {', '.join(sorted(case.causes))}")
        for case in map(Case, rows) if case.counted and case.told.outcome.startswith("wrong")
    ]  # fmt: skip
    return f"{table(rows)}\n\n{markdown('kind;seed;truth;S;said', wrong)}"
