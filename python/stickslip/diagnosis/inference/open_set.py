"""Which law of the model has another shape, where no cause of the library explains the data.

First the hook is found, by fits of a free curve at each place of the model; then its shape, with a
band; then a formula, where one fits as well. A hook is only proposed if its curve explains the data
and what it predicts of conditions that its fit has not seen does not speak against it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm as normal_law

from stickslip._util.arrays import Array, Indices
from stickslip._util.one_line import OneLine
from stickslip.diagnosis.fit.fit_result import (
    Fit,
    Start,
    free_parameters,
    make_candidate,
    physical_covariance,
    ranked,
)
from stickslip.diagnosis.fit.goodness import ADEQUATE, adequacy
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.fit.single_cause import (
    quick_fits,
    refine,
    refit_worse_than_null,
    starts_by_misfit,
)
from stickslip.diagnosis.inference.cross_validation import Gain, measure_gain
from stickslip.diagnosis.inference.formulas import Formula, find_formula
from stickslip.diagnosis.inference.verdict import MARGIN
from stickslip.diagnosis.model.free_shapes import HOOKS, SCALE, Hook, curve_design
from stickslip.diagnosis.model.problem import Problem
from stickslip.facts import Code, Fact
from stickslip.scenario.keys import known_keys

if TYPE_CHECKING:
    from pandas import DataFrame

    from stickslip.scenario.scenario import Scenario

# Points at which a curve is drawn, and coverage of its band.
_POINTS, BAND = 61, 0.9
# Starts of each hook beside the null, of those with one knot moved. Chosen: with fewer a curve that
# changes its sign is missed, each costs the stages of a quick fit.
_STARTS = 3


@dataclass(frozen=True, repr=False, eq=False)
class FreeShape(OneLine):
    """A fit of a free curve at one hook.

    Attributes
    ----------
    hook : Hook
    span : float
        How far its knots reach, in the argument's unit.
    fit : Fit
    lead : float
        Log-evidence above the recalibrated model.
    p_value : float
        Of the lack of fit.
    """

    hook: Hook
    span: float
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
        The law, in `unit`, and the ends that hold it with a probability of 90 % at each point. The
        constant that belongs to it is in them, as the data often tell their product alone.
    constant : float
        That constant in the fit; 1 for the field, whose law is over that of the model.
    unit : str
    """

    argument: Array
    law: Array
    low: Array
    high: Array
    constant: float
    unit: str

    @property
    def told(self) -> tuple[float, float] | None:
        """Ends of the widest range of the argument that the data tell something of, or None.

        There f, the relative change of the law, has a band less than half as wide as before them.
        Chosen: the data then tell more than was known.
        """
        before = 2.0 * float(normal_law.ppf(0.5 + 0.5 * BAND)) * SCALE
        narrow = (self.high - self.low) < 0.5 * before * abs(self.constant)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], narrow, [0]])))
        runs = [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
        if not runs:
            return None
        first, last = max(runs, key=lambda ends: ends[1] - ends[0])
        return float(self.argument[first]), float(self.argument[last])


@dataclass(frozen=True, repr=False, eq=False)
class OpenSet(OneLine):
    """Free shapes at all hooks, most likely first.

    The first has to pass what a named cause has to pass: `against` says where it does not.

    Attributes
    ----------
    problem : Problem
        Whose causes are the hooks.
    shapes : tuple of FreeShape
    against : tuple of Fact
        What speaks against the first, as it would against a name.
    gain : Gain, optional
        Of the first, on held-out conditions.
    curve : Curve
        Of the first.
    formula : Formula, optional
        For its curve, where one fits as well.
    """

    problem: Problem
    shapes: tuple[FreeShape, ...]
    against: tuple[Fact, ...]
    gain: Gain | None
    curve: Curve
    formula: Formula | None

    @property
    def first(self) -> FreeShape:
        return self.shapes[0]

    @property
    def accepted(self) -> bool:
        """Whether the first explains the data, and nothing speaks against it."""
        explains = self.first.p_value >= ADEQUATE and not self.against
        if self.gain is None:
            return False
        same = self.gain.choice == self.first.fit.name
        return explains and same and self.gain.interval[1] > 0.0

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
        first = {"law": self.first.hook.quantity, "argument": self.first.hook.argument}
        if not self.accepted:
            fields = {**first, "p_value": self.first.p_value, "lead": self.first.lead}
            return (Fact(Code.NO_FREE_SHAPE, {**fields, "level": ADEQUATE}), *self.against)
        said = [Fact(Code.FREE_SHAPE, {**first, "lead": self.first.lead, "band": 100.0 * BAND})]
        said.append(self._meaning())
        if self.rivals:
            others = [each.hook.name for each in self.rivals]
            said.append(Fact(Code.FREE_SHAPE_RIVALS, {**first, "others": others}))
        if self.gain is not None:
            fall = {"before": self.gain.chi2_before, "after": self.gain.chi2_after}
            known = {"count": len(self.gain.held_out), "certain": self.gain.interval[0] > 0.0}
            said.append(Fact(Code.FREE_SHAPE_GAIN, {**fall, **known}))
        if self.formula is not None:
            fields = {"formula": self.formula.in_numbers(self.first.hook.unit)}
            said.append(Fact(Code.FREE_SHAPE_FORMULA, {**fields, "argument": first["argument"]}))
        return tuple(said)

    def _meaning(self) -> Fact:
        """What f and its argument are, and where the data say something of them."""
        hook, reach = self.first.hook, {"reach": self.first.span, "told": self.curve.told}
        law = {"law": hook.quantity, "argument": hook.argument, "unit": hook.unit, **reach}
        return Fact(Code.FREE_SHAPE_MEANING, {**law, "size": "|u|" if hook.both_ways else "u"})

    def as_dict(self) -> dict[str, object]:
        """For report.json; SI units."""
        formula, curve = self.formula, self.curve
        return {
            "accepted": self.accepted,
            "hooks": self.table().to_dict("records"),
            "curve": {name: getattr(curve, name).tolist()
                      for name in ("argument", "law", "low", "high")} | {"unit": curve.unit},
            "formula": None if formula is None else {
                "text": formula.text, "a": formula.a, "b": formula.b, "p_value": formula.p_value
            },
            "gain": None if self.gain is None else self.gain.as_dict(),
        }  # fmt: skip

    def table(self) -> DataFrame:
        """A row for each hook: `effect`, `law`, `argument`, `span`, `unit`, `lead`, `p`."""
        import pandas as pd

        return pd.DataFrame(
            {
                "effect": each.hook.effect,
                "law": each.hook.quantity,
                "argument": each.hook.argument,
                "span": each.span,
                "unit": each.hook.unit,
                "lead": each.lead,
                "p": each.p_value,
            }
            for each in self.shapes
        )


def explore_free_shapes(
    problem: Problem,
    covariance: Array,
    constants: Array,
    spans: Mapping[str, float],
    held_out: Indices,
    scenario: Scenario,
    seed: int,
    against: Callable[[Problem, Fit, Fit], tuple[Fact, ...]],
) -> OpenSet | None:
    """Fit a free curve at each hook, and rank them.

    Parameters
    ----------
    problem : Problem
        Whose causes are the hooks of `spans`, by their effects' names.
    covariance : ndarray, shape (m, m)
        Of the observed means.
    constants : ndarray, shape (constants,)
        Coordinates of the recalibrated model.
    spans : dict
        How far each argument reaches, by effect.
    held_out : ndarray of int
        Conditions that the gain is measured on.
    scenario : Scenario
        Any that knows the effects.
    seed : int
        Of the bootstrap of the gain.
    against : callable
        ``against(problem, null, fit)`` is what speaks against a fit, beside the recalibrated model.

    Returns
    -------
    OpenSet, optional
        None where there is no hook.
    """
    if not problem.causes:
        return None
    hooks = {hook.effect: hook for hook in HOOKS}
    x = np.concatenate([constants, np.zeros(problem.size - problem.base_count)])
    (null,) = fit_candidates(problem, [make_candidate(problem)], [[Start(x)]], 6)
    fits = _fits(problem, null)
    # With errors that are taken as too large, five knots may be led astray.
    fits = refit_worse_than_null(problem, null, fits)
    shapes = tuple(
        FreeShape(
            hooks[fit.name],
            spans[fit.name],
            fit,
            fit.log_evidence - null.log_evidence,
            adequacy(problem, fit),
        )
        for fit in ranked(fits)
    )
    first = shapes[0]
    gain = measure_gain(
        problem, covariance, held_out, null, first.fit, [each.fit for each in shapes[1:3]], seed
    )
    curve, formula = _curve(problem, first, scenario)
    return OpenSet(problem, shapes, against(problem, null, first.fit), gain, curve, formula)


def _fits(problem: Problem, null: Fit) -> tuple[Fit, ...]:
    """The best fit at each hook, from the null and from changes of one knot alone.

    The constants of the null make up for the law as far as they can, so that a change also begins
    at the middle of their priors.
    """
    candidates, begins = [], []
    for cause in problem.causes:
        points = []
        for constants in (null.x, np.zeros(problem.size)):
            for column in problem.columns([cause]):
                for sign in (1.0, -1.0):
                    x = constants.copy()
                    x[column] = sign
                    points.append(Start(x))
        candidates.append(make_candidate(problem, [cause]))
        begins.append(points)
    ordered = starts_by_misfit(problem, candidates, begins)
    plan = [
        (candidate, start)
        for candidate, points in zip(candidates, ordered, strict=True)
        for start in (Start(null.x), *points[:_STARTS])
    ]
    quick = quick_fits(problem, [each for each, _ in plan], [[start] for _, start in plan], 1)
    best: dict[str, Fit] = {}
    others: dict[str, list[Start]] = {}
    for fit in sorted(quick, key=lambda fit: fit.chi2):
        if best.setdefault(fit.name, fit) is not fit:
            others.setdefault(fit.name, []).append(Start.of(fit))
    return refine(problem, list(best.values()), others, survivors=len(best))


def _curve(problem: Problem, shape: FreeShape, scenario: Scenario) -> tuple[Curve, Formula | None]:
    """The curve of a fit with its band, and a formula for it."""
    hook, span, fit = shape.hook, shape.span, shape.fit
    values = problem.physical(fit.x[None, :])[0]
    knots = [each for each in free_parameters(problem, fit) if each.name in hook.knots]
    own = [each for each in free_parameters(problem, fit) if each.name == hook.constant]
    constant, unit = 1.0, "of the model's"
    if hook.constant is not None:
        constant = float(values[own[0].column] if own else scenario.get(hook.constant))
        unit = known_keys()[hook.constant].unit
    argument = np.linspace(-span if hook.both_ways else 0.0, span, _POINTS)
    design = curve_design(scenario, hook, span, argument)
    change = values[[each.column for each in knots]]
    # As the core cuts it off.
    factor = np.maximum(1.0 + design @ change, 0.0)
    slopes = np.hstack(
        [*(factor[:, None] for _ in own), constant * design * (factor > 0.0)[:, None]]
    )
    spread = physical_covariance(fit, [*own, *knots])
    sd = np.sqrt(np.sum((slopes @ spread) * slopes, axis=1))
    width, law = normal_law.ppf(0.5 + 0.5 * BAND) * sd, constant * factor
    curve = Curve(argument, law, np.maximum(law - width, 0.0), law + width, constant, unit)
    places = argument[np.argmax(design, axis=0)]
    alone = physical_covariance(fit, knots)
    return curve, find_formula(places, change, alone, span, hook.unit == "rad")
