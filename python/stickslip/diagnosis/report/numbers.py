"""The one dictionary of a report: every number of the page, of report.json and of ``--json``."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from html import unescape
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip import _core
from stickslip._util.html import page_text
from stickslip._util.numbers import Array, Mask
from stickslip.diagnosis.candidate import Candidate, spread_of, table_name
from stickslip.diagnosis.data.series import Series
from stickslip.diagnosis.data.table import Settings
from stickslip.diagnosis.data.velocity import VelocityTable
from stickslip.diagnosis.decision.experiments import advice
from stickslip.diagnosis.decision.formulas import formula
from stickslip.diagnosis.decision.gain import held_out, parts_of
from stickslip.diagnosis.decision.limits import upper_limits
from stickslip.diagnosis.decision.posterior import ALIKE, cosine
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.problem import LOST
from stickslip.diagnosis.report import amounts
from stickslip.diagnosis.report.amounts import Words
from stickslip.diagnosis.report.readings import (
    in_words,
    setting_text,
    title_of,
    varied,
)

if TYPE_CHECKING:
    from stickslip.diagnosis.result import Diagnosis

_DECIDING, _POINTS = 3, 41  # readings that are named; points of a law
_FURTHER = 0.01  # probability from which on a further cause is named

# Of a pattern of the misfit: the least lead of its log-likelihood, what each setting in it costs,
# the share of its square on one side, and ends of ranges that are tried. Chosen: more than the best
# of some hundred ranges of noise has; hardly a reading against the sign; a twentieth of the data.
_STANDS_OUT, _A_WORD, _ONE_SIDED, _ENDS = 4.0, 2.0, 0.9, 21


def numbers_of(result: Diagnosis, title: str | None = None) -> dict[str, Any]:
    """All numbers, by the keys of the reference, in SI units unless a text says its unit."""
    verdict, found = result.verdict, result.findings
    source = result.measurement
    lost = [*(() if source is None else map(str, source.left_out)), *_of_tables(result, "left_out")]
    numbers: dict[str, Any] = {
        "verdict": verdict.kind,
        "cause": _cause(result),
        "name": title or ("Diagnosis" if source is None else source.name),
        "headline": "",
        "parameters": {},
        "probabilities": dict(verdict.probabilities),
        "p_value": found.test.p_value if result.fitted else None,
        "share": _or_none(verdict.share),
        "discrepancy": None,
        "gain": _gain(result),
        "deciding_readings": [],
        "bounds": {},
        "next": str(result.next_step),
        "next_experiments": [],
        "reasons": [_words(result, str(each)) for each in verdict.reasons],
        "notes": notes_of(result),
        "left_out": lost,
        "recalibrated": {},
        "ranking": [],
        "conditions": _conditions(result),
        "channels": _channels(result),
        "claimed": [],
        "law": None,
        "moved": None,
        "leader": None,
        "runner_up": None,
        "left": result.next_step.value if result.next_step.code == "cause-left" else None,
        "common": [_title(result, each) for each in verdict.common],
        "beside": _beside(result),
        "offered": len(result.problem.causes),
        "odds": None,
        "alike": [],
        "misfit": [],
        "pattern": None,
        "suspect": [],
        "advice": [],
        "tests": {"lack_of_fit": found.test.lack_of_fit, "score": found.test.score},
        "seed": found.seed,
        "version": _core.__version__,
        "of_measurement": source is not None,
    }
    if result.fitted:
        numbers |= _of_models(result, numbers["conditions"])
    elif verdict.reasons:
        numbers["suspect"] = _suspect(result)
    if source is not None and verdict.kind == "ambiguous":
        numbers["next_experiments"] = _experiments(result)
        names = {each: _title(result, each) for each in verdict.causes}
        looks = advice(names, result.propose_experiments())
        numbers["advice"] = [
            re.sub(r": this shows (.*), and nothing of .*", r". This shows \1 alone.", str(each))
            for each in looks
        ]
    numbers["headline"] = summary_text(numbers, words_of(result)).split("\n", 1)[0]
    return numbers


def words_of(result: Diagnosis) -> Words:
    """The words of causes and parameters: the user's where the model is."""
    return Words(own=result.measurement is None)


