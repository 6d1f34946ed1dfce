"""The page of a report: what its template is given."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from markupsafe import Markup, escape

from stickslip._util.html_page import page_text, svg
from stickslip._util.number_text import alike
from stickslip._util.plain_text import printable
from stickslip.diagnosis.data.conditions import changes, heading, in_words, shown_value, varied
from stickslip.diagnosis.fit.goodness import ADEQUATE
from stickslip.diagnosis.inference.cross_validation import INTERVAL
from stickslip.diagnosis.inference.detection import ALPHA
from stickslip.diagnosis.inference.evidence import unseen_causes
from stickslip.diagnosis.inference.experiment_design import Experiment, undecided
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.probabilities import PRIOR_NONE, PRIOR_UNKNOWN
from stickslip.diagnosis.inference.ranking import runner_up, set_members
from stickslip.diagnosis.inference.upper_bounds import BOUND, POWER
from stickslip.diagnosis.inference.verdict import LEAST_SHARE, MARGIN
from stickslip.diagnosis.observables.tracking.film import FilmObservable
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report import figures
from stickslip.diagnosis.report.answers import answers
from stickslip.diagnosis.report.chart import marker, raised
from stickslip.diagnosis.report.differences import GIVEN, LargeFigure
from stickslip.diagnosis.report.drawings import drawing
from stickslip.diagnosis.report.errors import MIXED, SHOWN
from stickslip.diagnosis.report.headline import held_out_thing
from stickslip.diagnosis.report.parameters import short
from stickslip.diagnosis.report.section import ReportSection
from stickslip.diagnosis.report.words import used_in
from stickslip.scenario.keys import known_keys

_LIMITS = {
    "adequate": ADEQUATE,
    "alpha": ALPHA,
    "bound": BOUND,
    "interval": INTERVAL,
    "margin": MARGIN,
    "odds": math.exp(MARGIN),
    "power": POWER,
    "prior_none": PRIOR_NONE,
    "prior_unknown": PRIOR_UNKNOWN,
    "share": LEAST_SHARE,
}
"""Limits that the page explains."""


_POWER_OF_TEN = re.compile(r"(?<=[\d)])e([+-]?\d+)\b")


def page(
    found: Findings,
    posed: PosedProblem,
    numbers: Mapping[str, Any],
    sections: Sequence[ReportSection],
    experiments: Sequence[Experiment],
    large: LargeFigure | None,
    origin: Sequence[tuple[str, str]],
) -> str:
    """The report as one page that needs no other file."""
    told = answers(found, posed, experiments, numbers["gain_unit"])
    text = partial(
        page_text,
        "diagnosis/report/page.html",
        report=numbers,
        answers=told,
        for_people=for_people,
        more_of_what=_more_of_what(found, numbers),
        drawings=[(Markup(drawing(each.name, each.way)), each.caption) for each in told.drawings],
        large=large,
        panels=[]
        if large is None
        else [Markup(each.svg(wide=len(large.panels) == 1)) for each in large.panels],
        legend=[] if large is None else _legend(large),
        origin=origin,
        report_sections=sections,
        **_details(found, posed, numbers, experiments),
        **_pictures(found, posed),
    )
    # What is used can only be seen on the page; a page without a model explains nothing.
    return text(words=used_in(text(words=())) if found.verdict.kind != "data-problem" else ())


def for_people(sentence: object) -> Markup:
    """A sentence with numbers as they are printed: errors after ±, and powers of ten."""
    text = str(escape(printable(sentence))).replace(" +- ", "&nbsp;±&nbsp;")
    return Markup(_POWER_OF_TEN.sub(lambda e: f"&nbsp;&times;&nbsp;10{raised(int(e[1]))}", text))


def _more_of_what(found: Findings, numbers: Mapping[str, Any]) -> list[str]:
    """How a cause shows in the data, or where what is unexplained does."""
    if found.verdict.fit is not None:
        change = numbers["velocity_changes"].get(found.verdict.fit.name)
        alone = len(set_members(found)) == 1
        return [change["in_words"]] if alone and change and change["parts"] else []
    return [numbers["where_it_lives"]] if numbers["where_it_lives"] else []


def _pictures(found: Findings, posed: PosedProblem) -> dict[str, Any]:
    """All other figures."""
    causes, law = found.problem.causes, found.free_shape and found.open_set
    return {
        "law_curve": svg(figures.law_curve(law)) if law else "",
        "curves": svg(figures.velocities(found, posed.conditions, posed.given)),
        "profiles": [svg(figures.profile(each)) for each in found.profiles],
        "ranking": svg(figures.ranking(found)),
        "distinguishability": svg(figures.distinguishability(found)) if causes else "",
    }


def _details(
    found: Findings,
    posed: PosedProblem,
    numbers: Mapping[str, Any],
    experiments: Sequence[Experiment],
) -> dict[str, Any]:
    """Values of the folded sections."""
    conditions = posed.conditions
    first, among = conditions[0] if conditions else {}, varied(conditions)
    reasons = [*found.verdict.reasons, runner_up(found)]
    known = known_keys() if posed.simulator is not None else {}
    films = any(isinstance(each, FilmObservable) for each in posed.model.observables)
    unit = numbers["gain_unit"]
    return {
        "meanings": {each.name: each.meaning for each in found.problem.causes},
        "key_meanings": {short(name): each.meaning for name, each in known.items()},
        "unseen": unseen_causes(found),
        "films_held_out": films and not conditions,
        "units": {short(each.name): each.unit for each in found.problem.parameters},
        "alike": alike,
        "downward": {short(each.name) for each in found.problem.parameters if each.downward},
        # Readings of several units have no mean error.
        "shown": None if unit == MIXED else SHOWN.get(unit, (unit, 1.0)),
        "simulated": posed.simulator is not None,
        "held": f"{held_out_thing(posed)}s",
        "columns": [heading(key) for key in among],
        "settings": [[shown_value(key, each[key]) for key in among] for each in conditions],
        "common": in_words(
            first, [key for key in known_keys() if key in first and key not in among]
        ),
        "members": set_members(found),
        "changes": [changes(each["drive"], conditions) for each in numbers["next_experiments"]],
        "undecided": undecided(experiments),
        # The experiments are for causes, which an accepted law has put behind it.
        "law": None if found.free_shape is None else found.free_shape.term.name,
        "by_evidence": any(each is not None and "lead" in each.fields for each in reasons),
        "limits": _LIMITS,
        "observables": len(found.problem.observed),
        "extended": found.extended is not None,
        "typical": _typical_error(found),
    }


def _legend(large: LargeFigure) -> list[tuple[Markup, str]]:
    """What the signs of the large figure stand for."""

    def sign(inside: str) -> Markup:
        return Markup(f'<svg viewBox="0 0 36 18">{inside}</svg>')

    def point(kind: int, hollow: bool = False) -> str:
        name = "point hollow" if hollow else "point"
        return f'<g class="{name}">{marker(kind, 18, 9)}</g>'

    def line(series: int) -> str:
        kind = "given" if large.curve == GIVEN else "cause"
        shape = '<line x1="2" x2="34" y1="9" y2="9"/>'
        return f'<g class="line {kind} series-{series}">{shape}</g>'

    kinds = large.kinds if len(large.kinds) > 1 else ()
    legend = [(Markup("") if kinds else sign(point(0)), large.measured)]
    if large.held_out:
        legend.append((sign(point(0, hollow=True)), "held out for the gain"))
    if large.curve:
        legend.append((sign(line(0)), large.curve))
    both = [point(k) + (line(k) if large.curve else "") for k in range(len(kinds))]
    return legend + [(sign(each), words) for each, words in zip(both, kinds, strict=True)]


def _typical_error(found: Findings) -> str:
    """Noise of one trial at the median velocity."""
    if found.noise.dof == 0.0:
        return "not known"
    level = float(np.median(np.abs(found.noise.mean)))
    sd = float(np.hypot(found.noise.floor, found.noise.relative * level))
    return f"{sd * 1e3:.3g} mm/s at {level * 1e3:.3g} mm/s"
