"""A law of another shape."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypedDict

import numpy as np

from stickslip._util.units import unit_label
from stickslip.diagnosis.decision.candidate import Candidate, spread_of
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.curve import CURVE, SHAPES, Curve

_POINTS = 41  # of a curve


class Numbers(TypedDict):
    law: dict[str, Any] | None
    """Of a law of another shape: `name`, its curve (`at`, `value`, `low` and `high`, which hold
    95 %, `unit` and `law_unit`), its `form`, the probabilities of its `forms`, and the `lines` that
    state it; else null."""


def numbers(facts: Facts) -> Numbers:
    return {"law": law_of(facts.subject)}


def law_of(candidate: Candidate) -> dict[str, Any] | None:
    """A law of another shape with its 95 % band, the probabilities of its forms, and its lines."""
    problem, fit = candidate.models.problem, candidate.fit
    cause = next((cause for cause in fit.causes if cause.curve is not None), None)
    if cause is None or cause.curve is None:
        return None
    curve, values = cause.curve, candidate.values()
    at, columns = np.linspace(curve.low, curve.high, _POINTS), values[:, problem.columns([cause])]
    law = curve.at(at[None, :], columns)
    base = np.full(len(values), curve.stated)
    if curve.relative:
        if curve.constant is not None:
            base = values[:, problem.names.index(curve.constant)]
        law = base[:, None] * (1.0 + law)
    half = 1.96 * np.sqrt(np.diag(spread_of(law)))
    sizes = dict(zip(cause.names, columns[0].tolist(), strict=True))
    return {
        "name": curve.name, "law": curve.law if curve.relative else f"change of {curve.law}",
        "law_unit": curve.law_unit, "argument": curve.argument, "unit": curve.unit,
        "at": at.tolist(), "value": law[0].tolist(), "low": (law[0] - half).tolist(),
        "high": (law[0] + half).tolist(), "form": curve.form,
        "forms": candidate.models.of_forms.get(fit.names, {curve.form: 1.0}),
        "lines": _lines(curve, float(base[0]), sizes),
    }  # fmt: skip


def _lines(curve: Curve, base: float, sizes: Mapping[str, float]) -> list[str]:
    """A law as a scenario states it; that of a model of one's own as a formula, if it has one."""
    if curve.statement is not None:
        return curve.statement.lines(sizes)
    if curve.form == CURVE:
        return []
    a, scale = [*sizes.values(), curve.reach][:2]
    text, unit = f"{amounts.number(a)} {SHAPES[curve.form].text}", unit_label(curve.law_unit)
    right = f"{amounts.number(base)} {unit}".rstrip() + f" (1 + {text})"
    right = right if curve.relative else f"{text} {unit}".rstrip()
    less = f"({curve.argument} - {amounts.number(curve.origin)})"
    length = f"{amounts.number(scale)} {unit_label(curve.unit)}".rstrip()
    return [f"{curve.law} = {right}, u = {less if curve.origin else curve.argument} / {length}"]
