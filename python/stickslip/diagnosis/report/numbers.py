"""The one dictionary of a report: every number of the page, of report.json and of ``--json``."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from html import unescape
from typing import Any, Literal, get_args

import numpy as np

from stickslip._util.arrays import Array, Mask
from stickslip._util.html import VERSION, page_text
from stickslip._util.note import Note
from stickslip._util.toml import own_text, parse_toml
from stickslip._util.units import is_of, mistaken, unit_label
from stickslip.diagnosis.data.outliers import far_readings
from stickslip.diagnosis.data.settings import ROW, Settings
from stickslip.diagnosis.decision.candidate import Candidate, spread_of
from stickslip.diagnosis.decision.cannot_tell import Combination
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.decision.posterior import SURE
from stickslip.diagnosis.decision.verdict import DOMINANT, Kind
from stickslip.diagnosis.fitting.forms import PRIOR
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.problem import LOST
from stickslip.diagnosis.terms import amounts
from stickslip.diagnosis.terms.curve import CURVE, SHAPES, Curve
from stickslip.diagnosis.terms.parameter import Parameter
from stickslip.diagnosis.terms.words import Vocabulary, Words, of_side

ROUTINE = (
    "no-block-column", "errors-correlated", "noise-repeats", "noise-free-fit", "frame-noise",
    "frames-correlated",
)  # fmt: skip
"""Codes of notes that nearly every measurement has: the page has them last, the command never."""

Side = Literal["above", "below", "both"]
"""Of the model, on which readings lie."""

WORDS = {"verdict": get_args(Kind), "form": tuple(PRIOR), "side": get_args(Side)}
"""Words that a value of that name can be."""

# What there is only of fitted models, or of a kind of verdict.
_NULL = (
    "p_value", "discrepancy", "law", "moved", "leader", "runner_up", "odds", "pattern",
    "cannot_tell",
)  # fmt: skip
_LISTS = (
    "deciding_readings", "next_experiments", "ranking", "claimed", "cosines", "misfit", "advice",
    "data_problem",
)  # fmt: skip
_TABLES = "parameters", "bounds", "recalibrated"

_DECIDING, _POINTS = 3, 41  # readings that are named; points of a law
_COMPARED = 12  # causes whose effects are compared
_NO_NEWS = 0.9  # of its prior's error, from which on data tell nothing of a shape; chosen
_FURTHER = 0.01  # probability from which on a further cause is named
_MOST_OF_IT = 0.5  # share from which on a sure cause is said to act, with something beside it

# Of a pattern of the misfit: the least lead of its log-likelihood, what each setting in it costs,
# the share of its square on one side, and ends of ranges that are tried. Chosen: more than the best
# of some hundred ranges of noise has; hardly a reading against the sign; a twentieth of the data.
_STANDS_OUT, _A_WORD, _ONE_SIDED, _ENDS = 4.0, 2.0, 0.9, 21

_NEAR, _NEAREST = 2.0, 0.1
"""Errors of a constant, and part of it, within which its ratio is that of two units. Chosen: 20 %
are no unit."""


def reference() -> dict[str, str]:
    """The meaning of each key of the dictionary, in Markdown; some stand together in one text."""
    text = own_text("diagnosis/report/keys.toml")
    for name, words in WORDS.items():
        text = text.replace(f"<{name}>", ", ".join(f"`{word}`" for word in words))
    return dict(parse_toml(text)["keys"])


def numbers_of(facts: Facts, title: str | None = None) -> dict[str, Any]:
    """All numbers, by the keys of the reference, in SI units unless a text says its unit."""
    verdict, findings = facts.verdict, facts.findings
    source = facts.measurement
    lost = [] if source is None else list(map(str, source.left_out))
    lost += [text for _, text in _of_tables(facts, "left_out")]
    numbers: dict[str, Any] = {
        **dict.fromkeys(_NULL), **{key: [] for key in _LISTS}, **{key: {} for key in _TABLES},
        "verdict": verdict.kind,
        "cause": verdict.causes[0] if verdict.kind in ("named", "dominant")
        else list(verdict.causes) or None,
        "name": title or ("Diagnosis" if source is None else source.name),
        "probabilities": dict(verdict.probabilities),
        "share": _or_none(verdict.share),
        "gain": _gain(facts),
        "next": str(facts.next_step),
        "reasons": list(map(facts.words.note, verdict.reasons)),
        "notes": notes_of(facts),
        "left_out": lost,
        "conditions": _conditions(facts),
        "channels": _channels(facts),
        "left": facts.next_step.value if facts.next_step.code == "cause-left" else None,
        "common": [facts.words.title(name) for name in verdict.common],
        "members": [fit.name for fit in verdict.members],
        "unproven": any(note.code == "second-cause-predicts-nothing" for note in verdict.reasons),
        "beside": _beside(facts),
        "partial": verdict.partial,
        "offered": len(findings.models.offered),
        "tests": {"lack_of_fit": findings.test.lack_of_fit, "score": findings.test.score},
        "seed": findings.seed,
        "version": VERSION,
        "of_measurement": source is not None,
    }  # fmt: skip
    sides = facts.rivals.sides(facts.best.params["value"].to_dict() if facts.fitted else {})
    if sides:
        paired = any(table.less is not None for table in facts.problem.tables)
        numbers |= {"sides": sides, "paired": paired}
    if facts.fitted:
        numbers |= _of_models(facts, numbers["conditions"])
    elif verdict.reasons:
        numbers["data_problem"] = facts.words.data_problem(verdict.reasons[0])
    if verdict.kind == "ambiguous" and facts.rivals.proposes:
        numbers["next_experiments"] = _experiments(facts)
        names = {name: facts.words.title(name) for name in verdict.causes}
        looks = facts.rivals.advice(names, facts.propose_experiments())
        numbers["advice"] = list(map(str, looks))
    numbers["headline"] = summary_text(numbers, facts.problem.words).split("\n", 1)[0]
    return numbers


def summary_text(numbers: Mapping[str, Any], vocabulary: Vocabulary) -> str:
    """The verdict and what it rests on, as the command and `Diagnosis.summary` print it."""
    words = Words(vocabulary)
    page = page_text("diagnosis/report/summary.txt.j2", report=numbers, a=amounts, w=words)
    return "\n".join(line.rstrip() for line in unescape(page).strip().split("\n"))


def _of_tables(facts: Facts, what: str) -> list[tuple[Note, str]]:
    """Notes of the tables and their texts; of several tables, or of no curve, with its name."""
    tables = facts.problem.tables
    return [
        (note, f"{title}: {note}" if len(tables) > 1 or not table.drawable else str(note))
        for table, title in zip(tables, facts.problem.titles, strict=True)
        for note in getattr(table, what)
    ]


def notes_of(facts: Facts) -> list[dict[str, Any]]:
    """All notes, those that nearly every report has last."""
    own = [(note, str(note)) for note in facts.notes]
    rows = [
        {"code": note.code, "text": text, "routine": note.code in ROUTINE}
        for note, text in (*own, *_of_tables(facts, "notes"))
    ]
    return sorted(rows, key=lambda row: bool(row["routine"]))


def _or_none(value: float | None) -> float | None:
    """A number of JSON, which has no NaN."""
    return None if value is None or math.isnan(value) else value


def _of_models(facts: Facts, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What there is where models were fitted; `rows` are the conditions."""
    verdict, models = facts.verdict, facts.findings.models
    table, fits = facts.compare(), facts.chance.fits
    subject, best = verdict.subject, facts.subject
    ranking = [
        {
            "candidate": name, "title": facts.words.title(name), "causes": sorted(fit.names), **row,
            "odds": facts.chance.models[best.name] / max(row["probability"], 1e-300),
        }
        for fit, (name, row) in zip(fits, table.to_dict("index").items(), strict=True)
    ]  # fmt: skip
    members = [verdict.fit] if verdict.fit is not None else []
    if verdict.kind == "ambiguous":
        members = [fit for fit in verdict.members if fit.causes]
    candidates = [Candidate(fit, models) for fit in members]
    extended = {} if verdict.fit is None else facts.best.params.to_dict("index")
    constants = _rows(facts, facts.recalibrated)
    for name, row in constants.items():
        other = extended.get(name, {})
        row |= {"extended": other.get("value"), "pull_extended": other.get("pull")}
    farthest = max(constants, key=lambda name: abs(constants[name]["pull"]), default=None)
    beyond = facts.cannot_tell
    compared = beyond.causes[:_COMPARED] if len(beyond.causes) > 1 else []
    parameters: dict[str, Any] = {}
    for sizes in (each for one in candidates for each in _sizes(facts, one).values()):
        for name, size in sizes.items():
            parameters.setdefault(name.removeprefix("effects."), size)
    return {
        "p_value": facts.findings.test.p_value,
        "parameters": parameters,
        "discrepancy": best.left,
        "ranking": ranking,
        "claimed": [_claim(facts, candidate) for candidate in candidates],
        "law": law_of(best),
        "recalibrated": constants,
        "moved": None if farthest is None else {
            "name": farthest, "title": facts.words.parameter(farthest),
            "pull": abs(constants[farthest]["pull"]),
        },
        "misfit": _misfit(facts, rows),
        "pattern": _pattern(facts) if verdict.kind == "unexplained" else None,
        "cosines": [
            {"cause": name, "title": facts.words.title(name),
             "cosines": beyond.cosines[k, :k].tolist()}
            for k, name in enumerate(compared)
        ],
        "bounds": _bounds(facts),
        "cannot_tell": _cannot_tell(facts, rows),
        **({} if subject is None else _of_subject(facts, best, rows)),
    }  # fmt: skip


