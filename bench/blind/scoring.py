"""Counts of a blind study beside what is asked, and its tables in Markdown."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scores import Answer, interval, markdown

from blind.catalogue import CAUSES, FORMS, HOOK_OF, INSTRUMENT_NAMES, LAWS, entry, law_change
from blind.kinds import ALIKE, KINDS

Row = dict[str, Any]

# Share of the wanted signal to noise below which a data set is not counted: with its constants the
# cause cannot be as strong as the kind asks for.
_REACHED = 0.9
_SET = 0.95  # probability of a set of forms
_STANDS_OUT = 6.0  # S of one of two causes beside the other
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
# What a diagnosis may cost, CPU seconds: in the median, and at most.
_MEDIAN, _MOST = 12.0, 90.0
# Data sets of a family below which it is not judged.
_FEWEST = {"none": 60, "single": 40, "unlisted": 30}
_FEWEST_OF_OTHERS = 12


class Case:
    """A row of a record, and what it says: one question each."""

    def __init__(self, row: Row) -> None:
        self.row, self.answer, self.said = row, row["answer"], row["said"]
        self.kind, self.seed = self.answer["kind"], self.answer["seed"]
        self.verdict, self.hook = str(self.said["verdict"]), self.answer.get("hook")
        self.truth = set(self.answer["answer"])
        cause = self.said["cause"]
        self.causes = {cause} if isinstance(cause, str) else set(cause or ())
        # No velocity tells some causes from others.
        twins = (each for name in self.truth if name in CAUSES for each in entry(name).accepted)
        self.told = Answer(self.verdict, self.causes, self.truth, (*twins,))

    @property
    def counted(self) -> bool:
        """Whether what is hidden is as strong as its kind asks for."""
        wanted = KINDS[self.kind].wanted
        return wanted is None or self.answer["strength"] >= _REACHED * wanted[0]

    alarm = property(lambda self: self.verdict != "none")
    found = property(lambda self: self.verdict not in ("none", "data-problem"))
    named = property(lambda self: self.verdict == "named")
    pair = property(lambda self: self.verdict == "pair")
    # A cause that takes most of the model's error: a claim of another grade than a name.
    dominant = property(lambda self: self.verdict == "dominant")
    ambiguous = property(lambda self: self.verdict == "ambiguous")
    unexplained = property(lambda self: self.verdict == "unexplained")
    claimed = property(lambda self: self.named or self.pair)
    any_claim = property(lambda self: self.claimed or self.dominant)
    right = property(lambda self: self.causes == self.truth)
    rightly_named = property(lambda self: self.named and self.right)
    wrongly_claimed = property(lambda self: self.claimed and not self.right)
    # Of two causes, one or both.
    right_when_dominant = property(lambda self: self.dominant and self.causes <= self.truth)
    # A right name, or a set that is small enough to be an answer.
    in_set = property(lambda self: self.told.outcome in ("right name", "right set"))
    alike = property(lambda self: bool(self.answer["cosine"] >= ALIKE))

    @property
    def apart(self) -> bool:
        """Whether each of two causes stands out beside the other."""
        return bool(self.answer["beside"] >= _STANDS_OUT)

    @property
    def all_hidden(self) -> set[str]:
        """The causes and constants that are hidden, a model error too."""
        return self.truth | set(self.answer["hidden"])

    @property
    def group(self) -> str:
        """Whether something ``listed`` or ``unlisted`` is hidden, or ``nothing``."""
        family = KINDS[self.kind].family
        if family.startswith("none") or family == "shuffled":
            return "nothing"
        return "listed" if self.truth else "unlisted"

    @property
    def right_beside_error(self) -> bool:
        """A claim that has the cause beside a model error, which may be a second cause itself."""
        return self.any_claim and self.truth <= self.causes <= self.all_hidden

    @property
    def structure_blamed(self) -> bool:
        """A claim of something that is no constant, or a set that has none."""
        structural = ["." not in name for name in self.causes]
        return any(structural) if self.claimed else bool(structural) and all(structural)

    @property
    def first_in_rank(self) -> bool:
        chance = {name: p for name, p in self.said["probabilities"].items() if name != "none"}
        return max(chance, key=lambda name: chance[name], default="") in self.truth

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
    def gained(self) -> bool:
        gain = self.said["gain"] or {"before": 0.0, "after": 0.0}
        return bool(gain["after"] < gain["before"])

    @property
    def consistent(self) -> bool:
        return self.row["gain"] is not None and bool(self.row["gain"]["p_value"] > 0.05)

    def error(self, when: str) -> float:
        """Mean absolute error of held-out velocities, m/s, before or after; or NaN."""
        gain = self.said["gain"]
        return float(np.nan if gain is None else gain[f"mae_{when}"]["velocity"])

    @property
    def halved(self) -> bool:
        return self.error("after") <= 0.5 * self.error("before")

    @property
    def halved_by_truth(self) -> bool:
        """Whether the noise lets the truth itself halve the error."""
        left = self.row.get("truth_error")
        return left is not None and bool(left <= 0.5 * self.error("before"))

    @property
    def followed_right(self) -> bool:
        said = self.row.get("followed")
        return said is not None and Case({"answer": self.answer, "said": said}).rightly_named

    @property
    def second_said(self) -> bool:
        """The hidden second cause is said, or that something is left beside the first."""
        if self.answer["answer"][1] in self.causes or self.right_when_dominant:
            return True
        return self.named and _LEFT_OVER in self.row.get("reasons", ())

    @cached_property
    def shape(self) -> dict[str, Any] | None:
        """The law of another shape that is said, and no other cause beside it."""
        shape = self.said.get("open_set")
        alone = self.causes <= set(self.said.get("laws", {}))
        return shape if alone else None

    @property
    def hook_right(self) -> bool:
        """All that is said acts where the truth acts."""
        laws = self.said.get("laws", {})
        said = {laws.get(name, name) for name in self.causes}
        return {HOOK_OF.get(name) for name in said} == {self.hook}

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

    @property
    def physical_claimed(self) -> bool:
        """A claim of a cause in the robot where a reading is wrong."""
        return self.claimed and not self.causes <= set(INSTRUMENT_NAMES)


Question = Callable[[Case], float]
Demand = tuple[str, Question, Question, float | None, bool]


def _most(
    what: str, counts: Question, limit: float | None = None, among: Question | None = None
) -> Demand:
    return what, counts, among or (lambda c: True), limit, True


def _least(
    what: str, counts: Question, limit: float | None = None, among: Question | None = None
) -> Demand:
    return what, counts, among or (lambda c: True), limit, False


_ALARM = _most("false alarm", lambda c: c.alarm, 0.05)
_BLAMED = _most("structure blamed", lambda c: c.structure_blamed, 0.05)
_WRONG = _most("wrongly named", lambda c: c.wrongly_claimed, 0.02)
_UNEXPLAINED = _least("unexplained", lambda c: c.unexplained)
# Of two grades of a claim, the lower one; names and sets apart, and the mean credit of both.
_GRADES = (
    _least("right when dominant", lambda c: c.right_when_dominant, None, lambda c: c.dominant),
    _least("a right set of at most three causes", lambda c: c.told.outcome == "right set"),
    _least("score of groups", lambda c: c.told.credit),
)
_TWINS = (
    _least("in the set or right, of detected", lambda c: c.in_set, 0.95, lambda c: c.found),
    _WRONG,
    *_GRADES,
)

# Family: what it is in a reader's words, and its demands: what is counted, by which question, the
# limit, of which rows.
FAMILIES: dict[str, tuple[str, tuple[Demand, ...]]] = {
    "none": ("nothing", (_ALARM,)),
    "none, hard": ("nothing, hard noise", (_most("false alarm", lambda c: c.alarm, 0.08),)),
    "none, correlated": ("nothing, errors correlated", (
        _ALARM, _most("wrongly named", lambda c: c.any_claim, 0.02),
    )),
    "constant 3 sd": ("a constant 3 sd off", (_BLAMED,)),
    "constant 5 sd": ("a constant 5 sd off", (
        _least("that constant named", lambda c: c.rightly_named, 0.80), _BLAMED,
    )),
    "single": ("one cause, S of 6 or more", (
        _least("first in rank", lambda c: c.first_in_rank, 0.95),
        _least("named", lambda c: c.named, 0.82),
        _least("right when named", lambda c: c.rightly_named, 0.99, lambda c: c.named),
        _least("parameters within 2 sd when rightly named", lambda c: c.within, 0.90,
               lambda c: c.rightly_named and bool(c.pulls)),
        _least("held-out error consistent when rightly named", lambda c: c.consistent, 0.90,
               lambda c: c.rightly_named),
        _least("held-out better when rightly named", lambda c: c.gained, None,
               lambda c: c.rightly_named),
        _most("a pair claimed", lambda c: c.pair),
        *_GRADES,
    )),
    "single, correlated": ("one cause, errors correlated", (
        _least("in the set when detected", lambda c: c.in_set, None, lambda c: c.found),
        _WRONG, *_GRADES,
    )),
    "weak": ("one cause, S = 4", (
        _least("detected", lambda c: c.found, 0.65),
        _least("in the set when detected", lambda c: c.in_set, None, lambda c: c.found),
        _WRONG, *_GRADES,
    )),
    "near twins": ("one of near twins", (
        *_TWINS,
        _least("rightly named before more experiments", lambda c: c.rightly_named),
        _least("rightly named after three proposed", lambda c: c.followed_right, 0.90),
    )),
    "exact twins": ("one of exact twins", _TWINS),
    "pair": ("two causes", (
        _least("exact pair", lambda c: c.pair and c.right, 0.75),
        _least("both in what is said", lambda c: c.in_set, 0.88),
        _least("exact pair, each S of 6 or more beside the other", lambda c: c.pair and c.right,
               None, lambda c: c.apart),
        _least("both in what is said, the same", lambda c: c.in_set, None, lambda c: c.apart),
        _most("a single cause named", lambda c: c.named),
        *_GRADES,
    )),
    "hiding": ("two, of which one hides the other", (
        _least("the second said", lambda c: c.second_said, 0.85),
        _least("exact pair", lambda c: c.pair and c.right),
        _most("a wrong cause claimed", lambda c: c.claimed and not c.causes <= c.truth, 0.02),
        *_GRADES,
    )),
    "unknown": ("a wave that no cause has", (
        _least("unexplained", lambda c: c.unexplained, 0.90),
        _most("wrongly named", lambda c: c.claimed, 0.03),
        _GRADES[0],
    )),
    "law": ("a law outside the library", (
        _least("hook right", lambda c: c.hook_right, 0.70),
        _most("false terms", lambda c: c.claimed and not c.hook_right, 0.05),
        _least("its form is right", lambda c: c.form_among(False), None, lambda c: c.right_shape),
        _least("among those that have 95 %", lambda c: c.form_among(True), 0.60,
               lambda c: c.right_shape),
        _least("the band holds the truth on 80 % of its range", lambda c: c.inside >= 0.8, None,
               lambda c: c.right_shape),
        _least("the band holds all of it", lambda c: c.inside == 1.0, None,
               lambda c: c.right_shape),
        _least("held-out error at least halved", lambda c: c.halved),
        _least("the same, where the truth itself halves it", lambda c: c.halved, 0.75,
               lambda c: c.halved_by_truth),
        _UNEXPLAINED,
    )),
    "instrument": ("an instrument", (
        _least("in the set or named", lambda c: c.instrument_said, 0.95),
        _most("a physical cause claimed in its place", lambda c: c.physical_claimed, 0.02),
        _least("detected or a problem of the data", lambda c: c.alarm),
        _least("right when dominant", lambda c: c.instrument_said, None, lambda c: c.dominant),
    )),
    "none, correlated strong": ("nothing, errors strongly correlated", (
        _most("false alarm", lambda c: c.alarm),
        _most("named, a pair or dominant", lambda c: c.any_claim, 0.02),
    )),
    "model error": ("one cause, and an error of the model", (
        _least("right as named or dominant", lambda c: c.right_beside_error, 0.75),
        _most("wrongly named", lambda c: c.claimed and not c.right_beside_error, 0.03),
        _most("wrongly dominant", lambda c: c.dominant and not c.right_beside_error, 0.03),
        _least("first in rank", lambda c: c.first_in_rank),
        _least("parameters within 2 sd when right", lambda c: c.within, 0.90,
               lambda c: c.right_beside_error and bool(c.pulls)),
        _UNEXPLAINED,
    )),
    "unlisted": ("a strong cause that no list has", (
        _most("unlike all causes: wrongly named", lambda c: c.claimed and not c.place_right, 0.03,
              lambda c: not c.alike),
        _most("unlike all causes: wrongly dominant", lambda c: c.dominant and not c.place_right,
              0.10, lambda c: not c.alike),
        _least("unlike all causes: unexplained", lambda c: c.unexplained, None,
               lambda c: not c.alike),
        _most("like a cause: wrongly named", lambda c: c.claimed and not c.place_right, 0.03,
              lambda c: c.alike),
        _least("like a cause: said to act like one", lambda c: c.dominant, None,
               lambda c: c.alike),
        _least("like a cause: unexplained", lambda c: c.unexplained, None, lambda c: c.alike),
    )),
    "shuffled": ("nothing, readings shuffled", (_most("named", lambda c: c.any_claim, 0.0),)),
}  # fmt: skip


def read(path: Path) -> list[Row]:
    """Rows of a record of a study, of each data set the last one."""
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    return list({(row["answer"]["kind"], row["answer"]["seed"]): row for row in rows}.values())


def judged(rows: Sequence[Row], pooled: bool = False) -> list[dict[str, Any]]:
    """Count, total, interval and demand of each line of the table, and the seeds that missed it.

    By kind, or `pooled` over all kinds of a family. Data sets whose hidden things are weaker than
    their kind asks for are not counted. A demand is missed if the interval excludes it; whether it
    is met is None where there is none, or too few data sets of the family to judge by. `passing` is
    the worst count that is not missed.
    """
    result = []
    cases = [case for case in map(Case, rows) if case.counted]
    groups = {plan.family if pooled else kind: plan.family for kind, plan in KINDS.items()}
    for group, family in groups.items():
        mine = [c for c in cases if (KINDS[c.kind].family if pooled else c.kind) == group]
        fewest = _FEWEST.get(family, _FEWEST_OF_OTHERS)
        for what, counts, among, asked, at_most in FAMILIES[family][1]:
            some = [(case.seed, counts(case)) for case in mine if among(case)]
            if not some:
                continue
            count, total = sum(hit for _, hit in some), len(some)
            low, high = interval(count, total)
            met = passing = None
            if asked is not None and len(mine) >= fewest:
                fine = [k for k in range(total + 1) if _is_met(k, total, asked, at_most)]
                met, passing = count in fine, max(fine) if at_most else min(fine)
            missed = [seed for seed, hit in some if asked is not None and hit == at_most]
            result.append(
                {
                    "kind": group, "what": what, "count": count, "total": total, "low": low,
                    "high": high, "asked": asked, "at_most": at_most, "met": met,
                    "passing": passing, "missed": missed,
                }
            )  # fmt: skip
    return result


def _is_met(count: int, total: int, asked: float, at_most: bool) -> bool:
    low, high = interval(count, total)
    return low <= asked if at_most else high >= asked


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


def _counts(rows: Sequence[Row], pooled: bool) -> str:
    """Counts beside what is asked, by kind or pooled by family."""
    lines = []
    for each in judged(rows, pooled):
        bound = "at most" if each["at_most"] else "at least"
        lines.append(
            (
                FAMILIES[each["kind"]][0] if pooled else each["kind"], each["what"],
                f"{each['count']:.4g} of {each['total']}", f"{each['count'] / each['total']:.0%}",
                f"{each['low']:.0%} to {each['high']:.0%}",
                "-" if each["asked"] is None else f"{bound} {each['asked']:.0%}",
                "-" if each["passing"] is None else f"{each['passing'] / each['total']:.0%}",
                "-" if each["asked"] is None
                else {None: "not judged", True: "yes", False: "no"}[each["met"]],
            )
        )  # fmt: skip
    return markdown("hidden;counted;count;share;95 % interval;asked;passes up to;met", lines)


def table(rows: Sequence[Row]) -> str:
    """Counts of each family beside what is asked, calibration of the probabilities, and cost."""
    sure = [
        (
            f"{each['from']:.0%} to {each['to']:.0%}", f"{each['mean']:.0%}",
            f"{each['count']} of {each['total']}, {each['count'] / each['total']:.0%}",
            "yes" if interval(each["count"], each["total"])[1] >= each["from"] else "no",
        )
        for each in calibration(rows)
    ]  # fmt: skip
    parts = [
        _counts(rows, pooled=True),
        markdown("most likely, thought to be so by;on average;true;at least so often", sure),
    ]
    if rows:
        seconds = [row["cpu_seconds"] for row in rows]
        some = [row["cpu_seconds"] for row in rows if Case(row).found] or [0.0]
        parts.append(
            f"{len(rows)} data sets of up to 30 conditions; a diagnosis took "
            f"{np.median(seconds):.0f} s CPU time in the median (asked: {_MEDIAN:.0f}), "
            f"{np.median(some):.0f} s where something is found, {max(seconds):.0f} s at most "
            f"(asked: {_MOST:.0f})."
        )
    return "\n\n".join(parts)


def by_cause(rows: Sequence[Row]) -> list[tuple[object, ...]]:
    """Of each cause that is hidden by itself: kind, data sets, in the set, named, wrongly so."""
    mine: dict[tuple[str, str], list[Case]] = {}
    for case in map(Case, rows):
        # Shuffled labels leave nothing to be found.
        if case.counted and (len(case.truth) == 1 or case.hook) and case.kind != "shuffled":
            mine.setdefault((case.hook or next(iter(case.truth)), case.kind), []).append(case)
    result = []
    for (name, kind), cases in sorted(mine.items()):
        law = KINDS[kind].family in ("law", "unlisted")
        right = sum(c.hook_right if law else c.in_set for c in cases)
        wrong = sum(c.claimed and not (c.hook_right if law else c.right) for c in cases)
        result.append((name, kind, len(cases), right, sum(c.named for c in cases), wrong))
    return result


def misses(rows: Sequence[Row]) -> list[tuple[object, ...]]:
    """Every data set that missed what is asked: kind, seed, truth, S, what was said, and missed."""
    cases = {(case.kind, case.seed): case for case in map(Case, rows)}
    failed: dict[tuple[str, int], list[str]] = {}
    for each in judged(rows):
        for seed in each["missed"]:
            failed.setdefault((each["kind"], seed), []).append(each["what"])
    result = []
    for name, what in sorted(failed.items()):
        case = cases[name]
        truth = case.hook or " + ".join(case.answer["answer"]) or "-"
        said = " ".join([case.verdict, ", ".join(sorted(case.causes))])
        result.append((*name, truth, f"{case.answer['strength']:.1f}", said, "; ".join(what)))
    return result


def report(rows: Sequence[Row]) -> str:
    """All tables, and what they are of."""
    parts = [table(rows)]
    left = sum(not case.counted for case in map(Case, rows))
    if left:
        parts.append(
            f"Not counted: {left} data sets whose hidden cause cannot be as strong as asked for."
        )
    states = {tuple(sorted(row.get("state", {}).items())) for row in rows}
    parts += [", ".join(f"{key} {value}" for key, value in each) for each in sorted(states) if each]
    parts.append("Each kind by itself:\n\n" + _counts(rows, pooled=False))
    parts.append(
        markdown("cause;hidden as;data sets;in the set;named;wrong claims", by_cause(rows))
    )
    parts.append(markdown("kind;seed;truth;S;said;missed", misses(rows)))
    return "\n\n".join(parts)
