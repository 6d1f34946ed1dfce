"""The five answers of a report: what is wrong, how large, how sure, what to do, how much better."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.diagnosis.data.conditions import changes
from stickslip.diagnosis.inference.detection import ALPHA
from stickslip.diagnosis.inference.experiment_design import Experiment, advice
from stickslip.diagnosis.inference.findings import Findings
from stickslip.diagnosis.inference.next_step import next_step
from stickslip.diagnosis.inference.ranking import set_members
from stickslip.diagnosis.posed_problem import PosedProblem
from stickslip.diagnosis.report.cause_words import (
    Size,
    Told,
    in_plain_words,
    meanings_of,
    plain_name,
)
from stickslip.diagnosis.report.certainty import gain_of, sure_of
from stickslip.diagnosis.report.constants import moved
from stickslip.diagnosis.report.drawings import DRAWN
from stickslip.diagnosis.report.errors import Errors, errors_of, errors_of_gain
from stickslip.diagnosis.report.headline import LISTED, claimed_by, headline, improvement
from stickslip.diagnosis.report.limits import limits_in_words
from stickslip.diagnosis.report.parameters import short
from stickslip.facts import Code, Fact

_DECISIVE = 0.95
"""Probability above which the fit to all data decides. Chosen."""


@dataclass(frozen=True)
class Drawn:
    """A drawing: its name, the word for the sign of what was found, and what stands beside it."""

    name: str
    way: str = ""
    caption: Fact | None = None


@dataclass(frozen=True)
class Answers:
    """What the first screen of a report says.

    Attributes
    ----------
    headline : Fact
    told : tuple of tuple of Told
        The causes of each candidate that is claimed, or that is in the set.
    drawn_law : str, optional
        The law of the simulator that has another shape.
    what, size, sure, do, better : tuple of Fact
        Each has at least one sentence.
    """

    headline: Fact
    told: tuple[tuple[Told, ...], ...]
    drawn_law: str | None
    what: tuple[Fact, ...]
    size: tuple[Fact, ...]
    sure: tuple[Fact, ...]
    do: tuple[Fact, ...]
    better: tuple[Fact, ...]

    @property
    def drawings(self) -> list[Drawn]:
        """A drawing of each cause; of candidates that can be drawn whole, or none of a pair."""
        if self.drawn_law is not None:
            # Laws have the names of their drawings.
            return [Drawn(self.drawn_law)] if self.drawn_law in DRAWN else []
        drawable = [causes for causes in self.told if all(each.drawing in DRAWN for each in causes)]
        once = {each.name: each for causes in drawable[:LISTED] for each in causes}
        captions = len({each.name for causes in self.told for each in causes}) > 1
        return [
            Drawn(each.drawing, each.way, _meaning(each) if captions else None)
            for each in once.values()
        ]

    @property
    def what_beside(self) -> list[Fact]:
        """What is wrong, less what stands beside a drawing."""
        return [each for each in self.what if each not in [of.caption for of in self.drawings]]


def answers(
    found: Findings, posed: PosedProblem, experiments: Sequence[Experiment], unit: str
) -> Answers:
    """The answers of a diagnosis; `unit` is that of what is held out."""
    claimed = claimed_by(found)
    return Answers(
        headline(found, posed, unit),
        claimed,
        None if found.free_shape is None or posed.simulator is None else found.free_shape.term.law,
        _what(found, posed, claimed),
        _size(found, claimed),
        sure_of(found, LISTED),
        _do(found, posed, claimed, experiments),
        _better(found, posed, unit),
    )


def _meaning(cause: Told) -> Fact:
    name = _capital(cause.title) if cause.listed else f"The cause {short(cause.name)}"
    return Fact(Code.WHAT_CAUSE, {"name": name, "meaning": cause.meaning})


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _what(
    found: Findings, posed: PosedProblem, claimed: Sequence[Sequence[Told]]
) -> tuple[Fact, ...]:
    if claimed:
        each_once = {each.name: each for causes in claimed[:LISTED] for each in causes}
        return tuple(_meaning(each) for each in each_once.values())
    if found.free_shape is not None and found.open_set is not None:
        # The headline says that there is a law, and what was gained is an answer of its own.
        elsewhere = (Code.FREE_SHAPE, Code.FREE_SHAPE_GAIN)
        return tuple(each for each in found.open_set.facts() if each.code not in elsewhere)
    if found.verdict.kind == "none":
        return (Fact(Code.WHAT_NOTHING, {}), Fact(Code.WHAT_MOVED, {"moved": moved(found, posed)}))
    unknown = found.verdict.kind == "unexplained"
    return (Fact(Code.WHAT_UNKNOWN if unknown else Code.WHAT_DATA, {}),)


def _size(found: Findings, claimed: Sequence[Sequence[Told]]) -> tuple[Fact, ...]:
    if found.verdict.kind == "data-problem":
        return (Fact(Code.SIZE_UNKNOWN, {}),)
    if claimed:
        return tuple(
            _size_of(each, size, fit.converged)
            for fit, causes in zip(set_members(found), claimed[:LISTED], strict=False)
            for each in causes for size in each.sizes
        )  # fmt: skip
    limits = limits_in_words(found) if found.verdict.kind == "none" else ()
    if limits:
        return limits
    said = []
    if found.free_shape is not None and found.open_set is not None:
        curve = found.open_set.curve
        term = found.free_shape.term
        ends = {"low": float(np.min(curve.law)), "high": float(np.max(curve.law))}
        said.append(Fact(Code.SIZE_OF_LAW, {"law": term.law, "unit": term.law_unit, **ends}))
    ratio_of_noise = float(np.sqrt(found.null.data_chi2 / len(found.problem.observed)))
    return (*said, Fact(Code.SIZE_OF_MISFIT, {"ratio": ratio_of_noise}))


def _size_of(cause: Told, size: Size, converged: bool) -> Fact:
    """A parameter of a cause; its error only where that does not contradict its interval.

    The curvature at the end of a fit that did not converge says nothing of other ends.
    """
    label = _label(cause, size)
    if not converged:
        return Fact(Code.SIZE_NOT_CERTAIN, {"name": label, "size": _with_way(size.best, size.way)})
    if size.error_fits:
        fields = {"name": label, "size": _with_way(size.amount, size.way)}
        return Fact(Code.SIZE_OF_CAUSE, {**fields, "interval": size.interval})
    fields = {"name": label, "size": _with_way(size.best, size.way), "interval": size.interval}
    return Fact(Code.SIZE_IN_INTERVAL, fields)


def _with_way(amount: str, way: str) -> str:
    """An amount with the word for its sign, such as ``larger by 5 %`` or ``5 mT, along +x``."""
    word, _, rest = way.partition(" ")
    if word.endswith("er"):
        return f"{word} by {amount} {rest}".rstrip()
    return f"{amount}, {way}" if way else amount


def _label(cause: Told, size: Size) -> str:
    """A cause, with its parameter where there are several; it begins a sentence."""
    if not cause.listed:
        return f"The parameter {size.name}"
    title = _capital(cause.title)
    return title if len(cause.sizes) == 1 else f"{title}, {size.parameter}"


def _do(
    found: Findings,
    posed: PosedProblem,
    claimed: Sequence[Sequence[Told]],
    experiments: Sequence[Experiment],
) -> tuple[Fact, ...]:
    kind = found.verdict.kind
    own = "the recalibrated model" if kind == "none" else "the extended model"
    model = {"model": own if posed.simulator is None else "extended.toml"}
    values = [] if posed.simulator is not None else [Fact(Code.DO_VALUES, {})]
    if kind == "data-problem":
        return (Fact(Code.DO_CORRECT, {}),)
    if kind == "none":
        return (Fact(Code.DO_CONFIRM, model),)
    steps = [_measure_next(found, posed, each) for each in experiments[:1] if each.decides]
    if kind == "unexplained" and found.free_shape is None:
        return (Fact(Code.DO_LOOK, {}), *steps)
    if kind == "unexplained":
        # The experiments are those that tell causes apart, none of which explains the data.
        return (Fact(Code.DO_KEEP, {**model, "first": True}),)
    if kind in ("named", "pair"):
        remedies = [each.remedy for each in claimed[0] if each.remedy]
        said = [Fact(Code.DO_REMEDY, {"remedy": each}) for each in remedies]
        keep = Fact(Code.DO_KEEP, {**model, "first": not said})
        if posed.simulator is not None and all(each.reading for each in claimed[0]):
            keep = Fact(Code.DO_KEEP_ROBOT, model)
        return (*said, keep, *values, *([] if next_step(found).code is Code.NAME_SAFE else steps))
    looks = [in_plain_words(found, each) for each in advice(found)]
    measure = [*steps, *looks] or [Fact(Code.DO_MEASURE_MORE, {})]
    gain = gain_of(found)
    fails = gain is not None and gain.p_value < ALPHA
    if fails and posed.simulator is not None and found.open_set is None:
        measure.insert(0, Fact(Code.DO_FREE_SHAPES, {}))
    leading = _leading(found)
    kept = [] if leading is None else [Fact(Code.DO_LEADING, {**model, "name": leading})]
    return (*measure, *kept, *values)


def _measure_next(found: Findings, posed: PosedProblem, experiment: Experiment) -> Fact:
    """A proposed experiment with what the first candidates predict of it."""
    meanings = meanings_of(found)
    predicted = [
        {"name": plain_name(name, meanings), "velocity": each["velocity"]}
        for name, each in experiment.predictions.items()
    ]
    fields = {
        "settings": changes(experiment.drive, posed.conditions),
        "predicted": predicted[:LISTED],
        "why": in_plain_words(found, experiment.why),
    }
    return Fact(Code.DO_EXPERIMENT, fields)


def _leading(found: Findings) -> str | None:
    """The candidate that the extended model has, where the verdict leaves several."""
    fit = found.verdict.fit
    if found.verdict.kind != "ambiguous" or fit is None:
        return None
    if len(found.verdict.causes) == len(fit.candidate.causes):
        return None
    return plain_name(fit.name, meanings_of(found))


def _better(found: Findings, posed: PosedProblem, unit: str) -> tuple[Fact, ...]:
    if found.verdict.kind == "data-problem":
        return (Fact(Code.BETTER_NO_MODEL, {}),)
    gain, leading = gain_of(found), {"leading": _leading(found)}
    if gain is not None:
        fields: Mapping[str, object] = improvement(found, posed, gain, unit)
        error = errors_of_gain(found, gain, unit)
        told_change = {
            "falls": Code.BETTER_FALLS, "not sure": Code.BETTER_NOT_SURE,
            "grows": Code.BETTER_WORSE,
        }[str(fields["change"])]  # fmt: skip
        better = Fact(told_change, {**fields, **error.in_full, **leading})
        likely = sum(found.verdict.probabilities[each] for each in found.verdict.causes) > _DECISIVE
        claims = found.verdict.kind in ("named", "pair") and likely
        if told_change is Code.BETTER_NOT_SURE and claims:
            return (better, Fact(Code.BETTER_TOO_FEW, fields))
        return (better,)
    error = errors_of(found, posed, unit)
    if found.verdict.kind == "none":
        return (_constants(error),)
    if found.verdict.fit is None:
        return (Fact(Code.BETTER_UNKNOWN, error.in_full),)
    return (Fact(Code.BETTER_IN_FIT, {**error.in_full, **leading}),)


def _constants(error: Errors) -> Fact:
    """What recalibration alone has changed; of one's own model the stated one is not known."""
    known = error.before is not None
    return Fact(Code.BETTER_CONSTANTS if known else Code.BETTER_ALONE, error.in_full)
