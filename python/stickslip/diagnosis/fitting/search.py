"""The search over models: sets of causes, each with every form of the discrepancy.

`Models` keeps the best fit of each. Until the leaders are the same, all models with one cause more,
less or exchanged are fitted, begun at the leader's end; so no model fits worse than what it
contains.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip._util.arrays import Array
from stickslip.diagnosis.fitting.descent import (
    Batched,
    End,
    batches,
    costs_of,
    end_at,
    precision_of,
    run_batched,
)
from stickslip.diagnosis.fitting.forms import Form, Softened, forms
from stickslip.diagnosis.fitting.models import (
    Fit,
    covariance_beside,
    is_near_data,
    linear,
    log_prior,
    minimise,
    sharpened,
)
from stickslip.diagnosis.fitting.options import SEARCH
from stickslip.diagnosis.fitting.problem import Problem, lack_of_fit
from stickslip.diagnosis.fitting.responses import USUAL, Probe, Response, responses
from stickslip.diagnosis.fitting.starts import first_looks, looked, seen_in, softened
from stickslip.diagnosis.terms.cause import Cause

Progress = Callable[[float, str], None]
"""``progress(fraction, stage)`` is told the fraction that is done and what comes next."""


_ALIKE = 0.1
"""Sum of squares, in errors of readings and of what is stated, by which models differ that are the
same. Chosen."""


@dataclass(frozen=True, eq=False)
class Start:
    """Where the fit of a model begins: coordinates, and hyperparameters if known.

    What is `near` has slopes to begin with; `cost_bound` is the cost, with these hyperparameters,
    from which the fit is given up.
    """

    form: str
    causes: tuple[Cause, ...]
    x: Array
    near: Fit | End | Response | None = None
    h: Array | None = None
    cost_bound: float = math.inf


class Models:
    """The best fit of each model, by the names of its causes and its form."""

    def __init__(self, problem: Problem, offered: Sequence[Cause]) -> None:
        self.problem, self.offered = problem, tuple(offered)
        self._odds = sum(cause.odds for cause in offered)
        self.forms: dict[str, Form] = forms(problem)
        self.best: dict[tuple[frozenset[str], str], Fit] = {}
        self.begun = 0  # fits so far
        # The linear model of another form about a fit, None where there is none.
        self._linear: dict[tuple[Fit, str], Fit | None] = {}
        self._beside: dict[Fit, Array] = {}
        # Of sets of causes with a law, the probabilities of its forms.
        self.of_forms: dict[frozenset[str], dict[str, float]] = {}
        # What nobody listed that predicts the same as a set of causes.
        self.twins: dict[frozenset[str], str] = {}

    def add(self, new: Fit) -> Fit:
        """Keep a fit if it is the best of its model."""
        key = new.names, new.form
        old = self.best.get(key)
        exact = new.form == "exact"  # costs compare only in one inner product
        if old is None or (new.cost < old.cost if exact else new.log_evidence > old.log_evidence):
            self.best[key] = new
        return self.best[key]

    def widened(self, problem: Problem, offered: Sequence[Cause]) -> Models:
        """The same fits where the problem has further causes, whose coordinates come last."""
        wider = Models(problem, offered)
        for key, fit in self.best.items():
            x = np.concatenate([fit.x, np.zeros(problem.size - len(fit.x))])
            wider.best[key] = replace(fit, x=x)
        wider.of_forms = dict(self.of_forms)
        return wider

    def get(self, causes: Iterable[str] = (), form: str = "exact") -> Fit | None:
        """The fit of a model, if there is one."""
        return self.best.get((frozenset(causes), form))

    @property
    def reaches(self) -> bool:
        """Whether some model comes near the data, to ten errors in the mean."""
        return any(is_near_data(self.problem, fit.residual) for fit in self.leaders(form="exact"))

    @property
    def cost_bound(self) -> float:
        """Cost with the errors as stated from which a model is far behind the best one.

        Where none is near the data, a few errors less say nothing of where a search would end.
        """
        return self.leaders(1, "exact")[0].cost + SEARCH.margin if self.reaches else math.inf

    @property
    def null(self) -> Fit:
        """The recalibrated model with the errors as they are stated."""
        return self.best[frozenset(), "exact"]

    def log_posterior(self, one: Fit) -> float:
        """Log-evidence and log prior probability of a model, up to what all have."""
        return one.log_evidence + self.log_prior(one.causes, one.form)

    def log_prior(self, causes: Sequence[Cause], form: str = "exact") -> float:
        """Log prior probability of a model."""
        return log_prior(causes, form, self._odds)

    def linear(self, about: Fit, form: str) -> Fit | None:
        """The model with another form of the discrepancy as it is about a fit; it is kept."""
        if (about, form) not in self._linear:
            fits = _linear(self.problem, self.forms[form], about.causes, about.end)
            self._linear[about, form] = next(fits, None)
        return self._linear[about, form]

    def covariance(self, fit: Fit) -> Array:
        """See `covariance_beside`; it is kept."""
        if fit not in self._beside:
            self._beside[fit] = fit.covariance
            with contextlib.suppress(np.linalg.LinAlgError):
                self._beside[fit] = covariance_beside(self.problem, fit)
        return self._beside[fit]

    def without_twins(self) -> None:
        """Leave out what nobody listed where it does what a listed cause does; keep its name."""
        count = len(self.problem.constants)
        singles = [fit for fit in self.leaders(form="exact") if len(fit.causes) == 1]
        for fit in singles:
            for other in singles if not fit.causes[0].listed else ():
                apart = self.problem.whitened((fit.residual - other.residual)[:, None])
                moved = fit.x[:count] - other.x[:count]
                if other.causes[0].listed and np.sum(apart**2) + np.sum(moved**2) < _ALIKE:
                    self.twins[other.names] = fit.name
                    for form in self.forms:
                        self.best.pop((fit.names, form), None)

    def leaders(self, count: int | None = None, form: str | None = None) -> list[Fit]:
        """Models by their posterior, the best first."""
        fits = [fit for fit in self.best.values() if form in (None, fit.form)]
        return sorted(fits, key=self.log_posterior, reverse=True)[:count]

    def add_fits(self, starts: Sequence[Start]) -> None:
        """Fit models from starts, in step, unless nothing can be fitted there."""
        self.begun += len(starts)
        # In step, as many as memory lets.
        sizes = [self.problem.free(start.causes).size for start in starts]
        for some in batches(starts, sizes, max(4 * self.problem.at_once, max(sizes, default=1))):
            for fit in run_batched(self.problem, [self._fitted(start) for start in some]):
                if fit is not None:
                    self.add(fit)

    def _fitted(self, start: Start) -> Batched[Fit | None]:
        cost_bound, least = start.cost_bound, -math.inf
        names, near = {cause.name for cause in start.causes}, _near(self) if self.best else []
        # What is near has a fit in each form: a verdict asks for it.
        early = self.problem.effort.early and all(fit.names != names for fit in near)
        rivals = self.leaders(1, None if early else start.form)
        if rivals and (start.causes or early):
            prior = self.log_prior(start.causes, start.form)
            least = self.log_posterior(rivals[0]) - prior - SEARCH.behind
            if start.form == "exact":
                # Twice the lead of a log-evidence is a fall of the cost.
                lead = self.leaders(1, "exact")[0].log_evidence - least if early else 0.0
                cost_bound = min(cost_bound, self.cost_bound + 2.0 * min(lead, 0.0))
        slopes = None if start.near is None else start.near.slopes
        with contextlib.suppress(np.linalg.LinAlgError):
            return (yield from minimise(
                self.problem, self.forms[start.form], start.causes, start.x, h=start.h,
                slopes=slopes, cost_bound=cost_bound, least=least,
            ))  # fmt: skip
        return None


def _linear(problem: Problem, form: Form, causes: Sequence[Cause], end: End) -> Iterator[Fit]:
    """The linear model about an end, unless it is singular there."""
    with contextlib.suppress(np.linalg.LinAlgError):
        yield linear(problem, form, causes, end)


def search(
    models: Models, ends: Sequence[End], causes: Sequence[Cause],
    say: Progress = lambda fraction, stage: None,
) -> None:  # fmt: skip
    """Fit the models that the data may come from, with `causes` that have no fit yet.

    `models` has the recalibrated one; `ends` are of `recalibrated`.
    """
    problem = models.problem
    _fit_singles(models, ends, causes)
    if any(form != "exact" for _, form in models.best):  # of the causes that were searched before
        _fit_other_forms(models)
    most, done = models.begun + SEARCH.most_fits, {frozenset[str](): models.null.log_evidence}
    for turn in range(SEARCH.rounds):
        say(0.3 + 0.5 * turn / SEARCH.rounds, "comparing models")
        new = [
            fit
            for fit in _worth_a_look(models)
            if fit.log_evidence > done.get(fit.names, -math.inf) + SEARCH.better
            and not (fit.names in done and _leaves_too_little(models, fit))
        ]
        # Where the best model leaves ten errors in each row, few looks beside others explain more.
        reaches = models.reaches
        new = new if reaches else [fit for fit in new if fit is new[0] or len(fit.causes) > 1][:2]
        if not new:
            break
        for leader in new:
            done[leader.names] = leader.log_evidence
            if models.begun < most:
                _look_beside(models, leader)
        _fit_other_forms(models)
        first = models.leaders(1)[0]
        if models.get(first.names) is None:  # a leader by another form gets the plain fit first
            models.add_fits([Start("exact", first.causes, first.x, first)])
        if not reaches and models.leaders(1)[0].names in done:
            break
    compared = [fit for fit in models.leaders() if fit in _near(models) or not fit.causes]
    sharper = [sharpened(problem, models.forms[fit.form], fit) for fit in compared]
    for fit in run_batched(problem, sharper):
        models.best[fit.names, fit.form] = fit


def screened(models: Models, effects: Sequence[Response], forms: Sequence[str] = ()) -> None:
    """Add no cause and single ones by the linear model about the recalibrated one, in `forms`."""
    null = models.null
    ends: dict[tuple[Cause, ...], End] = {(): null.end}
    for effect in effects:
        ends.setdefault((effect.cause,), End(null.x, null.residual, effect.slopes, math.nan))
    for name in forms or models.forms:
        for causes, end in ends.items():
            for fit in _linear(models.problem, models.forms[name], causes, end):
                models.add(fit)


def _near(models: Models) -> list[Fit]:
    """The models that a verdict compares."""
    leaders = models.leaders()
    least = models.log_posterior(leaders[0]) - SEARCH.near
    return [fit for fit in leaders if models.log_posterior(fit) > least]


def _worth_a_look(models: Models) -> list[Fit]:
    """The leaders, each set of causes once.

    Of laws, which are many, only the leader and those with a law are taken. Of a simulation, what
    is behind a discrepancy without a cause is no leader.
    """
    sets: dict[frozenset[str], Fit] = {}
    for fit in _near(models):
        sets.setdefault(fit.names, fit)
    passed = ["exact"] if models.problem.effort.early else models.forms
    ahead = itertools.takewhile(lambda fit: fit.causes or fit.form in passed, sets.values())
    fits = [fit for fit in ahead if fit.causes][: SEARCH.leaders]
    if any(cause.curve for cause in models.offered):
        first = models.leaders(1)[0]
        return [fit for fit in fits if fit is first or any(cause.curve for cause in fit.causes)]
    return fits


def _fit_singles(models: Models, ends: Sequence[End], causes: Sequence[Cause]) -> None:
    """A fit of each cause by itself, begun where first looks promise most."""
    problem, short = models.problem, models.problem.short
    every = first_looks(short, seen_in(short, models.null), ends, causes)
    looks = run_batched(short, [looked(short, *look) for look in every[:1]])
    rival = next((end for end, _ in looks if is_near_data(short, end.residual)), None)
    looks += run_batched(short, [looked(short, *look, rival) for look in every[1:]])
    looks.sort(key=lambda look: look[0].cost)
    first = {cause.name: (end, cause) for end, cause in reversed(looks)}
    margin = SEARCH.margin * len(short.y) / len(problem.y)
    hopeful = [look for look in looks if look[0].cost < looks[0][0].cost + margin]
    hopeful += [look for look in first.values() if look not in hopeful]
    fits = [Start("exact", (cause,), end.x, end if short is problem else None)
            for end, cause in hopeful]  # fmt: skip
    models.add_fits(fits[:1])
    models.add_fits(fits[1:])


def _least_fall(models: Models, leader: Fit) -> float:
    """Fall of the cost that the prior asks of a further cause."""
    chances = (models.log_prior((*leader.causes, cause)) for cause in models.offered)
    return 2.0 * (models.log_prior(leader.causes) - max(chances))


def _leaves_too_little(models: Models, leader: Fit) -> bool:
    """Whether no further cause could lead, even one that explains all that the leader leaves.

    Its log-evidence would be half the fall of the cost larger, and ln 2 where it has one side only.
    Of a simulation, none is sought that has to fit as well as right models rarely do, unless the
    leader does so: then the stated errors are large.
    """
    plain, problem = models.get(leader.names), models.problem
    if plain is None:
        return False
    n, dof, x = len(problem.y), problem.freedom, plain.x[plain.free]
    fall = _least_fall(models, leader) - 2.0 * math.log(2.0)
    # Misfit and prior of a right model have the law of the misfit at its true coordinates.
    size = plain.chi2 + float(x @ plain.precision @ x)
    left = size - fall if math.isinf(dof) else (dof + size) * math.exp(-fall / (dof + n)) - dof
    rare, usual = (1.0 - lack_of_fit(problem, each, n) for each in (left, size))
    needs_luck = problem.effort.early and rare < SEARCH.rare <= usual
    return needs_luck or plain.cost < fall


def _look_beside(models: Models, leader: Fit) -> None:
    """Fit the models with one cause more, less or exchanged, from where a leader is."""
    problem, metric, h = models.problem, models.forms[leader.form], leader.h
    cost_bound, (first,) = leader.cost + SEARCH.margin, models.leaders(1)
    if leader.form == "exact":
        metric, h = softened(problem, leader), np.zeros(0)
    bases = []
    # Where laws are tried, they come before a third cause, which would imitate one.
    most = SEARCH.most_causes - (problem.laws is not None)
    if len(leader.causes) < most and not _leaves_too_little(models, leader):
        bases = [(leader.causes, leader.end)]
    smaller = [tuple(one for one in leader.causes if one is not out) for out in leader.causes]
    ends = run_batched(problem, [end_at(problem, rest, leader.x) for rest in smaller])
    bases += zip(smaller, ends, strict=True)
    starts = [Start(leader.form, rest, end.x, end) for rest, end in zip(smaller, ends, strict=True)]
    for rest, end in bases:
        more, third = rest == leader.causes, len(rest) > 1
        if third and not more:
            continue  # looks beside each pair exchange the third
        alone = all(cause.listed for cause in rest)  # one that is not may join
        offered = [cause for cause in models.offered if cause not in (*rest, *leader.causes)
                   and (cause.listed or alone)]  # fmt: skip
        least = problem.effort.worth if more else -math.inf
        if third:
            least = _least_fall(models, leader)
        tried: dict[str, int] = {}
        leads = more and leader.names == first.names
        sizes = (*problem.effort.smaller, USUAL) if leads else (USUAL,)
        probes = _likeliest(problem, rest, end, offered, sizes)
        for response in responses(problem, end, rest, offered, metric, h, sizes, True, probes):
            name = response.cause.name
            if response.gain < least or (name not in tried and len(tried) == SEARCH.more):
                continue
            tried[name] = tried.get(name, 0) + 1
            if tried[name] > 2 or not _may_improve(models, leader, rest, end, response):
                continue
            both, hyper = (*rest, response.cause), h if metric.names else None
            starts.append(Start(leader.form, both, response.x, response, hyper, cost_bound))
            if more and tried[name] == 1:
                # Nested: never worse than what it contains.
                starts.append(replace(starts[-1], x=leader.x))
    models.add_fits(starts)


def _likeliest(
    problem: Problem, rest: Sequence[Cause], end: End, offered: Sequence[Cause],
    sizes: Sequence[float],
) -> list[Probe] | None:  # fmt: skip
    """Of a long record, the probes of each cause that promise most in its beginning."""
    short, likely = problem.short, dict[str, list[Probe]]()
    if short is problem:
        return None
    (there,) = run_batched(short, [end_at(short, rest, end.x)])
    left = math.sqrt(max(np.sum(short.chi2_of_tables(there.residual[None])) / len(short.y), 1.0))
    metric = Softened(short, left)
    for response in responses(short, there, rest, offered, metric, np.zeros(0), sizes, True):
        likely.setdefault(response.cause.name, []).append(response.probe)
    return [probe for probes in likely.values() for probe in probes[: SEARCH.likeliest]]


def _may_improve(
    models: Models, leader: Fit, rest: Sequence[Cause], end: End, response: Response
) -> bool:
    """Whether a response promises, to first order, a better fit than its model has."""
    problem, form, both = models.problem, models.forms[leader.form], (*rest, response.cause)
    known = models.get({cause.name for cause in both}, leader.form)
    if known is None:
        return True
    free, precision = problem.free(both), precision_of(problem, both)
    left = end.residual - response.slopes @ (response.x - end.x)[free]
    x = np.stack([response.x, known.x])[:, free]
    promised, reached = costs_of(form, leader.h, x, precision, np.stack([left, known.residual]))
    return bool(promised < reached - SEARCH.better)


def _fit_other_forms(models: Models) -> None:
    """Fit models with a discrepancy, where they promise to be near the likeliest of that form, as
    twins are to be compared in one form; of a simulation near that of any form.
    """
    name, early, hopes = [*models.forms][-1], models.problem.effort.early, list[Any]()
    for old in models.leaders(form="exact"):
        known = hope = models.get(old.names, name)
        # A fit beside a large discrepancy may have stayed where the cause does nothing.
        if known is None or known.chi2 > old.chi2 + SEARCH.margin:
            hope = models.linear(old, name)
        if hope is not None:
            better = known is None or hope.log_evidence > known.log_evidence + SEARCH.better
            hopes.append((models.log_posterior(hope), old, hope, better))
    most = max(hope[0] for hope in hopes)
    if early:
        most = max(most, models.log_posterior(models.leaders(1)[0]))
    starts = []
    for promised, old, hope, better in sorted(hopes, key=lambda hope: -hope[0]):
        if better and (most - promised < SEARCH.behind or not (old.causes or early)):
            starts.append(Start(name, old.causes, old.x, old, hope.h))
        elif better and len(old.causes) < 2:
            models.add(hope)
    models.add_fits(starts)
    leaders = [fit for fit in models.leaders(SEARCH.leaders, name) if fit.causes]
    if early and leaders[:1] == models.leaders(1):
        # The model without a cause gets as many searches as its rivals, from where they are.
        models.add_fits([Start(name, (), fit.x, h=fit.h) for fit in leaders])
