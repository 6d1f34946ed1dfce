"""How large the causes of the verdict are, and what is left beside them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, TypedDict

import numpy as np

from stickslip._util.units import unit_label
from stickslip.diagnosis.decision.candidate import Candidate, spread_of
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.decision.posterior import SURE
from stickslip.diagnosis.decision.verdict import DOMINANT
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.curve import CURVE, SHAPES, Curve
from stickslip.diagnosis.terms.words import of_side

_POINTS = 41  # of the curve of a law
_NO_NEWS = 0.9  # of its prior's error, from which on data tell nothing of a shape; chosen
_FURTHER = 0.01  # probability from which on a further cause is named
_MOST_OF_IT = 0.5  # share from which on a sure cause is said to act, with something beside it
_OF_MODEL = ("value", "sd", "low", "high")

Rows = dict[str, dict[str, Any]]


class Numbers(TypedDict):
    parameters: Rows
    """Parameters of the cause by name, such as `surface_tilt.angle`: `value`, `sd`, `low` and
    `high` (95 %), `unit`, `prior`, `pull`, `title`, the prior in words (`before`), and whether
    its middle is no effect, 0 (`about_zero`). For `ambiguous` those of the first model of the set
    that has it, beside `value`, `sd`, `low` and `high` in each of its `models`; empty for
    `unexplained`."""
    claimed: list[dict[str, Any]]
    """The models of the verdict in words, each with its `probability` and `causes`."""
    leader: dict[str, Any] | None
    """The model that is reported, as in `claimed`, with the probability of its causes with any
    beside them (`in_all`), the most probable of these (`further`), that among the models with a
    cause (`among_causes`), its `share`, and what is `left`, in words."""
    discrepancy: dict[str, Any] | None
    """The discrepancy beside the cause: `form` (<form>) and, unless that is `exact`, `kappa`, the
    scatter in the stated errors, `size` of each table in its unit, `correlation` in readings of a
    run, `length` in half the range of a setting."""
    law: dict[str, Any] | None
    """A law of another shape: `name`, its curve (`at`, `value`, `low` and `high`, which hold
    95 %, `unit` and `law_unit`), its `form`, the probabilities of its `forms`, and the `lines` that
    state it; else null."""


def numbers(facts: Facts) -> Numbers:
    verdict = facts.verdict
    fits = verdict.members if verdict.kind == "ambiguous" else [verdict.fit]
    members = [Candidate(fit, facts.findings.models) for fit in fits if fit and fit.causes]
    parameters: Rows = {}
    for candidate in members:
        rows = rows_of(facts, candidate)
        for name in (name for cause in candidate.fit.causes for name in cause.names):
            row = parameters.setdefault(name.removeprefix("effects."), {**rows[name], "models": {}})
            row["models"][candidate.name] = {key: rows[name][key] for key in _OF_MODEL}
    return {
        "parameters": parameters,
        "claimed": [_claim(facts, candidate) for candidate in members],
        "leader": None if verdict.subject is None else _leader(facts, facts.subject),
        "discrepancy": facts.subject.left,
        "law": law_of(facts.subject),
    }


def rows_of(facts: Facts, candidate: Candidate) -> Rows:
    """The parameters of a candidate by full name, with 95 % and their words."""
    ends, words = candidate.interval(0.95).to_dict("index"), facts.words
    known = {parameter.name: parameter for parameter in facts.problem.parameters}
    rows: Rows = {}
    for name, row in candidate.params.to_dict("index").items():
        one = known[name]
        rows[name] = {
            **row, **ends[name], "before": words.before(one), "title": words.parameter(name),
            "about_zero": one.is_amplitude and not one.falls and one.absent == 0.0,
        }  # fmt: skip
    for constant in facts.problem.constants:
        rows[constant.name]["stated"] = constant.middle if constant.is_stated else None
    return rows


def _leader(facts: Facts, candidate: Candidate) -> dict[str, Any]:
    fit, chance = candidate.fit, facts.chance
    with_cause, in_all = 1.0 - chance.none, facts.probability_of(fit.names)
    larger = next((one for one in chance.fits if one.names > fit.names), None)
    further = ""
    if larger is not None and chance.models[larger.name] >= _FURTHER:
        further = facts.words.title(" + ".join(sorted(larger.names - fit.names)))
    part = -math.inf if math.isnan(candidate.share) else candidate.share
    return {
        **_claim(facts, candidate),
        "among_causes": chance.models[fit.name] / with_cause if with_cause > 0.0 else 0.0,
        "in_all": in_all, "further": further, "share": None if part < 0.0 else part,
        "acts": in_all >= SURE and part > _MOST_OF_IT,
        "takes_most": in_all >= SURE and part >= DOMINANT,
        "left": _left(facts, candidate if facts.verdict.fit else facts.recalibrated),
    }  # fmt: skip


def _claim(facts: Facts, candidate: Candidate) -> dict[str, Any]:
    known = {parameter.name: parameter for parameter in facts.problem.parameters}
    step = max((table.step or 0.0 for table in facts.problem.tables), default=0.0)
    rows = rows_of(facts, candidate)
    for name, row in rows.items():
        # Of a shape the data may say no more than its prior.
        one, (low, high) = known[name], known[name].value(np.array([-1.0, 1.0])).tolist()
        shown = one.is_amplitude or one.cause or row["sd"] < _NO_NEWS * 0.5 * (high - low)
        row |= {"shown": shown, "step": step}
    causes = []
    for cause in candidate.fit.causes:
        sizes = {name: rows[name] for name in cause.names}
        told: dict[str, Any] = facts.words.description(cause, sizes)
        causes.append(told | _otherwise(facts, candidate, cause, sizes))
    return {"candidate": candidate.name, "title": facts.words.title(candidate.name),
            "probability": facts.chance.models[candidate.name], "causes": causes}  # fmt: skip


def _otherwise(facts: Facts, candidate: Candidate, cause: Cause, sizes: Rows) -> dict[str, Any]:
    """Sentences on a law of another shape, and on a constant of two sides that are compared."""
    words, (of, side), told = facts.words, of_side(cause.name), dict[str, Any]()
    if cause.curve is not None:
        # Drawings have the names of the laws.
        article = "an" if cause.curve.form.startswith("e") else "a"
        form = "" if cause.has_knots else f", {article} {cause.curve.form}"
        told = {"finding": f"The law of {cause.curve.name} has another shape{form}.",
                "drawing": cause.curve.law, "interval": ""}  # fmt: skip
    if side and of in facts.rivals.shared:
        (by,) = sizes.values()
        was = facts.rivals.sides(candidate.params["value"].to_dict())["before"][of]
        what, far, error = words.parameter(of), by["value"], (by["sd"], by["unit"])
        ends = " to ".join(words.near(of, each, *error) for each in (was, was + far))
        moved = f"{'rose' if far > 0.0 else 'fell'} from {ends}"
        what = what if what.startswith("`") else f"The {what}"
        told["finding"] = f"{what} {moved}, by {words.size(of, abs(far), *error)}."
    return told


def _left(facts: Facts, candidate: Candidate) -> list[str]:
    """The rest beside a cause, and the errors of readings, a text for each table."""
    left, texts, problem = candidate.left, [], facts.problem
    for table, part, name, title, _ in problem.parts:
        if not (size := left.get("size", {}).get(name, 0.0)):
            continue
        factor, unit = table.shown_unit(0)
        text = f"{amounts.number(size * factor, 2)} {unit}".rstrip()
        text = f"{'a scatter' if left['form'] == 'white' else 'an error'} of {text} in {title}"
        if name in left.get("correlation", {}):
            lasts = amounts.number(left["correlation"][name] * (table.step or 1.0), 2)
            what = f"length of {lasts} readings" if table.step is None else f"time of {lasts} s"
            text += f" with a correlation {what}"
        level = float(np.mean(np.abs(problem.y[part])))
        errors = amounts.number(float(np.median(problem.sd[part])) * factor, 2)
        text += f" ({amounts.percent(size / level)} of their mean)" if 0.0 < size < level else ""
        texts.append(f"{text}, beyond the readings' errors of {errors} {unit}".rstrip())
    return texts


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
