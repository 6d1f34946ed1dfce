"""One decision, from the probabilities of the models to a verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from stickslip._util.note import Note
from stickslip._util.text import OneLine
from stickslip.diagnosis.decision.gain import Gain, gain_of, in_blocks, measured
from stickslip.diagnosis.decision.misfit_test import (
    ALPHA,
    GOF_LEVEL,
    MisfitTest,
    chance_of_other_constants,
    follows_settings,
    goodness_of_fit,
)  # fmt: skip
from stickslip.diagnosis.decision.posterior import (
    ALIKE,
    SURE,
    Posterior,
    cosine_of_swap,
    discrepancy,
    posterior,
    share,
)
from stickslip.diagnosis.fitting.forms import HYPER
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.problem import FAR_OFF
from stickslip.diagnosis.fitting.search import Models
from stickslip.diagnosis.terms.amounts import p_text
from stickslip.diagnosis.terms.cause import CauseNote

Kind = Literal["named", "dominant", "pair", "ambiguous", "unexplained", "none", "data-problem"]

CLAIMS = ("named", "dominant", "pair")
"""Kinds that claim a cause."""

DOMINANT = 0.7
"""Share of the model's error that a dominant cause takes at least. Chosen on 192
logs with a model error beside the cause: with 0.8 a sixth fewer right ones are claimed, and of 96
causes that are not listed 8 for 11; with 0.6 hardly more right ones."""

NEARLY_ALL = 0.9
"""Share from which on a cause needs no proof by held-out readings: little is left that could have
been taken for it. Chosen on 180 logs of which it names 5 more, all rightly."""

SECOND = 0.1
"""Part by which a further cause lowers the held-out error at least. Chosen with the prototype."""

FAR = 1e-4
"""p-value below which every model of fewer causes fails, so that causes that explain the data need
no other proof of the last one. Chosen: a hundredth of `GOF_LEVEL`."""

CALM = 0.5
"""Scatter, in the stated errors, below which these are said to be stated too large. Chosen."""

_AT_BOUND = 0.02  # distance of the logarithm of a correlation time from its largest
_AT_END = 0.01  # distance of a coordinate from the end of its range


@dataclass(frozen=True, repr=False, eq=False)
class Verdict(OneLine):
    """A verdict.

    Attributes
    ----------
    kind : str
        ``named``, ``dominant``, ``pair``, ``ambiguous``, ``unexplained``, ``none`` or
        ``data-problem``.
    causes : tuple of str
        The cause, the two or three of a pair, or those of a set, the most probable first.
    fit : Fit, optional
        The extended model, where a cause is claimed; of a set that of its first member.
    reasons : tuple of Note
    probabilities : dict of float
        Of each cause and of ``none``.
    members : tuple of Fit
        Models that stay open: the smallest set with 95 %, or a pair and the smaller models than
        which it did not predict better.
    share : float, optional
        Part of the model's error that `fit`, or else the leader, takes.
    leader : Fit, optional
        The model with a cause that was judged, or else the most probable one.
    gain : Gain, optional
        Of `fit`, or else of the leader, on held-out readings, by plain least squares.
    """

    kind: Kind
    causes: tuple[str, ...] = ()
    fit: Fit | None = None
    reasons: tuple[Note, ...] = ()
    probabilities: Mapping[str, float] = field(default_factory=dict)
    members: tuple[Fit, ...] = ()
    share: float | None = None
    leader: Fit | None = None
    gain: Gain | None = None

    @property
    def claims(self) -> bool:
        """Whether a cause is claimed."""
        return self.kind in CLAIMS

    @property
    def subject(self) -> Fit | None:
        """The model that is told: `fit`, or what comes nearest; None where no cause is sought."""
        return None if self.kind in ("none", "data-problem") else self.fit or self.leader

    @property
    def common(self) -> tuple[str, ...]:
        """Causes in all `members`."""
        names = [fit.names for fit in self.members]
        return tuple(sorted(frozenset.intersection(*names))) if names else ()

    @property
    def partial(self) -> bool:
        """Whether a discrepancy is left beside `fit`."""
        return self.fit is not None and self.fit.form != "exact"


def decide(models: Models, test: MisfitTest) -> Verdict:
    """The verdict on the fitted models by the rules of the documentation."""
    chance = posterior(models)
    leader = next((fit for fit in chance.fits if fit.causes), None)
    probabilities = {**chance.causes, "none": chance.none}
    members = tuple(chance.smallest_set())
    verdict = Verdict("unexplained", probabilities=probabilities, members=members, leader=leader)
    if leader is None or not chance.has_cause:
        return _without_cause(verdict, models, test)
    sure = chance.sure
    if not sure:
        return _set(verdict, models, chance)
    most = next(fit for fit in chance.fits if fit.names & set(sure))
    return _with_more(verdict, models, test, chance, most, sure)


def _without_cause(verdict: Verdict, models: Models, test: MisfitTest) -> Verdict:
    if test.misfit:
        likeliest = next(fit for fit in models.leaders() if not fit.causes)
        rival = "an unknown model error"
        if likeliest.form == "ar1":
            rival = "correlated errors along a run, of the readings or of the model"
        chance = chance_of_other_constants(models, likeliest)
        if chance >= ALPHA:
            reason = Note("misfit-of-both", (
                f"Both sides have a misfit that no listed cause explains ({p_text(test.p_value)}); "
                f"other constants afterwards take no more of it than chance ({p_text(chance)})."
            ), chance)  # fmt: skip
            return _with(verdict, "none", (), None, (reason,), models, None)
        text = f"A misfit is left ({p_text(test.p_value)}); no cause is more probable than {rival}."
        reason = Note("no-cause-leads", text, test.p_value)
        gain = gain_of(models, verdict.leader) if verdict.leader else None
        return _with(verdict, "unexplained", (), None, (reason,), models, verdict.leader, gain)
    text = f"The recalibrated model explains the data ({p_text(test.p_value)})."
    reason = Note("nothing-left", text, test.p_value)
    return _with(verdict, "none", (), None, (reason,), models, None)


def _with_more(
    verdict: Verdict, models: Models, test: MisfitTest, chance: Posterior, whole: Fit,
    sure: list[str], reasons: tuple[Note, ...] = (),
) -> Verdict:  # fmt: skip
    """Two or three causes, if nothing less explains the data or the last one predicts held-out
    readings.

    Else the better ones without it. If not all of them are sure, what is beside these is left open.
    """
    fewer = [fit for fit in chance.fits if fit.names < whole.names and fit.names & set(sure)]
    if not fewer:
        return _claimed(verdict, models, test, whole, reasons)
    member, all_sure = max(fewer, key=models.log_posterior), whole.names <= set(sure)
    if not all_sure and whole.form == "exact":
        # The stated errors ask for a further cause, but not for which one.
        explains = [goodness_of_fit(models.problem, fit) >= GOF_LEVEL for fit in (member, whole)]
        if explains == [False, True]:
            return _set(verdict, models, chance, reasons)
    if all_sure and _nothing_less(models, whole):
        return _claimed(verdict, models, test, whole, reasons)
    one, two = (models.get(fit.names) or fit for fit in (member, whole))
    further = measured(models.problem, one, two)
    if further is None:  # too few parts to hold some out
        return _set(verdict, models, chance, reasons)
    # Constants that are farther off than any estimate predict as well where they count as stated.
    far = [cause.is_constant and abs(one.x[models.problem.at(cause)]) > FAR_OFF
           for cause in whole.causes if cause.name not in member.names]  # fmt: skip
    gains = further.certain and further.after <= (1.0 - SECOND) * further.before
    if gains or (all_sure and all(far)):
        claimed = _claimed(verdict, models, test, whole, reasons) if all_sure else None
        return claimed or _set(verdict, models, chance, reasons)
    reasons += (_refused(whole, member, further),)
    if chance.among_small(member) >= SURE:
        claim = _with_more(verdict, models, test, chance, member, sure, reasons)
        if claim.claims:
            return claim
    # A smaller model is improbable, and the last cause is not proven: both stay open.
    still_open = tuple(dict.fromkeys((whole, member, *verdict.members))) if all_sure else ()
    return _set(verdict, models, chance, reasons, still_open)


def _nothing_less(models: Models, whole: Fit) -> bool:
    """Whether causes explain the data without a discrepancy, and no smaller model comes near."""
    plain = models.get(whole.names)
    if plain is None or goodness_of_fit(models.problem, plain) < GOF_LEVEL:
        return False
    smaller = [fit for fit in models.best.values() if len(fit.causes) < len(whole.causes)]
    return all(goodness_of_fit(models.problem, fit) < FAR for fit in smaller)


def _refused(whole: Fit, member: Fit, further: Gain) -> Note:
    others = sorted(whole.names - member.names)
    fall = 1.0 - further.after / further.before
    number = ("second", "third")[len(member.causes) - 1]
    pair = " + ".join(["{}"] * len(others)), " + ".join(["{}"] * len(member.names))
    text = f"{pair[0]} beside {pair[1]} lowers the held-out error by {100.0 * fall:.0f} %"
    if fall <= 0.0:
        text = f"{pair[0]} beside {pair[1]} does not lower the held-out error."
    elif fall < SECOND:
        text += f" only; a {number} cause needs {100.0 * SECOND:.0f} %."
    else:
        text += ", which may be chance: the 95 % interval includes zero."
    return CauseNote("second-cause-predicts-nothing", text, (*others, *sorted(member.names)), fall)


def _claimed(
    verdict: Verdict, models: Models, test: MisfitTest, fit: Fit, reasons: tuple[Note, ...] = ()
) -> Verdict:
    """One cause or more, named if it explains the data, dominant beside a discrepancy."""
    problem, names = models.problem, tuple(sorted(fit.names))
    plain, beside = models.get(fit.names), _beside(models, fit)
    gains = [gain_of(models, fit)]
    if in_blocks(problem):
        own_null = models.get((), fit.form) or models.null
        gains.append(measured(problem, own_null, fit, "own"))
    proven = _proven(models, test, fit, gains)
    explains = plain and goodness_of_fit(problem, plain) >= GOF_LEVEL and not _at_end(models, plain)
    # Errors that were taken from the fit of all causes explain what it leaves by themselves.
    by_itself = any(errors.of_fit for errors in problem.errors)
    against = [] if explains and proven and not by_itself else _against(models, beside, gains)
    if against:
        notes = (*reasons, *against)
        return _with(verdict, "unexplained", (), None, notes, models, beside, gains[0])
    kind: Kind = "pair" if len(names) > 1 else "named" if explains else "dominant"
    if plain and explains:
        # Errors that are larger, or alike along a run, leave more of the sizes open.
        likelier = fit if discrepancy(fit) > 0.0 else plain
        return _with(verdict, kind, names, likelier, reasons, models, plain, gains[0])
    twins = _open_twins(models, beside)
    if twins:
        also = " or ".join("{}" for _ in twins)
        text = f"What {{}} leaves is as large as what tells it from {also}."
        named = [fit.name for fit in (beside, *twins)]
        reasons += (CauseNote("twins-left-open", text, named),)
        return _left_open(verdict, models, (beside, *twins), reasons, gains[0])
    if beside.form == "ar1" and math.log(beside.sizes["tau"]) >= HYPER["tau"][3] - _AT_BOUND:
        text = "What {} leaves drifts over the whole record: something else is missing too."
        reasons += (CauseNote("long-correlation", text, [beside.name], beside.sizes["tau"]),)
    return _with(verdict, kind, names, beside, reasons, models, beside, gains[0])


def _beside(models: Models, fit: Fit) -> Fit:
    """A fit of the same causes with a discrepancy, if there is one: the likeliest that is sound."""
    every = [one for one in models.leaders() if one.names == fit.names and one.form != "exact"]
    sound = (one for one in every if not _is_pattern(models, one))
    return next(sound, next(iter(every), fit))


def _is_pattern(models: Models, fit: Fit) -> bool:
    """Whether what should be scatter follows the settings."""
    return fit.form == "white" and follows_settings(models.problem, fit)


def _open_twins(models: Models, fit: Fit) -> list[Fit]:
    """Models with another cause in place of a claimed one, from which the data do not tell it.

    They act alike, take enough of the model's error too, and differ from the claim by no more than
    it leaves. Asked only where that is alike along a run, so that readings count for less than
    their number.
    """
    twins = []
    for other in models.leaders(form="ar1") if fit.form == "ar1" else ():
        apart = (fit.residual - other.residual) / models.problem.sd
        if (
            fit.swaps(other)
            and float(np.sum(apart**2)) <= fit.chi2
            and share(models, other) >= DOMINANT
            and not _at_end(models, other)
            and abs(cosine_of_swap(models, fit, other)) > ALIKE
        ):
            twins.append(other)
    return twins


def _against(models: Models, fit: Fit, gains: Sequence[Gain | None]) -> list[Note]:
    """Reasons against causes beside a discrepancy."""
    part = share(models, fit) if fit.form != "exact" else 0.0
    notes = _takes_little(fit, part, gains)
    if _is_pattern(models, fit):
        text = "What {} leaves follows the settings: it is no scatter."
        notes.append(CauseNote("pattern-left", text, [fit.name]))
    return notes + _at_end(models, fit)


def _proven(models: Models, test: MisfitTest, fit: Fit, gains: Sequence[Gain | None]) -> bool:
    """Whether held-out readings allow a name of what explains the data.

    A proof that it gains something is needed where the model without a cause explains the data too,
    unless too few parts can be held out to give one. A constant that is other than stated gives no
    such proof, as it moves within its prior without a cause too: there the test decides.
    """
    problem = models.problem
    if any(gain is not None and gain.interval[1] < 0.0 for gain in gains):
        return False
    spare = goodness_of_fit(problem, models.null) >= GOF_LEVEL
    if all(cause.is_constant for cause in fit.causes):
        spare = spare and test.p_value >= GOF_LEVEL
    return not spare or gains[0] is None or gains[0].certain


def _takes_little(fit: Fit, part: float, gains: Sequence[Gain | None]) -> list[Note]:
    """Reasons against causes beside a discrepancy: a small share, or an uncertain gain.

    Causes that take nearly all of the model's error need only not predict worse.
    """
    notes: list[Note] = []
    if not part >= DOMINANT:
        part, asked = 0.0 if math.isnan(part) else part, 100.0 * DOMINANT
        takes = f"{min(100.0 * part, asked - 1.0):.0f} %"
        text = f"{{}} takes {takes} of the model's error; a claim asks for {asked:.0f} %."
        notes.append(CauseNote("small-share", text, [fit.name], part))
    known = [gain for gain in gains if gain is not None]
    if part >= NEARLY_ALL:
        text = "{} predicts held-out readings worse."
        proven = all(gain.interval[1] >= 0.0 for gain in known)
    else:
        text = "It is not certain that {} predicts held-out readings better."
        proven = len(known) == len(gains) and all(gain.certain for gain in known)
    if not proven:
        notes.append(CauseNote("uncertain-gain", text, [fit.name]))
    return notes


def _set(
    verdict: Verdict, models: Models, chance: Posterior, reasons: tuple[Note, ...] = (),
    members: tuple[Fit, ...] = (),
) -> Verdict:  # fmt: skip
    """Models that stay open, if not given the smallest set with 95 %: the causes of each in turn.

    Where that is one model, which cannot be claimed, where none of its models takes enough of the
    model's error, or where a size of the first is at its end, nothing explains the data.
    """
    members = members or verdict.members
    first = next(member for member in members if member.causes)
    against, gain = list(reasons), gain_of(models, first)
    if first.form != "exact":
        parts = [share(models, member) for member in members if member.causes]
        part = max((value for value in parts if not math.isnan(value)), default=0.0)
        against += _takes_little(first, part, [gain])
    against += _at_end(models, first)
    if len(members) == 1 or len(against) > len(reasons):
        return _with(verdict, "unexplained", (), None, tuple(against), models, first, gain)
    probability = chance.models[first.name]
    if probability < SURE:
        together = sum(chance.models[member.name] for member in members)
        text = (
            f"{len(members)} models have {100.0 * together:.0f} % of the probability together; the "
            f"first, {{}}, has {100.0 * probability:.0f} %."
        )
        reasons = (*reasons, CauseNote("not-separated", text, [first.name], probability))
    return _left_open(verdict, models, members, reasons, gain)


def _left_open(
    verdict: Verdict, models: Models, members: tuple[Fit, ...], reasons: tuple[Note, ...],
    gain: Gain | None,
) -> Verdict:  # fmt: skip
    """The causes of models that stay open, of which the first with a cause is told."""
    names = tuple(dict.fromkeys(name for one in members for name in sorted(one.names)))
    first = next(member for member in members if member.causes)
    verdict = replace(verdict, members=members)
    return _with(verdict, "ambiguous", names, first, reasons, models, first, gain)


def _with(verdict: Verdict, kind: Kind, causes: tuple[str, ...], fit: Fit | None,
          reasons: tuple[Note, ...], models: Models, subject: Fit | None,
          gain: Gain | None = None) -> Verdict:  # fmt: skip
    """The verdict with the share and gain of the model that is told."""
    leader = subject or models.leaders(1)[0]
    likeliest = next(other for other in models.leaders() if other.names == leader.names)
    left = math.hypot(likeliest.sizes.get("kappa", 1.0), likeliest.sizes.get("s", 0.0))
    if left < CALM:
        text = f"The errors are too large: what is left scatters by {left:.2g} of them."
        reasons += (Note("errors-too-large", text, left),)
    return Verdict(
        kind, causes, fit, reasons, verdict.probabilities, verdict.members,
        None if subject is None else share(models, subject), subject or verdict.leader, gain,
    )  # fmt: skip


def _at_end(models: Models, fit: Fit) -> list[Note]:
    """A note where an amplitude, or a relaxed constant, is at the farther end of its range."""
    problem, (low, high) = models.problem, models.problem.limits
    relaxed = [problem.at(cause) for cause in fit.causes if cause.frees is not None]
    for k in [*problem.columns(fit.causes).tolist(), *relaxed]:
        # Neither the end at which an amplitude does nothing counts, nor a stated end of a shape: a
        # part of 1 is all.
        one = problem.parameters[k]
        shape = not one.is_amplitude and k not in relaxed
        stated = [one.coordinate(end) for end in (one.low, one.high)] if shape else []
        ends = [end for end in (low[k], high[k]) if math.isfinite(end) and end not in stated]
        ends = [end for end in ends if end or not one.is_amplitude]
        if any(abs(fit.x[k] - end) < _AT_END for end in ends):
            text = "A size of {} is at the end of its range."
            return [CauseNote("size-at-end", text, [fit.name])]
    return []
