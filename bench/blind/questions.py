"""What one row of a record says, one question each."""

from __future__ import annotations

from typing import Any

import numpy as np

from blind.catalogue import CAUSES, HOOK_OF, INSTRUMENT_NAMES, LAWS, entry
from blind.hidden_laws import FORMULAS, law_change
from blind.kinds import ALIKE, KINDS

Row = dict[str, Any]

# Share of the wanted signal to noise below which a data set is not counted: with its constants the
# cause cannot be as strong as the kind asks for.
_REACHED = 0.9
_FEW = 6  # members of a set that are still an answer
# Codes of a verdict's reasons that say that a cause was named and something is left over.
_LEFT_OVER = ("SMOOTH_REST", "PAIR_LEADS_TOO_LITTLE")
# Parameters whose library form is the generator's too, so that their values can be compared.
_SAME_FORM = {
    f"{name}.{key}"
    for name, each in CAUSES.items()
    if not each.fixed
    for size in each.sizes
    for key in size
}


def truth_of(row: Row) -> set[str]:
    return set(row["answer"]["answer"])


def verdict_of(row: Row) -> str:
    return str(row["said"]["verdict"])


def causes_said(row: Row) -> set[str]:
    """Names of the headline."""
    cause = row["said"]["cause"]
    return set() if cause is None else {cause} if isinstance(cause, str) else set(cause)


def alarm(row: Row) -> bool:
    return verdict_of(row) != "none"


def named(row: Row) -> bool:
    return verdict_of(row) == "named"


def rightly_named(row: Row) -> bool:
    return named(row) and causes_said(row) == truth_of(row)


def claimed(row: Row) -> bool:
    return verdict_of(row) in ("named", "pair")


def pair_claimed(row: Row) -> bool:
    return verdict_of(row) == "pair"


def dominant(row: Row) -> bool:
    """A cause is said to take most of the model's error: a claim of another grade than a name."""
    return verdict_of(row) == "dominant"


def right_when_dominant(row: Row) -> bool:
    """Nothing but the truth is said to dominate: of two causes, one or both."""
    return dominant(row) and causes_said(row) <= truth_of(row)


def any_claim(row: Row) -> bool:
    """A claim of either grade."""
    return claimed(row) or dominant(row)


def right_beside_error(row: Row) -> bool:
    """A claim of either grade that has the cause beside a model error, and nothing false.

    A model error may be a second cause; then both are right.
    """
    hidden = truth_of(row) | set(row["answer"]["hidden"])
    return any_claim(row) and truth_of(row) <= causes_said(row) <= hidden


def wrongly_named_beside_error(row: Row) -> bool:
    return claimed(row) and not right_beside_error(row)


def wrongly_dominant_beside_error(row: Row) -> bool:
    return dominant(row) and not right_beside_error(row)


def place_right(row: Row) -> bool:
    """What is said acts where a law outside the library acts; a wave acts nowhere."""
    return row["answer"]["hook"] is not None and hook_right(row)


def wrongly_named_unlisted(row: Row) -> bool:
    """A name for what no cause is, though another law in its place is no wrong one."""
    return claimed(row) and not place_right(row)


def wrongly_dominant_unlisted(row: Row) -> bool:
    return dominant(row) and not place_right(row)


def alike(row: Row) -> bool:
    """Whether what no cause lists has the effect of a listed one."""
    return bool(row["answer"]["cosine"] >= ALIKE)


def unlike(row: Row) -> bool:
    return not alike(row)


def set_said(row: Row) -> bool:
    return verdict_of(row) == "ambiguous"


def few_members(row: Row) -> bool:
    """What is said has at most six causes."""
    return len(causes_said(row)) <= _FEW


def in_few(row: Row) -> bool:
    """The truth is among at most six causes that are said."""
    return in_set(row) and few_members(row)


def unexplained(row: Row) -> bool:
    return verdict_of(row) == "unexplained"


def wrongly_claimed(row: Row) -> bool:
    return claimed(row) and causes_said(row) != truth_of(row)


def exact_pair(row: Row) -> bool:
    return pair_claimed(row) and causes_said(row) == truth_of(row)


def false_cause(row: Row) -> bool:
    """A claim that has a cause which is not hidden."""
    return claimed(row) and not causes_said(row) <= truth_of(row)


def structure_blamed(row: Row) -> bool:
    """A claim of something that is no constant, or a set that has none."""
    structural = ["." not in name for name in causes_said(row)]
    return any(structural) if claimed(row) else bool(structural) and all(structural)


def found(row: Row) -> bool:
    return verdict_of(row) not in ("none", "data-problem")


def in_set(row: Row) -> bool:
    """The truth is what is said or among it."""
    truth = truth_of(row)
    return bool(truth) and truth <= causes_said(row)


def first_in_rank(row: Row) -> bool:
    chance = {name: p for name, p in row["said"]["probabilities"].items()
              if name not in ("none", "unknown")}  # fmt: skip
    return max(chance, key=lambda name: chance[name], default="") in truth_of(row)


