"""One decision, from the probabilities of the models to a verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from stickslip._util.note import Note
from stickslip._util.text import OneLine
from stickslip.diagnosis.decision.gain import Gain, gain_of, measured
from stickslip.diagnosis.decision.misfit_test import GOF_LEVEL, MisfitTest, goodness_of_fit
from stickslip.diagnosis.decision.posterior import (
    SURE,
    Posterior,
    as_likely,
    posterior,
    share,
)
from stickslip.diagnosis.fitting.models import Fit
from stickslip.diagnosis.fitting.search import Models
from stickslip.diagnosis.terms.amounts import p_text
from stickslip.diagnosis.terms.cause import Cause, CauseNote

Kind = Literal["named", "dominant", "pair", "ambiguous", "unexplained", "none", "data-problem"]

CLAIMS = ("named", "dominant", "pair")
"""Kinds that claim a cause."""

DOMINANT = 0.7
"""Share that a dominant cause takes at least. Chosen: with 0.8 a sixth fewer right ones are claimed
beside a model error, with 0.6 hardly more."""

NEARLY_ALL = 0.9
"""Share from which on a cause needs no proof by held-out readings. Chosen on 180 logs."""

SECOND = 0.1
"""Part by which a further cause lowers the held-out error at least. Chosen with the prototype."""

LOOKS = "looks-unlisted", "another-scale"
"""Codes of notes on what nobody listed."""

CALM = 0.5
"""Scatter, in the stated errors, below which these are said to be stated too large. Chosen."""


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
        Part of the squares that `fit`, or else the leader, takes.
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
    sure, rivals = chance.sure, {cause.name for cause in models.offered if not cause.listed}
    if not sure:
        return _set(verdict, models, chance)
    if rivals & {*sure}:
        return _beside_unlisted(verdict, models, sorted({*sure} - rivals))
    most = next(fit for fit in chance.fits if fit.names & set(sure))
    claim = _with_more(verdict, models, chance, most, sure)
    if claim.claims and (twin := models.twins.get(frozenset(claim.causes))):
        note = CauseNote("unlisted-twin", "{} would do the same as {}.", [twin, *claim.causes])
        claim = replace(claim, reasons=(*claim.reasons, note))
    alike = as_likely(models, claim.fit) if claim.claims and claim.fit else []
    return _set(verdict, models, chance, (), (claim.fit, *alike)) if alike and claim.fit else claim


def _beside_unlisted(verdict: Verdict, models: Models, listed: Sequence[str]) -> Verdict:
    """What is claimed beside an effect that nobody listed, which itself is only said."""
    leader = verdict.leader
    assert leader is not None
    fits = [fit for fit in models.leaders() if fit.names == frozenset(listed)]
    if listed and fits:
        return _claimed(verdict, models, fits[0], _looks(models, leader))
    gain = gain_of(models, leader)
    return _with(verdict, "unexplained", (), None, _looks(models, leader), models, leader, gain)


def _looks(models: Models, fit: Fit) -> tuple[Note, ...]:
    """What is said of an effect that nobody listed in a model: what it looks like, or the scale."""
    notes = list[Note]()
    for cause in (cause for cause in fit.causes if not cause.listed):
        if cause.told:
            (column,) = models.problem.columns([cause])
            value = float(models.problem.physical(fit.x[None])[0, column])
            notes.append(Note(LOOKS[1], cause.told(value, "", math.nan), math.exp(value)))
        else:
            text = "It looks like {}."
            notes.append(CauseNote(LOOKS[0], text, [cause.name]))
    return tuple(notes)


def _without_cause(verdict: Verdict, models: Models, test: MisfitTest) -> Verdict:
    if not test.misfit:
        text = f"The recalibrated model explains the data ({p_text(test.p_value)})."
        reason = Note("nothing-left", text, test.p_value)
        return _with(verdict, "none", (), None, (reason,), models, None)
    likeliest = next(fit for fit in models.leaders() if not fit.causes)
    rival = "an unknown model error"
    if likeliest.form == "ar1":
        rival = "correlated errors along a run, of the readings or of the model"
    text = f"A misfit is left ({p_text(test.p_value)}); no cause is more probable than {rival}."
    reason = Note("no-cause-leads", text, test.p_value)
    gain = gain_of(models, verdict.leader) if verdict.leader else None
    return _with(verdict, "unexplained", (), None, (reason,), models, verdict.leader, gain)


def _with_more(
    verdict: Verdict, models: Models, chance: Posterior, whole: Fit, sure: list[str],
    reasons: tuple[Note, ...] = (),
) -> Verdict:  # fmt: skip
    """Two or three causes, if the last one predicts held-out readings.

    Else the better ones without it. If not all of them are sure, what is beside these is left open.
    """
    fewer = [fit for fit in chance.fits if fit.names < whole.names and fit.names & set(sure)]
    if not fewer:
        return _claimed(verdict, models, whole, reasons)
    member, all_sure = max(fewer, key=models.log_posterior), whole.names <= set(sure)
    if not all_sure and whole.form == "exact":
        # The stated errors ask for a further cause, but not for which one.
        explains = [goodness_of_fit(models.problem, fit) >= GOF_LEVEL for fit in (member, whole)]
        if explains == [False, True]:
            return _set(verdict, models, chance, reasons)
    one, two = (models.get(fit.names) or fit for fit in (member, whole))
    further = measured(models.problem, one, two)
    if further is None:  # too few parts to hold some out
        return _set(verdict, models, chance, reasons)
    if further.certain and further.after <= (1.0 - SECOND) * further.before:
        if all_sure:
            return _claimed(verdict, models, whole, reasons)
        return _set(verdict, models, chance, reasons)
    reasons += (_refused(whole, member, further),)
    if chance.among_small(member) >= SURE:
        claim = _with_more(verdict, models, chance, member, sure, reasons)
        if claim.claims:
            return claim
    # A smaller model is improbable, and the last cause is not proven: both stay open.
    still_open = tuple(dict.fromkeys((whole, member, *verdict.members))) if all_sure else ()
    return _set(verdict, models, chance, reasons, still_open)


def _refused(whole: Fit, member: Fit, further: Gain) -> Note:
    others, fall = sorted(whole.names - member.names), 1.0 - further.after / further.before
    pair = " + ".join(["{}"] * len(others)), " + ".join(["{}"] * len(member.names))
    text = f"{pair[0]} beside {pair[1]} lowers the held-out error by {100.0 * max(fall, 0.0):.0f} %"
    if fall < SECOND:
        text += f"; a further cause needs {100.0 * SECOND:.0f} %."
    else:
        text += ", which may be chance: the 95 % interval includes zero."
    return CauseNote("second-cause-predicts-nothing", text, (*others, *sorted(member.names)), fall)


def _claimed(verdict: Verdict, models: Models, fit: Fit, reasons: tuple[Note, ...] = ()) -> Verdict:
    """One cause or more, named if it explains the data, dominant beside a discrepancy."""
    problem, plain, gain = models.problem, models.get(fit.names), gain_of(models, fit)
    forms = (one for one in models.leaders() if one.names == fit.names and one.form != "exact")
    beside = next(forms, fit)
    explains = plain and goodness_of_fit(problem, plain) >= GOF_LEVEL
    # Errors that were taken from the fit of all causes explain what it leaves by themselves.
    if not explains or any(errors.of_fit for errors in problem.errors):
        against = _takes_little(beside, share(models, beside), gain)
        if against:
            notes = (*reasons, *against)
            return _with(verdict, "unexplained", (), None, notes, models, beside, gain)
    names = tuple(sorted(fit.names))
    if len(names) > 1 and (
        untold := [each.name for each in fit.causes if not _told(models, fit, each)]
    ):
        text = "A size of {} is not told from none beside the other."
        notes = (*reasons, *(CauseNote("size-not-told", text, [name]) for name in untold))
        return _with(verdict, "unexplained", (), None, notes, models, beside, gain)
    kind: Kind = "pair" if len(names) > 1 else "named" if explains else "dominant"
    if plain and explains:
        # Errors that are larger, or alike along a run, leave more of the sizes open.
        likelier = plain if fit.form == "white" and fit.sizes["kappa"] <= 1.0 else fit
        return _with(verdict, kind, names, likelier, reasons, models, plain, gain)
    return _with(verdict, kind, names, beside, reasons, models, beside, gain)


def _told(models: Models, fit: Fit, cause: Cause) -> bool:
    """Whether an amplitude of a cause, or its constant, is beyond its 95 % interval about none."""
    columns = [models.problem.at(cause)] if cause.is_constant else [
        k for k in models.problem.columns([cause]).tolist()
        if models.problem.parameters[k].is_amplitude]  # fmt: skip
    sd = dict(zip(fit.free.tolist(), np.sqrt(np.diag(fit.covariance)), strict=True))
    return any(abs(fit.x[k]) > 1.96 * sd.get(k, 0.0) for k in columns)


def _takes_little(fit: Fit, part: float, gain: Gain | None) -> list[Note]:
    """Reasons against causes beside a discrepancy: a small share, or an uncertain gain.

    Causes that take nearly all of the model's error need only not predict worse.
    """
    notes: list[Note] = []
    if part < DOMINANT:
        asked = 100.0 * DOMINANT
        takes = f"{min(100.0 * part, asked - 1.0):.0f} %"
        text = f"{{}} takes {takes} of the model's error; a claim asks for {asked:.0f} %."
        notes.append(CauseNote("small-share", text, [fit.name], part))
    if part >= NEARLY_ALL:
        text = "{} predicts held-out readings worse."
        proven = gain is None or gain.interval[1] >= 0.0
    else:
        text = "It is not certain that {} predicts held-out readings better."
        proven = gain is not None and gain.certain
    if not proven:
        notes.append(CauseNote("uncertain-gain", text, [fit.name]))
    return notes


def _set(
    verdict: Verdict, models: Models, chance: Posterior, reasons: tuple[Note, ...] = (),
    members: tuple[Fit, ...] = (),
) -> Verdict:  # fmt: skip
    """Models that stay open, if not given the smallest set with 95 %: the causes of each in turn.

    Where that is one model, which cannot be claimed, or where none of its models takes enough of
    the model's error, nothing explains the data.
    """
    members = members or verdict.members
    first = next(member for member in members if member.causes)
    against, gain = list[Note](), gain_of(models, first)
    if first.form != "exact":
        part = max(share(models, member) for member in members if member.causes)
        against = _takes_little(first, part, gain)
    if len(members) == 1 or against:
        notes = (*reasons, *against)
        return _with(verdict, "unexplained", (), None, notes, models, first, gain)
    probability = chance.models[first.name]
    if probability < SURE:
        together = sum(chance.models[member.name] for member in members)
        text = (
            f"{len(members)} models have {100.0 * together:.0f} % of the probability together; the "
            f"first, {{}}, has {100.0 * probability:.0f} %."
        )
        reasons = (*reasons, CauseNote("not-separated", text, [first.name], probability))
    names = tuple(dict.fromkeys(name for one in members for name in sorted(one.names)))
    looks = _looks(models, first)
    if not any(cause.listed for one in members for cause in one.causes):
        return _with(verdict, "unexplained", (), None, (*looks, *reasons), models, first, gain)
    reasons = (*(note for note in looks if note.code == LOOKS[1]), *reasons)
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
