"""Limits of the data: confounded causes, constants that trade, and upper limits."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any, TypedDict

from stickslip._util.units import unit_label
from stickslip.diagnosis.decision.cannot_tell import Alike, Combination
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.words import of_side

_COMPARED = 12  # causes whose effects are compared


class Numbers(TypedDict):
    cannot_tell: dict[str, Any] | None
    """Limits of these data, null for `data-problem`: `alike`, confounded causes (`told`: of
    the model) and `others` with similar effects beyond what the constants undo (`cosine` above
    0.9), the chi-square that tells them apart (`lead`, `parted` above 5.9), how many times these
    readings would (`more`; null: no number), the reading at which they differ most (`where`), by
    how many of its errors (`apart`); `combinations` of `parameters`, of which only some are `known`
    (`kind`, `expression`, `weights`, `value`, `sd`, `unit`); causes that would be `hidden` by
    `constants`; parameters of which the data tell less than was stated (`silent`)."""
    cosines: list[dict[str, Any]]
    """How like the effect of each leading cause can be to that of each before it, 0 to 1."""
    bounds: dict[str, dict[str, Any]]
    """By cause that is not in the model: 95 % upper limit of each parameter's magnitude, and
    for a limit that acts as it falls (`amplifier_limit.voltage`) the lowest that could be; of a
    comparison the constant that it `changes`."""


def numbers(facts: Facts) -> Numbers:
    beyond, title, parameter = facts.cannot_tell, facts.words.title, facts.words.parameter
    # One cause on either of two sides differs in sign.
    pairs = [pair for pair in beyond.alike if of_side(pair.cause)[0] != of_side(pair.other)[0]]
    compared = beyond.causes[:_COMPARED] if len(beyond.causes) > 1 else []
    return {
        "cannot_tell": {
            "alike": [
                {"cause": cause, "title": title(cause), "told": cause in facts.subject.fit.names,
                 "others": [_other(facts, pair) for pair in pairs if pair.cause == cause]}
                for cause in dict.fromkeys(pair.cause for pair in pairs)
            ],
            "combinations": [
                {"parameters": list(group.names), "titles": list(map(parameter, group.names)),
                 "known": [_combination(facts, one) for one in group.known]}
                for group in beyond.groups
            ],
            "hidden": [
                {"cause": name, "title": title(name), "constants": list(constants),
                 "titles": list(map(parameter, constants))}
                for name, constants in beyond.hidden.items()
            ],
            "silent": [{"parameter": name, "title": parameter(name)} for name in beyond.silent],
        },
        "cosines": [
            {"cause": name, "title": title(name), "cosines": beyond.cosines[k, :k].tolist()}
            for k, name in enumerate(compared)
        ],
        "bounds": _bounds(facts),
    }  # fmt: skip


def _other(facts: Facts, pair: Alike) -> dict[str, Any]:
    return {
        "cause": pair.other, "title": facts.words.title(pair.other), "cosine": pair.cosine,
        "lead": pair.lead, "parted": pair.parted, "apart": pair.apart,
        "more": None if math.isinf(pair.more) else pair.more, **facts.places[pair.row],
    }  # fmt: skip


def _bounds(facts: Facts) -> dict[str, dict[str, Any]]:
    problem, words, bounds = facts.problem, facts.words, dict[str, dict[str, Any]]()
    parameters = {parameter.name: parameter for parameter in problem.parameters}
    owners = {one.name: cause.name for cause in problem.causes for one in cause.parameters}
    limits = facts.cannot_tell.limits.items()
    for name, (value, seen) in sorted(limits, key=lambda item: item[1].value):
        one, (of, side) = parameters[name], of_side(name)
        bounds[name.removeprefix("effects.")] = {
            "value": value, "unit": one.unit, "falls": one.falls,
            "relative": value / (one.size or 1.0), "title": words.parameter(name),
            "cause": words.title(owners[name]) if name in owners else "",
            "text": words.limit(name, value, one.unit), "seen": seen,
            **({"changes": words.parameter(of)} if side and of in facts.rivals.shared else {}),
        }  # fmt: skip
    return bounds


def _combination(facts: Facts, known: Combination) -> dict[str, Any]:
    """A combination of parameters as an expression of their names."""
    units = {parameter.name: unit_label(parameter.unit) for parameter in facts.problem.parameters}
    names, powers = {name: facts.words.parameter(name) for name in known.weights}, known.weights
    if known.product:
        expression, unit = _product(names, powers), _product(units, powers)
        kind = "ratio" if sorted(powers.values()) == [-1.0, 1.0] else "product"
    else:
        expression = " ".join(
            f"{'-' if w < 0.0 else '+'} {amounts.number(abs(w)) + ' ' if abs(w) != 1.0 else ''}"
            f"{names[name]}" for name, w in powers.items()
        ).removeprefix("+ ")  # fmt: skip
        unit = next((units[name] for name, w in powers.items() if w == 1.0), "")
        kind = "sum" if set(powers.values()) == {1.0} else "combination"
    return {
        "kind": kind, "expression": expression, "weights": powers, "value": known.value,
        "sd": known.sd, "unit": unit, "text": amounts.amount(known.value, known.sd, unit),
    }  # fmt: skip


def _product(names: Mapping[str, str], powers: Mapping[str, float]) -> str:
    """``a² · b / c / d``, of names that are not empty."""
    text = ""
    for name, power in sorted(powers.items(), key=lambda item: item[1] < 0.0):
        base, size = names[name], abs(power)
        if base:
            raised = f"^{size:g}" if size % 1.0 else "⁰ ²³⁴⁵⁶"[int(size)].strip()
            by = (" · " if text else "") if power > 0.0 else " / " if text else "1 / "
            base = f"({base})" if re.search("[ /]", base) and len(powers) > 1 else base
            text += f"{by}{base}{raised}"
    return text
