"""Score of a diagnosis of a measured set beside the known truth."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from causes.tools import TOOLS, Asked, ours
from scores import CLAIMS, FEW, markdown, share

from stickslip import Cause, Diagnosis, diagnose, read_measurement
from stickslip.diagnosis.fitting.problem import Problem

_FAR = 3.0
"""Standard deviations. Chosen: an estimate farther from the truth than that is wrong."""
_MOST_SHOWN = 4
"""Causes of a set that are listed. Chosen: they fit in a table."""


@dataclass(frozen=True)
class Truth:
    """Truth of a set, known without the diagnosis.

    present, possible: Causes that act for certain, and further ones of which it is not known
    whether they do. values: Parameters that are known, each by its value and standard
    deviation. certain: Whether it is known at all, or only what can be said from the same data.
    """

    present: tuple[str, ...]
    possible: tuple[str, ...] = ()
    values: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    certain: bool = True


@dataclass(frozen=True)
class Measured:
    """A measured set.

    name. unit: Factor from SI to the unit of errors in the table, and its name. truth.
    diagnosed: ``diagnosed(without)``: the diagnosis, with these causes not listed.
    """

    name: str
    unit: tuple[float, str]
    truth: Truth
    diagnosed: Callable[[Collection[str]], Diagnosis]


@dataclass(frozen=True)
class Row:
    """A row of the table, as text.

    listed: Whether the causes that act were offered. alone: Mean absolute error of the model as it
    is stated. judgement: See `judged`. others: What the tools of `causes.tools` say of the same
    problem, with the errors that the diagnosis found.
    """

    set: str
    listed: str
    readings: int
    verdict: str
    found: str
    size: str
    share: str
    alone: str
    gain: str
    judgement: str
    reasons: tuple[str, ...]
    cpu_s: float
    others: str


def with_absent(
    p: Mapping[str, np.ndarray], causes: Iterable[Cause]
) -> dict[str, np.ndarray | float]:
    """The parameters, and 0 for those of causes that are not listed."""
    return {**{each.name: 0.0 for cause in causes for each in cause.parameters}, **p}


def of_files(path: Path, parameter: str) -> Callable[[Collection[str]], Diagnosis]:
    """The diagnosis of a measurement's files with the simulator and its library of causes.

    An extension that is part of the scenario is no cause: one that is left out is there, with a
    billionth of its parameter.
    """

    def diagnosed(without: Collection[str]) -> Diagnosis:
        measured = read_measurement(path)
        none = {f"effects.{each}.{parameter}": 1e-9 for each in without}
        scenario = measured.scenario.replace(none)
        return diagnose(replace(measured, scenario=scenario), threads=1)

    return diagnosed


def row(measured: Measured, listed: bool = True) -> Row:
    """The set, diagnosed with the causes that act among those that are listed, or without them."""
    begin = process_time()
    result = measured.diagnosed(() if listed else measured.truth.present)
    used = process_time() - begin
    verdict = result.verdict
    return Row(
        measured.name,
        "yes" if listed else "no",
        len(result.problem.y),
        verdict.kind,
        _found(result),
        _size(result, measured.truth),
        "-"
        if verdict.share is None or np.isnan(verdict.share)
        else f"{100.0 * verdict.share:.0f} %",
        _alone(result.problem, *measured.unit),
        _gain(result, *measured.unit),
        judged(result, measured.truth),
        tuple(str(each) for each in verdict.reasons),
        round(used, 1),
        _others(result, measured.truth),
    )


def _others(result: Diagnosis, truth: Truth) -> str:
    """Each other tool, what it names, and whether all of that acts."""
    asked, said = Asked(result.problem, lambda: result, result.problem.sd), []
    for name, tool in TOOLS.items():
        if tool is not ours:
            causes = tool(asked)["causes"]
            strange = set(causes) - {*truth.present, *truth.possible}
            acts = "right" if set(causes) & set(truth.present) else "possible"
            word = "silent" if not causes else "wrong" if strange else acts
            said.append(f"{name}: {' + '.join(causes) or '-'} ({word})")
    return "; ".join(said)


def judged(result: Diagnosis, truth: Truth) -> str:
    """One of six words, and what is wrong.

    *right*: a cause is claimed that acts, none that cannot, and no size lies far from what is
    known. *possible*: what is claimed may act. *set with the truth*, *set without it*, *large set*
    of more than three. *silent*: nothing is claimed. *wrong*: all other claims.
    """
    kind, causes = result.verdict.kind, set(result.verdict.causes)
    present, allowed = set(truth.present), {*truth.present, *truth.possible}
    if kind == "ambiguous":
        if not causes & present:
            return "set without the truth"
        if len(causes) > FEW:
            return "large set"
        return "set with the truth" if truth.certain else "not contradicted"
    if kind not in CLAIMS:
        leader = result.verdict.leader
        near = kind == "unexplained" and leader is not None and leader.names & present
        return "silent, the truth nearest" if near else "silent"
    strange, off = sorted(causes - allowed), _far_off(result, truth)
    if strange or off:
        return "wrong: " + ", ".join([*strange, *off])
    if not causes & present:
        return "possible"
    return "right" if truth.certain else "not contradicted"


def _far_off(result: Diagnosis, truth: Truth) -> list[str]:
    """Parameters of what is claimed that lie far from what is known."""
    found = []
    for name, (value, sd) in truth.values.items():
        if name in result.params.index:
            fitted = result.params.loc[name]
            if abs(fitted["value"] - value) > _FAR * np.hypot(fitted["sd"], sd):
                found.append(f"{name} = {fitted['value']:.4g}")
    return found


def _found(result: Diagnosis) -> str:
    """Words on the causes that are claimed, or that come nearest."""
    causes, leader = result.verdict.causes, result.verdict.leader
    if not causes:
        return "-" if leader is None else f"nearest: {leader.name}"
    joined = (" + " if result.verdict.kind == "pair" else ", ").join(causes[:_MOST_SHOWN])
    return joined + (f" and {len(causes) - _MOST_SHOWN} more" if len(causes) > _MOST_SHOWN else "")


def _size(result: Diagnosis, truth: Truth) -> str:
    """Estimates of known parameters by the model that is claimed or nearest."""
    verdict = result.verdict
    fit = verdict.fit or verdict.leader
    if fit is None:
        return "-"
    params = result.candidate(fit.name).params
    return (
        "; ".join(
            f"{params.at[name, 'value']:.3g} ± {params.at[name, 'sd']:.2g}"
            f" {params.at[name, 'unit']} (known: {value:.3g})".replace(" - ", " ")
            for name, (value, _) in truth.values.items()
            if name in params.index
        )
        or "-"
    )


def _alone(problem: Problem, factor: float, unit: str) -> str:
    """Mean absolute error before anything is fitted, of the readings that the model computes."""
    stated = problem.model(problem.physical(np.zeros((1, problem.size))))[0]
    return f"{factor * float(np.nanmean(np.abs(problem.y - stated))):.3g} {unit}"


def _gain(result: Diagnosis, factor: float, unit: str) -> str:
    """Mean absolute error of held-out readings, recalibrated and extended, or of the leader."""
    if result.gain is None:
        return "-"
    count = result.candidate("none").prediction.groupby("table", sort=False).size()
    before, after = (
        factor * float(np.average(list(part.values()), weights=count.to_numpy()))
        for part in (result.gain.mae_before, result.gain.mae_after)
    )
    return f"{before:.3g} → {after:.3g} {unit}"


_WORDS = {
    "right": ("right",), "set of 3": ("set with the truth",),
    "possible": ("possible", "not contradicted"), "silent": ("silent", "large set"),
    "wrong": ("wrong", "set without the truth"),
}  # fmt: skip


def by_tool(rows: Iterable[Mapping[str, Any]]) -> str:
    """Of each tool how often it is right, silent or wrong, in Markdown; rows are those of `Row`."""
    said: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        if row.get("others"):
            others = [each.rstrip(")").partition(": ") for each in row["others"].split("; ")]
            judged = {"stickslip": row["judgement"],
                      **{name: text.rpartition("(")[2] for name, _, text in others}}  # fmt: skip
            for tool, word in judged.items():
                said.setdefault((row["listed"], tool), []).append(word)
    counts = {key: [sum(word.startswith(of) for word in words) for of in _WORDS.values()]
              for key, words in said.items()}  # fmt: skip
    assert all(sum(counts[key]) == len(words) for key, words in said.items())
    lines = [(listed, tool, sum(found), *(share(each, sum(found)) for each in found))
             for (listed, tool), found in sorted(counts.items(), reverse=True)]  # fmt: skip
    return markdown(";".join(("cause listed", "by", "sets", *_WORDS)), lines)
