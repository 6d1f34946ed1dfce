"""Which law of the model has another shape: what is found by `free_term_search`.

A law is only proposed if its curve explains the data and what it predicts of conditions that its
fit has not seen does not speak against it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import Fit
from stickslip.diagnosis.fit.goodness import ADEQUATE
from stickslip.diagnosis.inference.cross_validation import Gain
from stickslip.diagnosis.inference.formulas import Formula
from stickslip.diagnosis.inference.verdict import MARGIN
from stickslip.diagnosis.model.free_terms import Term
from stickslip.diagnosis.model.problem import Problem
from stickslip.facts import Code, Fact

if TYPE_CHECKING:
    from pandas import DataFrame

BAND = 0.9
"""Probability with which the band of a curve holds the law, at all points at once."""


@dataclass(frozen=True, repr=False, eq=False)
class FreeShape(OneLine):
    """A fit of a free curve at one place of the model.

    Attributes
    ----------
    term : Term
        Where it acts, and how far its knots reach.
    fit : Fit
    lead : float
        Log-evidence above the recalibrated model.
    p_value : float
        Of the lack of fit.
    """

    term: Term
    fit: Fit
    lead: float
    p_value: float


@dataclass(frozen=True, repr=False, eq=False)
class Curve(OneLine):
    """A law against its argument, which has the argument's unit; the others shape (points,).

    Attributes
    ----------
    argument : ndarray
    law, low, high : ndarray
        The law of the fit, in `unit`, and the ends between which all of the law lies with a
        probability of 90 %. The constant that belongs to it is in them, as the data often tell
        their product alone.
    without : float
        The law without f: that constant in the fit; 1 for the field, whose law is over that of the
        model; 0 where the law is f alone: the place of the contact, and a term of one's own that
        has no `factor_of`.
    half : ndarray, shape (points,)
        Half the width of the band before an end is cut off at zero.
    before : float
        The same of a band that reaches as far about a law of which only its usual size is known, in
        `unit`.
    unit : str
    """

    argument: Array
    law: Array
    low: Array
    high: Array
    half: Array
    without: float
    before: float
    unit: str

    @property
    def told(self) -> tuple[float, float] | None:
        """Ends of the widest range of the argument that the data tell something of, or None.

        There the law has a band less than half as wide as before them. Chosen: the data then tell
        more than was known.
        """
        narrow = self.half < 0.5 * self.before
        edges = np.flatnonzero(np.diff(np.concatenate([[0], narrow, [0]])))
        runs = [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
        if not runs:
            return None
        first, last = max(runs, key=lambda ends: ends[1] - ends[0])
        return float(self.argument[first]), float(self.argument[last])


@dataclass(frozen=True, repr=False, eq=False)
class OpenSet(OneLine):
    """Free curves at all places, most likely first.

    The first has to pass what a named cause has to pass: `against` says where it does not.

    Attributes
    ----------
    problem : Problem
        Whose causes are the terms.
    shapes : tuple of FreeShape
    against : tuple of Fact
        What speaks against the first, as it would against a name.
    gain : Gain, optional
        Of the first, on held-out conditions.
    curve : Curve
        Of the first.
    formulas : tuple of Formula
        In the place of an accepted curve, most likely first.
    """

    problem: Problem
    shapes: tuple[FreeShape, ...]
    against: tuple[Fact, ...]
    gain: Gain | None
    curve: Curve
    formulas: tuple[Formula, ...]

    @property
    def formula(self) -> Formula | None:
        """The most likely formula, if there is one."""
        return self.formulas[0] if self.formulas else None

    @property
    def first(self) -> FreeShape:
        return self.shapes[0]

    @property
    def accepted(self) -> bool:
        """Whether the first explains the data, and nothing speaks against it."""
        explains = self.first.p_value >= ADEQUATE and not self.against
        if self.gain is None:
            return False
        return explains and self.gain.lead < MARGIN and self.gain.interval[1] > 0.0

    def is_too_coarse(self, null: Fit) -> bool:
        """Whether the first takes most of the recalibrated model's misfit, but not all of it."""
        first = self.first
        return first.p_value < ADEQUATE and first.fit.data_chi2 < 0.5 * null.data_chi2

    @property
    def rivals(self) -> tuple[FreeShape, ...]:
        """Others that explain the data and are too near the first to be dismissed."""
        first = self.first.lead
        return tuple(
            each
            for each in self.shapes[1:]
            if first - each.lead < MARGIN and each.p_value >= ADEQUATE
        )

    def facts(self) -> tuple[Fact, ...]:
        """What the curves say, in sentences."""
        term = self.first.term
        first = {"law": term.law, "argument": term.argument}
        if not self.accepted:
            fields = {**first, "p_value": self.first.p_value, "lead": self.first.lead}
            return (Fact(Code.NO_FREE_SHAPE, {**fields, "level": ADEQUATE}), *self.against)
        said = [Fact(Code.FREE_SHAPE, {**first, "lead": self.first.lead, "band": 100.0 * BAND})]
        said.append(self._meaning())
        if self.rivals:
            others = [each.term.name for each in self.rivals]
            said.append(Fact(Code.FREE_SHAPE_RIVALS, {**first, "others": others}))
        if self.gain is not None:
            fall = {"before": self.gain.chi2_before, "after": self.gain.chi2_after}
            known = {"count": len(self.gain.held_out), "certain": self.gain.interval[0] > 0.0}
            said.append(Fact(Code.FREE_SHAPE_GAIN, {**fall, **known}))
        if self.formula is not None:
            law = term.law if term.relative else f"f of {term.law}"
            names = (law, term.unit, term.law_unit, term.relative)
            fields = {"formula": self.formula.in_numbers(*names)}
            others = [each.text for each in self.formulas[1:]]
            beside = {"lead": self.formula.lead, "others": others, "origin": self.formula.origin}
            own = {"argument": term.argument, "unit": term.unit}
            said.append(Fact(Code.FREE_SHAPE_FORMULA, {**fields, **own, **beside}))
        return tuple(said)

    def _meaning(self) -> Fact:
        """What f and its argument are, and where the data say something of them."""
        term = self.first.term
        names = {"law": term.law, "argument": term.argument, "unit": term.unit}
        law = {**names, "told": self.curve.told}
        if not term.relative:
            ends = {"low": term.low, "high": term.high}
            return Fact(Code.FREE_TERM_MEANING, {**law, **ends, "own": term.law_unit})
        reach = {"reach": term.span, "size": "|u|" if term.low < 0.0 else "u"}
        return Fact(Code.FREE_SHAPE_MEANING, {**law, **reach})

    def as_dict(self) -> dict[str, object]:
        """For report.json; SI units."""
        formula, curve = self.formula, self.curve
        return {
            "accepted": self.accepted,
            "hooks": self.table().to_dict("records"),
            "curve": {name: getattr(curve, name).tolist()
                      for name in ("argument", "law", "low", "high")} | {"unit": curve.unit},
            "formula": None if formula is None else {
                "text": formula.text, "a": formula.a,
                **dict(zip("bc", [*formula.places, None, None], strict=False)),
                "origin": formula.origin, "without": formula.without,
                "lead": formula.lead, "p_value": formula.p_value,
                "others": [each.text for each in self.formulas[1:]],
            },
            "gain": None if self.gain is None else self.gain.as_dict(),
        }  # fmt: skip

    def table(self) -> DataFrame:
        """A row for each term: `effect`, `law`, `argument`, `span`, `unit`, `lead`, `p`."""
        import pandas as pd

        return pd.DataFrame(
            {
                "effect": each.term.effect,
                "law": each.term.law,
                "argument": each.term.argument,
                "span": each.term.span,
                "unit": each.term.unit,
                "lead": each.lead,
                "p": each.p_value,
            }
            for each in self.shapes
        )