def summary_text(numbers: Mapping[str, Any], words: Words) -> str:
    """The verdict and what it rests on, as the command and `Diagnosis.summary` print it."""
    page = page_text("diagnosis/report/summary.txt.j2", report=numbers, a=amounts, w=words)
    return "\n".join(line.rstrip() for line in unescape(page).strip().split("\n"))


def _of_tables(result: Diagnosis, what: str) -> list[str]:
    """Notes of the tables; those of a film, or of one of several tables, with its name."""
    tables = result.problem.tables
    return [
        f"{title_of(table, k)}: {each}" if len(tables) > 1 or not table.drawable else str(each)
        for k, table in enumerate(tables)
        for each in getattr(table, what)
    ]


def notes_of(result: Diagnosis) -> list[dict[str, Any]]:
    """All notes, those that nearly every report has last."""
    own = [each for table in result.problem.tables for each in table.notes]
    texts = [*map(str, result.notes), *_of_tables(result, "notes")]
    found = [
        {"code": each.code, "text": text, "routine": each.code in amounts.ROUTINE}
        for each, text in zip([*result.notes, *own], texts, strict=True)
    ]
    return sorted(found, key=lambda each: bool(each["routine"]))


def _or_none(value: float | None) -> float | None:
    """A number of JSON, which has no NaN."""
    return None if value is None or math.isnan(value) else value


def _words(result: Diagnosis, text: str) -> str:
    return words_of(result).in_titles(text, result.problem.causes)


def _title(result: Diagnosis, name: str) -> str:
    return words_of(result).title(name, result.problem.causes)


def _cause(result: Diagnosis) -> str | list[str] | None:
    verdict = result.verdict
    if verdict.kind in ("named", "dominant"):
        return verdict.causes[0]
    return list(verdict.causes) if verdict.causes else None


