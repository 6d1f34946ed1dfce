"""Formulas fitted to the data in the place of a curve of free shape."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fit.careful_fit import CAREFUL, refine
from stickslip.diagnosis.fit.fit_result import Fit, make_candidate
from stickslip.diagnosis.fit.goodness import ADEQUATE, adequacy
from stickslip.diagnosis.fit.multistart import fit_candidates
from stickslip.diagnosis.inference.form_curves import FormCurves
from stickslip.diagnosis.inference.form_starts import LinearModel, form_starts
from stickslip.diagnosis.inference.formulas import Form, Formula
from stickslip.diagnosis.inference.verdict import AT_END, MARGIN
from stickslip.diagnosis.model.free_terms import Term
from stickslip.diagnosis.model.problem import Predict, Problem

# How much less likely than the curve a formula may be, in log-evidence. Chosen: five knots cannot
# have its shape to the last, which costs it some units.
_BEHIND = 7.0


def find_formulas(problem: Problem, term: Term, fit: Fit) -> tuple[Formula, ...]:
    """Formulas that explain the data in the place of a curve, the most likely one first.

    Each has to be adequate, inside the ranges of its numbers and nearly as likely as the curve; the
    others are nearly as likely as the first. The constants are fitted again beside each.

    Parameters
    ----------
    problem : Problem
        Whose causes are those of terms.
    term : Term
    fit : Fit
        Of this term.
    """
    curves = FormCurves.near(problem, term, fit)
    formed = replace(
        problem,
        predict=_with_formulas(problem, curves),
        causes=tuple(curves.cause(form) for form in curves.forms),
        # Only where errors are taken as too large would another model be asked for.
        low_fidelity=None,
    )
    candidates = [make_candidate(formed, [cause]) for cause in formed.causes]
    linear = LinearModel.about(problem, term, fit)
    begins = [form_starts(formed, curves, linear, form) for form in curves.forms]
    quick = fit_candidates(formed, candidates, begins, CAREFUL, exact=False)
    found = []
    for each in refine(formed, quick, {}, 1):
        form = next(form for form in curves.forms if form.text == each.name)
        formula = _formula(formed, curves, form, each, fit)
        inside = formula.p_value >= ADEQUATE and formula.lead > -_BEHIND
        if inside and not _at_end(formed, each):
            found.append(formula)
    return tuple(each for each in found if each.lead > found[0].lead - MARGIN)


def _with_formulas(problem: Problem, curves: FormCurves) -> Predict:
    """The model of the terms, which takes the constants and the parameters of all forms."""
    base, columns = problem.base_count, problem.columns([curves.term.cause])
    absent = problem.physical(np.zeros((1, problem.size)))[0]

    def of_formulas(conditions: Any, parameters: Array) -> Array:
        values = np.tile(absent, (len(parameters), 1))
        values[:, :base] = parameters[:, :base]
        values[:, columns] = curves.knots(parameters[:, base:])
        return problem.predict(conditions, values)

    return of_formulas


def _formula(formed: Problem, curves: FormCurves, form: Form, fit: Fit, of_curve: Fit) -> Formula:
    values = formed.physical(fit.x[None, :])[0]
    own = values[formed.columns(fit.candidate.causes)]
    scale = curves.scale(form)
    return Formula(
        text=form.text,
        a=float(own[0]) / scale**form.power,
        places=tuple(float(each) * scale for each in own[1:]),
        origin=curves.term.origin,
        without=curves.term.without(dict(zip(formed.names, values.tolist(), strict=True))),
        lead=fit.log_evidence - of_curve.log_evidence,
        p_value=adequacy(formed, fit),
    )


def _at_end(formed: Problem, fit: Fit) -> bool:
    """Whether a number of the formula is at the end of its range."""
    own = formed.columns(fit.candidate.causes)
    low, high = (end[own] for end in formed.limits())
    return bool(np.any((fit.x[own] <= low + AT_END) | (fit.x[own] >= high - AT_END)))