def parameters_within(row: Row) -> bool:
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


def comparable(row: Row) -> bool:
    return rightly_named(row) and bool(_pulls(row))


def comparable_beside(row: Row) -> bool:
    return right_beside_error(row) and bool(_pulls(row))


def gained(row: Row) -> bool:
    gain = row["said"]["gain"]
    return gain is not None and bool(gain["heldout_chi2_after"] < gain["heldout_chi2_before"])


def halved(row: Row) -> bool:
    shape = accepted_shape(row)
    gain = row["said"]["gain"] if shape is None else shape["gain"]
    return gain is not None and bool(gain["mae_after"] <= 0.5 * gain["mae_before"])


def halved_by_truth(row: Row) -> bool:
    """Whether the noise lets the truth itself halve the error."""
    shape, error = accepted_shape(row), row.get("truth_error")
    gain = row["said"]["gain"] if shape is None else shape["gain"]
    return error is not None and bool(error <= 0.5 * gain["mae_before"])


def consistent(row: Row) -> bool:
    return row["gain"] is not None and bool(row["gain"]["p_value"] > 0.05)


def followed(row: Row) -> bool:
    return row.get("followed") is not None


def followed_right(row: Row) -> bool:
    return followed(row) and rightly_named({"answer": row["answer"], "said": row["followed"]})


def second_said(row: Row) -> bool:
    """The hidden second cause is said, or that something is left beside the first."""
    if row["answer"]["answer"][1] in causes_said(row):
        return True
    return named(row) and any(code in _LEFT_OVER for code in row.get("reasons", ()))


def accepted_shape(row: Row) -> dict[str, Any] | None:
    """The law of another shape that is said in place of a cause."""
    shape = row["said"].get("open_set")
    return shape if shape is not None and shape["accepted"] and not causes_said(row) else None


def hook_right(row: Row) -> bool:
    """All that is said acts where the truth acts.

    Where no cause is claimed, what is said is the law of another shape that was accepted.
    """
    shape = accepted_shape(row)
    said = causes_said(row) if shape is None else {shape["effect"]}
    return {HOOK_OF.get(name) for name in said} == {row["answer"]["hook"]}


def right_shape(row: Row) -> bool:
    """A law of another shape is said, at the right place."""
    return accepted_shape(row) is not None and hook_right(row)


def _formulas(row: Row) -> list[str]:
    """Its formula, and those that are said to be nearly as likely."""
    shape = accepted_shape(row)
    if shape is None or shape["formula"] is None:
        return []
    return [shape["formula"], *shape["others"]]


def _right_forms(row: Row) -> set[str]:
    return set(FORMULAS[str(LAWS[row["answer"]["hook"]].fixed["form"])])


def form_right(row: Row) -> bool:
    """Its formula is the truth's form, or bends as it does."""
    return bool(_right_forms(row) & set(_formulas(row)[:1]))


def form_said(row: Row) -> bool:
    """The same of its formula or one that is said to be nearly as likely."""
    return bool(_right_forms(row) & set(_formulas(row)))


_CONSTANT = {
    "friction": "contact.kinetic_friction", "sliding": "contact.kinetic_friction",
    "adhesion": "contact.adhesion", "drag": "drag.linear", "fluid": "drag.linear",
}  # fmt: skip


def _inside(row: Row) -> float:
    """Share of the points of its curve at which the band holds the truth; 0 without a curve."""
    shape = accepted_shape(row)
    if shape is None:
        return 0.0
    law = row["answer"]["effects"]["law"]
    constant = row["answer"]["constants"].get(_CONSTANT.get(law["target"], ""), 1.0)
    true = constant * (1.0 + law_change(law, np.array(shape["curve"]["argument"])))
    low, high = (np.array(shape["curve"][end]) for end in ("low", "high"))
    return float(np.mean((low <= true) & (true <= high)))


def band_holds(row: Row) -> bool:
    """Its band holds the truth at four fifths of its points."""
    return _inside(row) >= 0.8


def band_holds_all(row: Row) -> bool:
    """Its band holds all of the truth, as it should with a probability of 90 %."""
    return _inside(row) == 1.0


def false_term(row: Row) -> bool:
    return claimed(row) and not hook_right(row)


def instrument_said(row: Row) -> bool:
    """The distortion is said, or one that no reading could tell from it."""
    (truth,) = row["answer"]["answer"]
    return bool(causes_said(row) & {truth, *entry(truth).accepted})


def physical_claimed(row: Row) -> bool:
    """A claim of a cause in the robot where a reading is wrong."""
    return claimed(row) and not causes_said(row) <= set(INSTRUMENT_NAMES)


def strong_enough(row: Row) -> bool:
    """Whether what is hidden is as strong as its kind asks for."""
    wanted = KINDS[row["answer"]["kind"]].wanted
    return wanted is None or row["answer"]["strength"] >= _REACHED * wanted[0]


def any_row(row: Row) -> bool:
    return True