def _of_subject(
    facts: Facts, candidate: Candidate, rows: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    """The model that is told, beside the most probable one without its causes."""
    fit, models, chance = candidate.fit, facts.findings.models, facts.chance
    other = next((e for e in chance.fits if not e.names >= fit.names), models.null)
    with_cause, probability = 1.0 - chance.none, chance.models[fit.name]
    larger = next((larger_fit for larger_fit in chance.fits if larger_fit.names > fit.names), None)
    further = ""
    if larger is not None and chance.models[larger.name] >= _FURTHER:
        further = facts.words.title(" + ".join(sorted(larger.names - fit.names)))
    in_all, part = facts.probability_of(fit.names), _or_none(candidate.share)
    deciding = _deciding(facts, fit, other, rows)
    alone = {name: models.get(fit.names - {name}) for name in sorted(fit.names)}
    if facts.verdict.kind == "pair" and None not in alone.values():
        # For each cause, against the other one alone.
        deciding = [
            {**reading, "for": facts.words.title(name)}
            for name, one in alone.items() if one is not None
            for reading in _deciding(facts, fit, one, rows)[:2]
        ]  # fmt: skip
    leader = {
        **_claim(facts, candidate),
        "among_causes": probability / with_cause if with_cause > 0.0 else 0.0,
        "in_all": in_all,
        "further": further,
        "share": part,
        "acts": in_all >= SURE and part is not None and part > _MOST_OF_IT,
        "takes_most": in_all >= SURE and part is not None and part >= DOMINANT,
        "left": _left_in_words(facts, candidate if facts.verdict.fit else facts.recalibrated),
    }
    return {
        "leader": leader,
        "odds": {"none": probability / max(chance.models["none"], 1e-300)},
        "runner_up": {
            "candidate": other.name, "title": facts.words.title(other.name),
            "odds": probability / max(chance.models[other.name], 1e-300),
        },
        "deciding_readings": deciding,
    }  # fmt: skip


def _beside(facts: Facts) -> list[str]:
    """What the members of a set have beside the causes that all of them have."""
    common, members = frozenset(facts.verdict.common), facts.verdict.members
    nothing = "nothing else" if common else facts.words.title("none")
    texts = []
    for fit in members:
        names = sorted(fit.names - common)
        alone = not common and names and any(fit.names < other.names for other in members)
        text = " with ".join(map(facts.words.title, names)) or nothing
        texts.append(f"{text} alone" if alone else text)
    return texts


def _rows(facts: Facts, candidate: Candidate) -> dict[str, dict[str, Any]]:
    """The parameters of a candidate by full name, with 95 % and their words."""
    ends = candidate.interval(0.95).to_dict("index")
    known = {parameter.name: parameter for parameter in facts.problem.parameters}
    rows: dict[str, dict[str, Any]] = {
        name: {
            **row, **ends[name], "before": facts.words.before(known[name]),
            "title": facts.words.parameter(name),
        }
        for name, row in candidate.params.to_dict("index").items()
    }  # fmt: skip
    for constant in facts.problem.constants:
        stated = float(constant.value(np.zeros(1))[0]) if constant.is_stated else None
        rows[constant.name]["stated"] = stated
    return rows


def _sizes(facts: Facts, candidate: Candidate) -> dict[str, dict[str, dict[str, Any]]]:
    """Parameters of each cause of a candidate, or the constant that it frees."""
    rows = _rows(facts, candidate)
    return {
        cause.name: {name: rows[name] for name in names or [str(cause.frees)]}
        for cause in candidate.fit.causes
        for names in [[parameter.name for parameter in cause.parameters]]
    }


def _claim(facts: Facts, candidate: Candidate) -> dict[str, Any]:
    problem = facts.problem
    sizes, known = _sizes(facts, candidate), {one.name: one for one in problem.parameters}
    step = max((table.step or 0.0 for table in problem.tables), default=0.0)
    for name, size in (pair for rows in sizes.values() for pair in rows.items()):
        one = known[name]
        low, high = one.value(np.array([-1.0, 1.0])).tolist()
        # Of a shape the data may say no more than its prior.
        shown = one.is_amplitude or one.cause or size["sd"] < _NO_NEWS * 0.5 * (high - low)
        size |= {"shown": shown, "step": step}
    causes = []
    for cause in candidate.fit.causes:
        row: dict[str, Any] = facts.words.description(cause, sizes[cause.name])
        if cause.curve is not None:
            # Drawings have the names of the laws.
            article = "an" if cause.curve.form.startswith("e") else "a"
            form = "" if cause.has_knots else f", {article} {cause.curve.form}"
            row |= {"finding": f"The law of {cause.curve.name} has another shape{form}.",
                    "drawing": cause.curve.law, "interval": ""}  # fmt: skip
        of, side = of_side(cause.name)
        if side and of in facts.rivals.shared:
            (by,) = sizes[cause.name].values()
            was = facts.rivals.sides(candidate.params["value"].to_dict())["before"][of]
            what, far, sd, unit = facts.words.parameter(of), by["value"], by["sd"], by["unit"]
            ends = [facts.words.near(of, each, sd, unit) for each in (was, was + far)]
            what = what if what.startswith("`") else f"The {what}"
            row["finding"] = (
                f"{what} {'rose' if far > 0.0 else 'fell'} from {ends[0]} to "
                f"{ends[1]}, by {facts.words.size(of, abs(far), sd, unit)}."
            )
        if cause.is_constant:
            (name,) = sizes[cause.name]
            size = sizes[cause.name][name]
            row["finding"] += _in_another_unit(known[name], size["value"], size["sd"])
        causes.append(row)
    chance = facts.chance.models[candidate.name]
    return {"candidate": candidate.name, "title": facts.words.title(candidate.name),
            "probability": chance, "causes": causes}  # fmt: skip


def _in_another_unit(constant: Parameter, value: float, sd: float) -> str:
    """What is said of a constant that is off by the factor of a unit, within its errors."""
    stated, beside = constant.value(np.array([0.0, 1.0])).tolist()
    if not stated or not value:
        return ""
    within = min(_NEAR * math.hypot(beside / stated - 1.0, sd / value), _NEAREST)
    return f" {mistaken(value / stated, within)}".rstrip()


def _left_in_words(facts: Facts, candidate: Candidate) -> list[str]:
    """What is left beside a cause, and the errors of readings, a text for each table."""
    left, texts, problem = candidate.left, [], facts.problem
    for table, part, name, title in zip(
        problem.tables, problem.rows, problem.table_names, problem.titles, strict=True
    ):
        size = left.get("size", {}).get(name, 0.0)
        if size == 0.0:
            continue
        factor, unit = table.shown_unit(0)
        text = f"{amounts.number(size * factor, 2)} {unit}".rstrip()
        text = f"{'a scatter' if left['form'] == 'white' else 'an error'} of {text} in {title}"
        if name in left.get("correlation", {}):
            lasts = left["correlation"][name]
            text += (
                f" with a correlation time of {amounts.number(lasts * table.step, 2)} s"
                if table.step is not None
                else f" with a correlation length of {amounts.number(lasts, 2)} readings"
            )
        elif "length" in left:
            text += f", smooth over {amounts.percent(left['length'] / 2.0)} of a setting's range"
        level = float(np.mean(np.abs(problem.y[part])))
        errors = amounts.number(float(np.median(problem.sd[part])) * factor, 2)
        text += f" ({amounts.percent(size / level)} of their mean)" if 0.0 < size < level else ""
        text += f", beyond the readings' errors of {errors} {unit}".rstrip()
        texts.append(text)
    return texts


def _place(row: Mapping[str, Any]) -> dict[str, Any]:
    """Which reading it is."""
    return {key: row[key] for key in ("table", "number", "where")}


def _misfit(facts: Facts, rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The readings with the largest share of the recalibrated model's chi-square."""
    residual = facts.recalibrated.fit.residual
    square = np.ravel(facts.problem.whitened(residual[:, None])) ** 2
    if not np.any(square):
        return []
    return [
        {**_place(rows[k]), "share": float(square[k] / np.sum(square))}
        for k in np.argsort(-square).tolist()[:_DECIDING]
    ]  # fmt: skip


def _pattern(facts: Facts) -> dict[str, Any] | None:
    """The settings at which the recalibrated model misses most, how many readings, and their sign.

    Of each table the values of its words and ranges of its numbers, by the likelihood that what is
    left has a mean and a scatter of its own there; None where none stand out.
    """
    problem, residual = facts.problem, facts.recalibrated.fit.residual
    z, best = residual / problem.sd, _STANDS_OUT
    found: tuple[int, Mask, str] | None = None
    for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
        left, settings = z[part], table.named_settings
        few = far_readings(left)
        if few.any() and np.sum(left[few] ** 2) > _MOST_OF_IT * np.sum(z**2):
            found = k, few, _few_in_words(settings, problem.y[part], few)
            break
        whole = len(left) * math.log(max(float(np.mean(left**2)), 1.0))
        for rows, words in _regions(settings, len(left)):
            some, rest = left[rows], left[~rows]
            if min(len(some), len(rest)) < 2 or np.mean(some**2) <= np.mean(rest**2):
                continue
            # No scatter is below that of the readings.
            split = sum(
                len(values) * math.log(max(float(np.var(values)), 1.0)) for values in (some, rest)
            )
            lead = 0.5 * (whole - split) - _A_WORD * len(words)
            if lead > best:
                best, found = lead, (k, rows, ", ".join(words))
    if found is None:
        return None
    k, rows, where = found
    part = problem.rows[k]
    some = z[part][rows]
    up = float(np.sum(some[some > 0.0] ** 2) / np.sum(some**2))
    side: Side = "above" if up > _ONE_SIDED else "below" if up < 1.0 - _ONE_SIDED else "both"
    return {
        "table": problem.table_names[k], "where": where, "side": side,
        "readings": len(some), "of": len(z[part]), "share": float(np.sum(some**2) / np.sum(z**2)),
        "mean": float(np.mean(residual[part][rows])), "unit": problem.tables[k].unit_of(0),
    }  # fmt: skip


def _few_in_words(settings: Settings, values: Array, few: Mask) -> str:
    """Where single readings stand and what they are, of many the first."""
    name, rows = settings.most_varied, np.flatnonzero(few).tolist()
    places = [
        f"row {k}" if name == ROW else settings.text(name, settings[name][0][k]) for k in rows
    ]
    readings = [f"{place} ({values[k]:g})" for place, k in zip(places, rows, strict=True)]
    return f"{', '.join(readings[:_DECIDING])}{', ...' if len(rows) > _DECIDING else ''}"


def _regions(settings: Settings, count: int) -> Iterator[tuple[Mask, list[str]]]:
    """Parts of the settings' range as rows, (count,), and words: values of words, and ranges."""
    wording = [name for name in settings.varied if settings.is_word(name)]
    groups: dict[tuple[str, ...], Mask] = {(): np.ones(count, dtype=bool)}
    for names in [*([name] for name in wording), wording]:
        columns = zip(*(settings[name][0] for name in names), strict=True)
        for row, value in enumerate(columns):
            key = tuple(settings.text(*pair) for pair in zip(names, value, strict=True))
            groups.setdefault(key, np.zeros(count, dtype=bool))[row] = True
    for key, rows in groups.items():
        yield rows, list(key)
        for name in set(settings.varied).difference(wording):
            at = np.asarray(settings[name][0], dtype=float)
            ends = np.unique(np.quantile(at, np.linspace(0.0, 1.0, _ENDS), method="nearest"))
            for low, high in itertools.combinations_with_replacement(ends.tolist(), 2):
                if (low, high) != (ends[0], ends[-1]):
                    words = [*key, settings.text(name, low, high)]
                    yield rows & (at >= low) & (at <= high), words


def _deciding(
    facts: Facts, fit: Fit, other: Fit, rows: Sequence[Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """The readings that tell a model from its runner-up, by the difference of log-likelihood."""
    models, problem = facts.findings.models, facts.problem
    pair = [models.get(one.names) or one for one in (fit, other)]
    square = problem.whitened(np.stack([one.residual for one in pair], axis=1)) ** 2
    gain = 0.5 * (square[:, 1] - square[:, 0])
    whole = float(np.sum(gain[gain > 0.0]))
    return [
        {
            **_place(rows[k]),
            "difference": float(gain[k]), "share": float(gain[k]) / whole,
        }
        for k in np.argsort(-gain).tolist()[:_DECIDING]
        if gain[k] > 0.0
    ]  # fmt: skip


def _cannot_tell(facts: Facts, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What the data cannot tell, in the names of the user."""
    beyond, words, names = facts.cannot_tell, facts.words, facts.subject.fit.names
    # One cause on either of two sides differs in sign.
    pairs = [pair for pair in beyond.alike
             if of_side(pair.cause)[0] != of_side(pair.other)[0]]  # fmt: skip
    alike = [
        {
            "cause": cause, "title": words.title(cause), "told": cause in names,
            "others": [
                {
                    "cause": pair.other, "title": words.title(pair.other), "cosine": pair.cosine,
                    "lead": pair.lead, "parted": pair.parted, "apart": pair.apart,
                    "more": None if math.isinf(pair.more) else pair.more,
                    **_place(rows[pair.row]),
                }
                for pair in pairs if pair.cause == cause
            ],
        }
        for cause in dict.fromkeys(pair.cause for pair in pairs)
    ]  # fmt: skip
    groups = [
        {"parameters": list(group.names), "titles": [words.parameter(n) for n in group.names],
         "known": [_combination(facts, one) for one in group.known]}
        for group in beyond.groups
    ]  # fmt: skip
    hidden = [
        {"cause": name, "title": words.title(name), "constants": list(constants),
         "titles": [words.parameter(name) for name in constants]}
        for name, constants in beyond.hidden.items()
    ]  # fmt: skip
    silent = [{"parameter": name, "title": words.parameter(name)} for name in beyond.silent]
    return {"alike": alike, "combinations": groups, "hidden": hidden, "silent": silent}


def _combination(facts: Facts, known: Combination) -> dict[str, Any]:
    """A combination of parameters as an expression of their names."""
    units = {parameter.name: parameter.unit for parameter in facts.problem.parameters}
    names = {name: facts.words.parameter(name) for name in known.weights}
    if known.product:
        expression = _product(names, known.weights)
        unit = _product({name: unit_label(units[name]) for name in names}, known.weights)
        kind = "ratio" if sorted(known.weights.values()) == [-1.0, 1.0] else "product"
    else:
        terms = [
            f"{'-' if w < 0.0 else '+'} {amounts.number(abs(w)) + ' ' if abs(w) != 1.0 else ''}"
            f"{names[name]}" for name, w in known.weights.items()
        ]  # fmt: skip
        expression = " ".join(terms).removeprefix("+ ")
        unit = unit_label(next((units[n] for n, w in known.weights.items() if w == 1.0), ""))
        kind = "sum" if set(known.weights.values()) == {1.0} else "combination"
    return {
        "kind": kind, "expression": expression, "weights": known.weights, "value": known.value,
        "sd": known.sd, "unit": unit, "text": amounts.amount(known.value, known.sd, unit),
    }  # fmt: skip


def _product(names: Mapping[str, str], powers: Mapping[str, float]) -> str:
    """``a² · b / c / d``, of names that are not empty."""
    text = ""
    for name, power in sorted(powers.items(), key=lambda item: item[1] < 0.0):
        if names[name]:
            size = abs(power)
            raised = f"^{size:g}" if size % 1.0 else "⁰ ²³⁴⁵⁶"[int(size)].strip()
            by = (" · " if text else "") if power > 0.0 else " / " if text else "1 / "
            base = (
                f"({names[name]})"
                if re.search("[ /]", names[name]) and len(powers) > 1
                else names[name]
            )
            text += f"{by}{base}{raised}"
    return text


def _bounds(facts: Facts) -> dict[str, Any]:
    limits = facts.cannot_tell.limits
    parameters = {parameter.name: parameter for parameter in facts.problem.parameters}
    owners = {one.name: cause.name for cause in facts.problem.causes for one in cause.parameters}
    shared = facts.rivals.shared
    return {
        name.removeprefix("effects."): {
            "value": value, "unit": parameters[name].unit, "falls": parameters[name].falls,
            "relative": value / (parameters[name].size or 1.0),
            "title": facts.words.parameter(name),
            "cause": facts.words.title(owners[name]) if name in owners else "",
            "text": facts.words.limit(name, value, parameters[name].unit),
            "seen": seen,
            **({"changes": facts.words.parameter(of)} if side and of in shared else {}),
        }
        for name, (value, seen) in sorted(limits.items(), key=lambda item: item[1].value)
        for of, side in [of_side(name)]
    }  # fmt: skip


def law_of(candidate: Candidate) -> dict[str, Any] | None:
    """A law of another shape with its 95 % band, the probabilities of its forms, and its lines."""
    problem = candidate.models.problem
    for cause in candidate.fit.causes:
        curve = cause.curve
        if curve is None:
            continue
        at, values = np.linspace(curve.low, curve.high, _POINTS), candidate.values()
        names = [parameter.name for parameter in cause.parameters]
        columns = values[:, [problem.names.index(name) for name in names]]
        law = f = curve.at(at[None, :], columns)
        base = np.full(len(values), curve.stated)
        if curve.relative:
            if curve.constant is not None:
                base = values[:, problem.names.index(curve.constant)]
            law = base[:, None] * (1.0 + f)
        half = 1.96 * np.sqrt(np.diag(spread_of(law)))
        numbers = dict(zip(names, columns[0].tolist(), strict=True))
        return {
            "name": curve.name, "law": curve.law if curve.relative else f"change of {curve.law}",
            "law_unit": curve.law_unit, "argument": curve.argument, "unit": curve.unit,
            "at": at.tolist(), "value": law[0].tolist(), "low": (law[0] - half).tolist(),
            "high": (law[0] + half).tolist(), "form": curve.form,
            "forms": candidate.models.of_forms.get(candidate.fit.names, {curve.form: 1.0}),
            "lines": _lines(curve, float(base[0]), numbers),
        }  # fmt: skip
    return None


def _lines(curve: Curve, base: float, numbers: Mapping[str, float]) -> list[str]:
    """A law as a scenario states it; that of a model of one's own as a formula, if it has one."""
    if curve.statement is not None:
        return curve.statement.lines(numbers)
    if curve.form == CURVE:
        return []
    a, scale = [*numbers.values(), curve.reach][:2]
    text, unit = f"{amounts.number(a)} {SHAPES[curve.form].text}", unit_label(curve.law_unit)
    right = f"{amounts.number(base)} {unit}".rstrip() + f" (1 + {text})"
    right = right if curve.relative else f"{text} {unit}".rstrip()
    less = f"({curve.argument} - {amounts.number(curve.origin)})"
    length = f"{amounts.number(scale)} {unit_label(curve.unit)}".rstrip()
    return [f"{curve.law} = {right}, u = {less if curve.origin else curve.argument} / {length}"]


def _gain(facts: Facts) -> dict[str, Any] | None:
    """The gain, and `told`: the table whose error changes most, in its unit and in per cent."""
    gain, problem = facts.gain, facts.problem
    if gain is None:
        return None
    entry, best, records = asdict(gain), -math.inf, []
    entry["interval"] = list(gain.interval)
    for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
        if not table.drawable:
            continue
        name = problem.table_names[k]
        one = {"before": gain.mae_before[name], "after": gain.mae_after[name]}
        records.append({"title": problem.titles[k], "unit": table.unit, **one})
        change = abs(one["before"] - one["after"]) / float(np.median(problem.sd[part]))
        if change > best:
            best, level = change, float(np.mean(np.abs(problem.y[part])))
            entry["told"] = {
                "table": problem.titles[k], **one, "unit": table.unit, "level": level,
                # Of an angle or a temperature a share says nothing.
                "of_level": not (is_of(table.unit, "rad") or is_of(table.unit, "K")),
            }  # fmt: skip
    entry["records"] = sorted(
        records, key=lambda record: -record["after"] / max(record["before"], 1e-300)
    )
    entry["change"] = "falls" if gain.certain else "grows" if gain.interval[1] < 0.0 else "not sure"
    return entry


def _experiments(facts: Facts) -> list[dict[str, Any]]:
    def text(name: str, row: Mapping[str, float]) -> str:
        factor, unit = facts.problem.tables[facts.rivals.table].shown_unit(0)
        value, sd = (factor * one for one in row.values())
        return f"{facts.words.title(name)} {amounts.amount(value, sd, unit)}"

    return [
        {
            "drive": dict(experiment.drive), "why": facts.words.note(experiment.why),
            "separation": experiment.separation, "words": experiment.words,
            "predictions": {name: dict(row) for name, row in experiment.predictions.items()},
            "predicted": [text(*pair) for pair in experiment.predictions.items()],
        }
        for experiment in facts.propose_experiments()
    ]  # fmt: skip


def predictions(facts: Facts) -> dict[str, Array]:
    """All readings as the stated, the recalibrated and the extended model have them, (n,)."""
    if not facts.fitted:
        return {}
    problem = facts.problem
    left = problem.residuals(np.zeros((1, problem.size)))[0]
    stated = np.where(left == LOST * problem.sd, np.nan, problem.y - left)
    fitted = {name: problem.y - model.fit.residual for name, model in facts.candidates.items()}
    return {"stated": stated, **fitted}


def _conditions(facts: Facts) -> list[dict[str, Any]]:
    """Each reading with its settings and the predictions of the models, numbered in its table."""
    problem, models, rows = facts.problem, predictions(facts), []
    for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
        settings, counts = table.named_settings, np.bincount(table.condition)
        where = settings.words
        for i, row in enumerate(range(part.start, part.stop)):
            unit = table.unit_of(i)
            rows.append({
                "table": problem.table_names[k], "number": i + 1,
                "where": where[i],
                "settings": {name: values[i] for name, (values, _) in settings.items()},
                "unit": unit, "reading": float(problem.y[row]),
                "sd": float(problem.sd[row]) if problem.errors[k].known else None,
                "readings": int(counts[i]),
                **{name: float(of[row]) for name, of in models.items()},
            })  # fmt: skip
    return rows


def _channels(facts: Facts) -> dict[str, Any]:
    """Each table: its readings, its errors, and how far both models miss it."""
    problem, channels = facts.problem, {}
    for k, (table, part) in enumerate(zip(problem.tables, problem.rows, strict=True)):
        errors = problem.errors[k]
        chi2 = {
            name: float(problem.chi2_of_tables(model.fit.residual[None, :])[k, 0]) / len(table.mean)
            for name, model in facts.candidates.items()
        }  # fmt: skip
        channels[problem.table_names[k]] = {
            "title": problem.titles[k], "readings": len(table.y),
            "unit": table.unit if table.drawable else None,
            "conditions": len(table.mean), "errors": dict(errors.sizes), "dof": errors.dof,
            "median_sd": float(np.median(problem.sd[part])) if errors.known else None,
            "digits": amounts.digits_for(problem.y[part].tolist()), "chi2_per_condition": chi2,
            "notes": [str(note) for note in table.notes],
        }  # fmt: skip
    return channels