def _of_models(result: Diagnosis, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What there is where models were fitted; `rows` are the conditions."""
    verdict, models = result.verdict, result.findings.models
    table, fits = result.compare(), result.chance.fits
    told = verdict.fit or verdict.leader if verdict.kind != "none" else None
    best = result.recalibrated if told is None else Candidate(told, models)
    ranking = [
        {
            "candidate": name, "title": _title(result, name), "causes": sorted(fit.names), **row,
            "odds": _odds(result, best.name, name),
        }
        for fit, (name, row) in zip(fits, table.to_dict("index").items(), strict=True)
    ]  # fmt: skip
    other = None if told is None else _other(result, told)
    members = [verdict.fit] if verdict.fit is not None else []
    if verdict.kind == "ambiguous":
        members = [each for each in verdict.members if each.causes]
    candidates = [Candidate(each, models) for each in members]
    parameters: dict[str, Any] = {}
    for each in candidates:
        for sizes in _sizes(result, each).values():
            for name, size in sizes.items():
                parameters.setdefault(name.removeprefix("effects."), size)
    return {
        "parameters": parameters,
        "discrepancy": best.left,
        "ranking": ranking,
        "claimed": [_told(result, each) for each in candidates],
        "leader": None if told is None else _leader(result, best),
        "law": law_of(best),
        "odds": None if told is None else {"none": _odds(result, told.name, "none")},
        "runner_up": None if other is None or told is None else _runner_up(result, told, other),
        "recalibrated": _recalibrated(result),
        "moved": _moved(result),
        "deciding_readings": (
            [] if other is None or told is None else _all_deciding(result, told, other, rows)
        ),
        "misfit": _misfit(result, rows),
        "pattern": _pattern(result) if verdict.kind == "unexplained" else None,
        "alike": [] if told is None else _alike(result, told),
        "bounds": _bounds(result) if verdict.kind == "none" else {},
    }


def _beside(result: Diagnosis) -> list[str]:
    """What the members of a set have beside the causes that all of them have."""
    common = frozenset(result.verdict.common)
    rest = (" + ".join(sorted(each.names - common)) or "none" for each in result.verdict.members)
    return [_title(result, each) if each != "none" else "nothing else" for each in rest]


def _sizes(result: Diagnosis, candidate: Candidate) -> dict[str, dict[str, dict[str, Any]]]:
    """Parameters of each cause of a candidate with their errors, by full name."""
    rows, ends = candidate.params.to_dict("index"), candidate.interval(0.95).to_dict("index")
    constants = {each.name: each for each in result.problem.constants}
    known = {each.name: each for each in result.problem.parameters}
    found: dict[str, dict[str, dict[str, Any]]] = {}
    for cause in candidate.fit.causes:
        names = [each.name for each in cause.parameters]
        if not names and cause.frees is not None:
            names = [cause.frees]
        found[cause.name] = {
            k: {
                **rows[k], **ends[k], "before": words_of(result).before(known[k]),
                "title": words_of(result).parameter(k),
            }
            for k in names
        }  # fmt: skip
        for each in constants.keys() & set(names):
            found[cause.name][each]["stated"] = float(constants[each].value(np.zeros(1))[0])
    return found


def _told(result: Diagnosis, candidate: Candidate) -> dict[str, Any]:
    sizes = _sizes(result, candidate)
    causes = []
    for each in candidate.fit.causes:
        said: dict[str, Any] = words_of(result).told(each, sizes[each.name])
        if each.curve is not None:
            # Drawings have the names of the laws.
            said |= {"finding": f"The law of {each.curve.name} has another shape.",
                     "drawing": each.curve.law, "interval": ""}  # fmt: skip
        causes.append(said)
    chance = result.chance.models[candidate.name]
    return {"candidate": candidate.name, "title": _title(result, candidate.name),
            "probability": chance, "causes": causes}  # fmt: skip


def _leader(result: Diagnosis, candidate: Candidate) -> dict[str, Any]:
    """The model that is told: its probability among those with a cause, its share and its gain."""
    with_cause = 1.0 - result.chance.none
    own = result.chance.models[candidate.name]
    return {
        **_told(result, candidate),
        "among_causes": own / with_cause if with_cause > 0.0 else 0.0,
        "in_all": result.probability_of(candidate.fit.names),
        "further": _further(result, candidate.fit),
        "share": _or_none(candidate.share),
        "left": _left_in_words(result, candidate if result.verdict.fit else result.recalibrated),
    }


def _further(result: Diagnosis, told: Fit) -> str:
    """The most probable cause beside those that are told, where it has more than 1 %."""
    larger = (each for each in result.chance.fits if each.names > told.names)
    most = next(larger, told)
    seen = most is not told and result.chance.models[most.name] >= _FURTHER
    return _title(result, " + ".join(sorted(most.names - told.names))) if seen else ""


def _left_in_words(result: Diagnosis, candidate: Candidate) -> list[str]:
    """What is left beside a cause, and the errors of readings, a text for each table."""
    left, said = candidate.left, []
    for k, table in enumerate(result.problem.tables):
        name = table_name(result.problem, k)
        size = left.get("size", {}).get(name, 0.0)
        if size == 0.0:
            continue
        factor, unit = table.shown_unit(0)
        text = f"{amounts.number(size * factor, 2)} {unit}".rstrip() + f" in {title_of(table, k)}"
        text = f"{'a scatter' if left['form'] == 'white' else 'an error'} of {text}"
        if name in left.get("correlation", {}):
            lasts = left["correlation"][name]
            text += (
                f" with a correlation time of {amounts.number(lasts * table.step, 2)} s"
                if isinstance(table, Series)
                else f" with a correlation length of {amounts.number(lasts, 2)} readings"
            )
        elif "length" in left:
            text += f", smooth over {amounts.percent(left['length'] / 2.0)} of a setting's range"
        part = result.problem.rows[k]
        level = float(np.mean(np.abs(result.problem.y[part])))
        own = amounts.number(float(np.median(result.problem.sd[part])) * factor, 2)
        text += f" ({amounts.percent(size / level)} of their mean)" if 0.0 < size < level else ""
        text += f", beyond the readings' errors of {own} {unit}".rstrip()
        said.append(text)
    return said


def _odds(result: Diagnosis, one: str, other: str) -> float:
    chance = result.chance.models
    return chance[one] / max(chance[other], 1e-300)


def _runner_up(result: Diagnosis, told: Fit, other: Fit) -> dict[str, Any]:
    """The most probable model that has not the causes of the one that is told, and the odds."""
    odds = _odds(result, told.name, other.name)
    return {"candidate": other.name, "title": _title(result, other.name), "odds": odds}


def _other(result: Diagnosis, told: Fit) -> Fit:
    others = (each for each in result.chance.fits if not each.names >= told.names)
    return next(others, result.findings.models.null)


def _recalibrated(result: Diagnosis) -> dict[str, Any]:
    """Each constant in both models."""
    rows = result.recalibrated.params.to_dict("index")
    ends = result.recalibrated.interval(0.95).to_dict("index")
    extended = {} if result.verdict.fit is None else result.best.params.to_dict("index")
    found = {}
    for each in result.problem.constants:
        name = each.name
        middle = each.prior is not None and each.prior.has_middle
        found[name] = {
            **rows[name], **ends[name],
            "title": words_of(result).parameter(name), "before": words_of(result).before(each),
            "stated": float(each.value(np.zeros(1))[0]) if middle else None,
            "extended": extended.get(name, {}).get("value"),
            "pull_extended": extended.get(name, {}).get("pull"),
        }  # fmt: skip
    return found


def _moved(result: Diagnosis) -> dict[str, Any] | None:
    """The constant that the recalibrated model has moved farthest."""
    pulls = abs(result.recalibrated.params["pull"])
    if not len(pulls):
        return None
    name = str(pulls.idxmax())
    return {"name": name, "title": words_of(result).parameter(name), "pull": float(pulls.max())}


def _all_deciding(
    result: Diagnosis, told: Fit, other: Fit, rows: Sequence[Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Against the runner-up; of a pair for each cause, against the other one alone."""
    models = result.findings.models
    alone = {name: models.get(told.names - {name}) for name in sorted(told.names)}
    if result.verdict.kind != "pair" or None in alone.values():
        return _deciding(result, told, other, rows)
    return [
        {**each, "for": _title(result, name)}
        for name, fit in alone.items() if fit is not None
        for each in _deciding(result, told, fit, rows)[:2]
    ]  # fmt: skip


def _misfit(result: Diagnosis, rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The readings with the largest share of the recalibrated model's chi-square."""
    residual = result.recalibrated.fit.residual
    square = np.ravel(result.problem.whitened(residual[:, None])) ** 2
    if not np.any(square):
        return []
    return [
        {**{key: rows[k][key] for key in ("table", "number", "where")},
         "share": float(square[k] / np.sum(square))}
        for k in np.argsort(-square).tolist()[:_DECIDING]
    ]  # fmt: skip


def _pattern(result: Diagnosis) -> dict[str, Any] | None:
    """The settings at which the recalibrated model misses most, how many readings, and their sign.

    Of each table the values of its words and ranges of its numbers, by the likelihood that what is
    left has a mean and a scatter of its own there; None where none stand out.
    """
    problem, residual = result.problem, result.recalibrated.fit.residual
    z, best, found = residual / problem.sd, _STANDS_OUT, None
    for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
        own, settings = z[part], table.named_settings
        whole = len(own) * math.log(max(float(np.mean(own**2)), 1.0))
        for rows, said in _regions(settings, len(own)):
            some, rest = own[rows], own[~rows]
            if min(len(some), len(rest)) < 2 or np.mean(some**2) <= np.mean(rest**2):
                continue
            # No scatter is below that of the readings.
            split = sum(
                len(each) * math.log(max(float(np.var(each)), 1.0)) for each in (some, rest)
            )
            lead = 0.5 * (whole - split) - _A_WORD * len(said)
            if lead > best:
                up = float(np.sum(some[some > 0.0] ** 2) / np.sum(some**2))
                side = "above" if up > _ONE_SIDED else "below" if up < 1.0 - _ONE_SIDED else "both"
                best, found = lead, {
                    "table": table_name(problem, k), "where": ", ".join(said), "side": side,
                    "readings": len(some), "of": len(own),
                    "share": float(np.sum(some**2) / np.sum(z**2)),
                    "mean": float(np.mean(residual[part][rows])), "unit": table.unit_of(0),
                }  # fmt: skip
    return found


def _regions(settings: Settings, count: int) -> Iterator[tuple[Mask, list[str]]]:
    """Parts of the settings' range as rows, (count,), and words: values of words, and ranges."""
    wording = [n for n in varied(settings) if isinstance(settings[n][0][0], str | bool)]
    groups: dict[tuple[str, ...], Mask] = {(): np.ones(count, dtype=bool)}
    for names in [*([each] for each in wording), wording]:
        columns = zip(*(settings[each][0] for each in names), strict=True)
        for row, value in enumerate(columns):
            key = tuple(setting_text(settings, *each) for each in zip(names, value, strict=True))
            groups.setdefault(key, np.zeros(count, dtype=bool))[row] = True
    for said, rows in groups.items():
        yield rows, list(said)
        for name in set(varied(settings)).difference(wording):
            at = np.asarray(settings[name][0], dtype=float)
            ends = np.unique(np.quantile(at, np.linspace(0.0, 1.0, _ENDS), method="nearest"))
            for low, high in itertools.combinations_with_replacement(ends.tolist(), 2):
                if (low, high) != (ends[0], ends[-1]):
                    words = [*said, setting_text(settings, name, low, high)]
                    yield rows & (at >= low) & (at <= high), words


def _suspect(result: Diagnosis) -> list[str]:
    """Of the check that the data failed what it compares, the size, and what to do."""
    note = result.verdict.reasons[0]
    ordered = (each for each in result.problem.tables if isinstance(each, VelocityTable))
    drifts = max(map(_drift, ordered), default=0.0) if note.code == "drift" else note.value
    return amounts.suspect(note.code, drifts)


def _drift(table: VelocityTable) -> float:
    """Part by which velocities change over all trials: repeats of a condition over their order."""
    mean = table.mean[table.condition]
    used = np.isfinite(table.sequence) & (mean != 0.0)
    c, order = table.condition[used], table.sequence[used]
    at = order - (np.bincount(c, order) / np.maximum(np.bincount(c), 1))[c]
    slope = float(at @ (table.y[used] / mean[used])) / max(float(at @ at), 1e-300)
    return abs(slope) * float(np.ptp(order)) if len(c) else 0.0


def _deciding(
    result: Diagnosis, told: Fit, other: Fit, rows: Sequence[Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """The readings that tell a model from its runner-up, by the difference of log-likelihood."""
    models, problem = result.findings.models, result.problem
    pair = [models.get(each.names) or each for each in (told, other)]
    square = problem.whitened(np.stack([each.residual for each in pair], axis=1)) ** 2
    gain = 0.5 * (square[:, 1] - square[:, 0])
    whole = float(np.sum(gain[gain > 0.0]))
    return [
        {
            **{key: rows[k][key] for key in ("table", "number", "where")},
            "difference": float(gain[k]), "share": float(gain[k]) / whole,
        }
        for k in np.argsort(-gain).tolist()[:_DECIDING]
        if gain[k] > 0.0
    ]  # fmt: skip


def _alike(result: Diagnosis, told: Fit) -> list[dict[str, Any]]:
    """Single causes whose projected effect is like that of the told one."""
    models = result.findings.models
    null, own = models.null, models.get(told.names) or told
    found = []
    for each in result.chance.fits:
        fit = models.get(each.names)
        if fit is None or len(each.names) != 1 or each.names <= told.names:
            continue
        value = abs(cosine(result.problem, null, null.residual - own.residual,
                           null.residual - fit.residual))  # fmt: skip
        if value > ALIKE:
            found.append({"cause": each.name, "title": _title(result, each.name), "cosine": value})
    return found


def _bounds(result: Diagnosis) -> dict[str, Any]:
    found, parameters = result.findings, {each.name: each for each in result.problem.parameters}
    limits = upper_limits(result.problem, found.models.null, found.responses)
    causes = ((each, _title(result, each.name)) for each in result.problem.causes)
    owners = {each.name: title for cause, title in causes for each in cause.parameters}
    return {
        name.removeprefix("effects."): {
            "value": value, "unit": parameters[name].unit, "falls": parameters[name].falls,
            "relative": value / (parameters[name].size or 1.0),
            "title": words_of(result).parameter(name),
            "cause": owners.get(name, ""),
            "text": words_of(result).limit(name, value, parameters[name].unit),
            "seen": not _at_end(parameters[name], value),
        }
        for name, value in sorted(limits.items(), key=lambda each: each[1])
    }  # fmt: skip


def _at_end(parameter: Any, value: float) -> bool:
    """Whether a limit is the end of the range that was searched, and thus none."""
    if parameter.falls:
        return bool(value <= parameter.low * 1.001)
    return bool(value >= 0.999 * max(abs(parameter.low), abs(parameter.high)))


def law_of(candidate: Candidate) -> dict[str, Any] | None:
    """The curve of a law of a free shape with its 95 % band, and a formula that follows it."""
    problem = candidate.models.problem
    for cause in candidate.fit.causes:
        curve = cause.curve
        if curve is None:
            continue
        at, values = np.linspace(curve.low, curve.high, _POINTS), candidate.values()
        knots = [problem.names.index(each.name) for each in cause.parameters]
        f = values[:, knots] @ curve.design(at).T
        law, constant, rows = f, None, f
        if curve.relative:
            base = np.full(len(values), curve.stated)
            if curve.constant is not None:
                column = problem.names.index(curve.constant)
                base, constant = values[:, column], problem.parameters[column]
                rows = np.column_stack([f, base])
            law = base[:, None] * (1.0 + f)
        half = 1.96 * np.sqrt(np.diag(spread_of(law)))
        found = formula(at, rows[0], spread_of(rows), curve, constant)
        return {
            "name": curve.name, "law": curve.law if curve.relative else f"change of {curve.law}",
            "law_unit": curve.law_unit, "argument": curve.argument, "unit": curve.unit,
            "at": at.tolist(), "value": law[0].tolist(), "low": (law[0] - half).tolist(),
            "high": (law[0] + half).tolist(),
            "formula": None if found is None else found.in_words(curve),
        }  # fmt: skip
    return None


def _gain(result: Diagnosis) -> dict[str, Any] | None:
    """The gain, and `told`: the table whose error changes most, in its unit and in per cent."""
    gain = result.gain
    if gain is None:
        return None
    found, best, problem = gain.as_dict(), -math.inf, result.problem
    models, told = result.findings.models, result.verdict.fit or result.verdict.leader
    assert told is not None
    names = [table_name(problem, k) for k in range(len(problem.tables))]
    if gain.mae_before.keys() != set(names):
        # Tables of one name have one error together there.
        pair = {"mae_before": models.null, "mae_after": models.get(told.names) or told}
        for key, fit in pair.items():
            left = np.abs(held_out(problem, fit, "none", parts_of(problem)))
            means = [float(np.mean(left[part])) for part in problem.rows]
            found[key] = dict(zip(names, means, strict=True))
    records = [
        {"title": title_of(table, k), "unit": table.unit,
         **{key: found[f"mae_{key}"][names[k]] for key in ("before", "after")}}
        for k, table in enumerate(problem.tables) if table.drawable
    ]  # fmt: skip
    found["records"] = sorted(
        records, key=lambda each: -each["after"] / max(each["before"], 1e-300)
    )
    for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
        before, after = (found[key][names[k]] for key in ("mae_before", "mae_after"))
        change = abs(before - after) / float(np.median(problem.sd[part]))
        if change > best and table.drawable:
            best, level = change, float(np.mean(np.abs(problem.y[part])))
            found["told"] = {
                "table": title_of(table, k), "before": before, "after": after,
                "unit": table.unit_of(0), "level": level,
            }  # fmt: skip
    found["change"] = "falls" if gain.certain else "grows" if gain.interval[1] < 0.0 else "not sure"
    return found


def _experiments(result: Diagnosis) -> list[dict[str, Any]]:
    return [
        {
            "drive": dict(each.drive), "why": _words(result, str(each.why)),
            "separation": each.separation,
            "words": _words(result, str(each).split(". ")[0]).replace("edge ", "sudden edge: "),
            "predictions": {name: dict(row) for name, row in each.predictions.items()},
        }
        for each in result.propose_experiments()
    ]  # fmt: skip


def predictions(result: Diagnosis) -> dict[str, Array]:
    """All readings as the stated, the recalibrated and the extended model have them, (n,)."""
    found: dict[str, Array] = {}
    if result.fitted:
        problem = result.problem
        stated = problem.residuals(np.zeros((1, problem.size)))[0]
        found["stated"] = np.where(stated == LOST * problem.sd, np.nan, problem.y - stated)
        found["recalibrated"] = problem.y - result.recalibrated.fit.residual
        if result.verdict.fit is not None:
            found["extended"] = problem.y - result.verdict.fit.residual
    return found


def _conditions(result: Diagnosis) -> list[dict[str, Any]]:
    """Each reading with its settings and the predictions of the models, numbered in its table."""
    problem, models, rows = result.problem, predictions(result), []
    for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
        settings, counts = table.named_settings, np.bincount(table.condition)
        where = in_words(settings)
        for i, row in enumerate(range(part.start, part.stop)):
            unit = table.unit_of(i)
            rows.append({
                "table": table_name(problem, k), "number": i + 1,
                "where": where[i],
                "settings": {name: values[i] for name, (values, _) in settings.items()},
                "unit": unit, "reading": float(problem.y[row]),
                "sd": float(problem.sd[row]) if problem.errors[k].known else None,
                "readings": int(counts[i]),
                **{name: float(of[row]) for name, of in models.items()},
            })  # fmt: skip
    return rows


def _channels(result: Diagnosis) -> dict[str, Any]:
    """Each table: its readings, its errors, and how far both models miss it."""
    problem, found = result.problem, {}
    fits = {"recalibrated": result.recalibrated.fit} if result.fitted else {}
    if result.verdict.fit is not None:
        fits["extended"] = result.verdict.fit
    for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
        errors = problem.errors[k]
        chi2 = {
            name: float(problem.chi2_of_tables(fit.residual[None, :])[k, 0]) / len(table.mean)
            for name, fit in fits.items()
        }  # fmt: skip
        found[table_name(problem, k)] = {
            "title": title_of(table, k), "readings": len(table.y),
            "unit": table.unit if table.drawable else None,
            "conditions": len(table.mean), "errors": dict(errors.told), "dof": errors.dof,
            "median_sd": float(np.median(problem.sd[part])) if errors.known else None,
            "digits": amounts.digits_for(problem.y[part].tolist()), "chi2_per_condition": chi2,
            "notes": [str(each) for each in table.notes],
        }  # fmt: skip
    return found
