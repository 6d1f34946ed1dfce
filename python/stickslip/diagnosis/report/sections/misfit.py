"""Where the recalibrated model misses, and where its constants are."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Any, Literal, TypedDict

import numpy as np

from stickslip._util.arrays import Array, Mask
from stickslip.diagnosis.data.outliers import far_readings
from stickslip.diagnosis.data.settings import ROW, Settings
from stickslip.diagnosis.decision.facts import Facts
from stickslip.diagnosis.report.sections.evidence import MOST_NAMED
from stickslip.diagnosis.report.sections.size import rows_of

Side = Literal["above", "below", "both"]
"""Side of the model on which readings lie."""

# Of a pattern of the misfit: the least lead of its log-likelihood, what each setting in it costs,
# the share of its square on one side, ends of ranges that are tried, and part of the misfit from
# which single readings are the pattern. Chosen: more than the best of some hundred ranges of noise
# has; hardly a reading against the sign; a twentieth of the data; most of it.
_STANDS_OUT, _A_WORD, _ONE_SIDED, _ENDS, _MOST_OF_IT = 4.0, 2.0, 0.9, 21, 0.5


class Numbers(TypedDict):
    recalibrated: dict[str, dict[str, Any]]
    """By uncertain parameter its prior in words (`before`), `stated`, `value`, `sd`, `low`,
    `high`, `pull`, and `extended`, `sd_extended` and `pull_extended` in the extended model."""
    moved: dict[str, Any] | None
    """The constant that the recalibrated model moved farthest: `name`, `title`, `pull`; or null."""
    misfit: list[dict[str, Any]]
    """The three readings with most of the recalibrated model's chi-square: `where`, `share`."""
    pattern: dict[str, Any] | None
    """For `unexplained`: the settings at which the recalibrated model misses most (`where`), how
    many `readings` `of` a `table`, their `share` of chi-square, on which `side` of the model
    (<side>) and their `mean`; null where none stand out."""


def numbers(facts: Facts) -> Numbers:
    rows, residual = rows_of(facts, facts.recalibrated), facts.recalibrated.fit.residual
    extended = facts.best.params.to_dict("index") if facts.verdict.fit is not None else {}
    for name, row in rows.items():
        value, sd, pull = (extended.get(name, {}).get(key) for key in ("value", "sd", "pull"))
        row |= {"extended": value, "sd_extended": sd, "pull_extended": pull}
    moved = [{"name": name, "title": facts.words.parameter(name), "pull": abs(row["pull"])}
             for name, row in rows.items()]  # fmt: skip
    square = np.ravel(facts.problem.whitened(residual[:, None])) ** 2
    worst, total = np.argsort(-square)[:MOST_NAMED], np.sum(square)  # 0 of a perfect fit
    return {
        "recalibrated": rows, "moved": max(moved, key=lambda each: each["pull"], default=None),
        "misfit": [{**facts.places[k], "share": float(square[k] / total)} for k in worst if total],
        "pattern": _pattern(facts, residual) if facts.verdict.kind == "unexplained" else None,
    }  # fmt: skip


def _pattern(facts: Facts, residual: Array) -> dict[str, Any] | None:
    """The settings at which the recalibrated model misses most, how many readings, and their sign.

    Of each table the values of its words and ranges of its numbers, by the likelihood that what is
    left has a mean and a scatter of its own there; None where none stand out.
    """
    problem, best, found = facts.problem, _STANDS_OUT, None
    z = residual / problem.sd
    for one in problem.parts:
        left, settings = z[one.rows], one.table.named_settings
        few = far_readings(left)
        if few.any() and np.sum(left[few] ** 2) > _MOST_OF_IT * np.sum(z**2):
            found = one, few, _few_in_words(settings, problem.y[one.rows], few)
            break
        for rows, words in _regions(settings, len(left)):
            lead = _lead(left, rows) - _A_WORD * len(words)
            if lead > best:
                best, found = lead, (one, rows, words)
    if found is None:
        return None
    one, rows, words = found
    some = z[one.rows][rows]
    square = float(np.sum(some**2))
    up = float(np.sum(some[some > 0.0] ** 2)) / square
    side: Side = "above" if up > _ONE_SIDED else "below" if up < 1.0 - _ONE_SIDED else "both"
    return {
        "table": one.name, "where": ", ".join(words), "side": side,
        "readings": len(some), "of": len(one.table.mean), "share": square / float(np.sum(z**2)),
        "mean": float(np.mean(residual[one.rows][rows])), "unit": one.table.unit_of(0),
    }  # fmt: skip


def _lead(left: Array, rows: Mask) -> float:
    """Log-likelihood of a mean and a scatter of their own of some rows, above that of one scatter.

    No scatter is below that of the readings; -inf where the rows are few or miss less than others.
    """
    some, rest = left[rows], left[~rows]
    if min(len(some), len(rest)) < 2 or np.mean(some**2) <= np.mean(rest**2):
        return -math.inf
    split = sum(len(part) * math.log(max(float(np.var(part)), 1.0)) for part in (some, rest))
    return 0.5 * (len(left) * math.log(max(float(np.mean(left**2)), 1.0)) - split)


def _few_in_words(settings: Settings, values: Array, few: Mask) -> list[str]:
    """Where single readings stand and what they are, of many the first."""
    name, rows, readings = settings.most_varied, np.flatnonzero(few).tolist(), []
    for k in rows:
        place = f"row {k}" if name == ROW else settings.text(name, settings[name][0][k])
        readings.append(f"{place} ({values[k]:g})")
    return [*readings[:MOST_NAMED], *(["..."] if len(rows) > MOST_NAMED else [])]


def _regions(settings: Settings, count: int) -> Iterator[tuple[Mask, list[str]]]:
    """Parts of the settings' range, rows and words: values of words, and ranges of numbers."""
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
