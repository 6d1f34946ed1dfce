"""The models that were compared, the readings that decide, and what held-out ones say."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any, TypedDict

import numpy as np

from stickslip._util.units import is_of
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.decision.gain import Gain
from stickslip.diagnosis.fitting.models import Fit

MOST_NAMED = 3
"""Readings that are named."""


class Numbers(TypedDict):
    p_value: float | None
    """Probability that noise alone leaves such a misfit of the recalibrated model."""
    ranking: list[dict[str, Any]]
    """Each model: `candidate`, `causes`, `log_evidence` above `none`, `probability`, `chi2`,
    `p` of its lack of fit, `form` of its discrepancy, `share`, `odds` of the leader against it."""
    odds: dict[str, float] | None
    """`none`: the probability of the leader beside that of no cause; null without a leader."""
    runner_up: dict[str, Any] | None
    """The most probable model without the leader's causes, and the `odds`."""
    deciding_readings: list[dict[str, Any]]
    """The three readings that tell the leader from `runner_up`: `where`, `difference` of
    log-likelihood, its `share` in all that speaks for the leader; of a pair two for each cause
    (`for`), against the other cause alone."""
    gain: dict[str, Any] | None
    """Mean absolute error of held-out readings `before` and `after`, in their errors, and of each
    table in its unit (`mae_before`, `mae_after`; in `records` the worst first; `told`: the one that
    changes most); 95 % `interval` of the fall; `parts` that were held out; null without a leader or
    with too few conditions."""


def numbers(facts: Facts) -> Numbers:
    chance, fit, title = facts.chance, facts.subject.fit, facts.words.title
    named = facts.verdict.subject is not None
    odds = {name: chance.models[fit.name] / max(one, 1e-300) for name, one in chance.models.items()}
    other = next((e for e in chance.fits if not e.names >= fit.names), facts.findings.models.null)
    rows = facts.compare().to_dict("index").items()
    return {
        "p_value": facts.findings.test.p_value,
        "ranking": [
            {"candidate": name, "title": title(name), "causes": sorted(one.names), **row,
             "odds": odds[name]}
            for one, (name, row) in zip(chance.fits, rows, strict=True)
        ],
        "odds": {"none": odds["none"]} if named else None,
        "runner_up": {"candidate": other.name, "title": title(other.name),
                      "odds": odds[other.name]} if named else None,
        "deciding_readings": _deciding(facts, fit, other) if named else [],
        "gain": None if facts.gain is None else _gain(facts, facts.gain),
    }  # fmt: skip


def _deciding(facts: Facts, fit: Fit, other: Fit) -> list[dict[str, Any]]:
    """Those for a model against its runner-up; of a pair, for each cause against the other one."""
    models = facts.findings.models
    alone = {name: models.get(fit.names - {name}) for name in sorted(fit.names)}
    if facts.verdict.kind != "pair" or None in alone.values():
        return _against(facts, fit, other)
    return [
        {**reading, "for": facts.words.title(name)}
        for name, one in alone.items() if one is not None
        for reading in _against(facts, fit, one)[:2]
    ]  # fmt: skip


def _against(facts: Facts, fit: Fit, other: Fit) -> list[dict[str, Any]]:
    """The readings that speak most for a model, by the difference of log-likelihood."""
    models, problem = facts.findings.models, facts.problem
    pair = [models.get(one.names) or one for one in (fit, other)]
    square = problem.whitened(np.stack([one.residual for one in pair], axis=1)) ** 2
    gain = 0.5 * (square[:, 1] - square[:, 0])
    whole = float(np.sum(gain[gain > 0.0]))
    most = [(k, float(gain[k])) for k in np.argsort(-gain).tolist()[:MOST_NAMED] if gain[k] > 0.0]
    return [{**facts.places[k], "difference": one, "share": one / whole} for k, one in most]


def _gain(facts: Facts, gain: Gain) -> dict[str, Any]:
    """The gain, and `told`: the table whose error changes most, in its unit and in per cent."""
    problem, best = facts.problem, -math.inf
    entry = {**asdict(gain), "interval": list(gain.interval), "records": []}
    for table, part, name, title, _ in problem.parts:
        if not table.drawable:
            continue
        one = {"before": gain.mae_before[name], "after": gain.mae_after[name]}
        entry["records"].append({"title": title, "unit": table.unit, **one})
        change = abs(one["before"] - one["after"]) / float(np.median(problem.sd[part]))
        if change > best:
            best, level = change, float(np.mean(np.abs(problem.y[part])))
            # Of an angle or a temperature a share says nothing.
            of_level = not (is_of(table.unit, "rad") or is_of(table.unit, "K"))
            entry["told"] = {"table": title, **one, "unit": table.unit, "level": level,
                             "of_level": of_level}  # fmt: skip
    entry["records"].sort(key=lambda record: -record["after"] / max(record["before"], 1e-300))
    entry["change"] = "falls" if gain.certain else "grows" if gain.interval[1] < 0.0 else "not sure"
    return entry
