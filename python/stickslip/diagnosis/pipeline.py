"""The steps of a diagnosis, for any problem: recalibrate, test, compare models, decide."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from stickslip._util.arrays import Array
from stickslip._util.note import Note
from stickslip.diagnosis.decision.facts import Findings
from stickslip.diagnosis.decision.misfit_test import GOF_LEVEL, goodness_of_fit, tested
from stickslip.diagnosis.decision.posterior import posterior
from stickslip.diagnosis.decision.verdict import Verdict, decide
from stickslip.diagnosis.fitting.descent import finished
from stickslip.diagnosis.fitting.law_forms import with_forms
from stickslip.diagnosis.fitting.models import Fit, minimise, sharpened
from stickslip.diagnosis.fitting.options import SEARCH
from stickslip.diagnosis.fitting.problem import FAR_OFF, Problem
from stickslip.diagnosis.fitting.responses import USUAL, responses
from stickslip.diagnosis.fitting.search import Models, Progress, Start, screened, search
from stickslip.diagnosis.fitting.starts import recalibrated
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.unlisted import at_scale

# Draws about the recalibrated model that show its own noise, and their widths: a share of what the
# data leave open, and at most so many standard deviations of the priors. Chosen: well within both.
_DRAWS, _SHARE, _WIDEST = 24, 0.3, 0.02
_BETTER = 1.0  # fall of the cost after which the recalibrated model is tested again


def run(
    problem: Problem, seed: int, say: Progress = lambda fraction, stage: None,
    fault: Note | None = None,
) -> Findings:  # fmt: skip
    """All steps, one after another; where the data have a `fault`, no cause is looked for."""
    say(0.0, "recalibrating")
    null, ends = recalibrated(problem, seed)
    problem, null = _with_own_errors(problem, null, seed)
    say(0.2, "testing")
    models = Models(problem, problem.causes)
    models.add(null)
    effects = responses(problem, null.end, (), problem.causes, models.forms["exact"], null.h)
    test = tested(problem, null, effects, seed)
    if fault is not None or not test.misfit:  # else a search says more
        screened(models, effects)
    if fault is None and (test.misfit or posterior(models).has_cause):
        models = Models(problem, problem.causes)
        models.add(null)
        search(models, ends, problem.causes, say)
        if problem.laws and problem.wider and models.reaches:
            say(0.8, "laws of a free shape")
            if laws := _rivals(problem, models):
                wider = problem.wider(problem, laws)
                models = models.widened(wider, wider.causes)
                search(models, [], laws, say)
        if problem.unlisted and problem.wider:
            say(0.8, "effects that nobody listed")
            shapes = problem.unlisted(problem, models.null.x)
            wider = problem.wider(problem, shapes)
            shapes, models = wider.causes[-len(shapes) :], models.widened(wider, wider.causes)
            models.add_fits([*_far_scales(wider, shapes)])
            search(models, [], shapes, say)
            models.without_twins()
        models = with_forms(models)
    say(0.9, "deciding")
    if models.null.cost < null.cost - _BETTER:
        # The search has led to a better recalibrated model, which is what is tested.
        exact, null = models.forms["exact"], models.null
        effects = responses(models.problem, null.end, (), problem.causes, exact, null.h)
        test = tested(models.problem, null, effects, seed)
    verdict = Verdict("data-problem", (), None, (fault,)) if fault else decide(models, test)
    say(1.0, "done")
    return Findings(models, test, effects, verdict, seed)


def _rivals(problem: Problem, models: Models) -> list[Cause]:
    """Laws that may compete with the likeliest causes.

    All, where these leave more than the errors or are one on each of two sides, which may be one of
    both; else those that promise to first order to come near.
    """
    assert problem.laws is not None
    assert problem.wider is not None
    names, null = models.leaders(1)[0].names, models.null
    plain, sides = models.get(names), {name.partition("[")[2] for name in names}
    laws = [*problem.laws(problem, null.x)]
    if plain is None or goodness_of_fit(models.problem, plain) < GOF_LEVEL or len(sides) > 1:
        return laws
    wider = problem.wider(problem, laws)
    models = models.widened(wider, ())
    null, exact, least = models.null, models.forms["exact"], null.cost - plain.cost - SEARCH.behind
    promised = responses(wider, null.end, (), laws, exact, null.h, (USUAL,), cheap=True)
    promising = {one.cause.name for one in promised if one.gain > least}
    return [law for law in laws if law.name in promising]


def _far_scales(problem: Problem, shapes: Sequence[Cause]) -> Iterator[Start]:
    """Where scales begin that the stated constants ask for, as of a gear, or in another unit.

    The recalibrated constants have taken such a factor, and no descent leads back.
    """
    stated = np.zeros(problem.size)
    predicted = problem.y - problem.residuals(stated[None])[0]
    design = np.column_stack([predicted, np.ones(len(predicted))])
    factor = float(np.linalg.lstsq(design, problem.y)[0][0])
    for cause in shapes if factor > 0.0 else ():
        for name, coordinate in at_scale(cause, factor).items():
            x = stated.copy()
            x[problem.names.index(name)] = coordinate
            yield Start("exact", (cause,), x)


def first_look(problem: Problem, seed: int) -> float:
    """Log-posterior of the likeliest model by linear models about the recalibrated one."""
    null, _ = recalibrated(problem, seed)
    models = Models(problem, problem.causes)
    models.add(null)
    effects = responses(problem, null.end, (), problem.causes, models.forms["exact"], null.h)
    screened(models, effects)
    return models.log_posterior(models.leaders(1)[0])


def moved_constants(findings: Findings) -> list[Note]:
    """A note on each stated constant that the told model moves far from its prior."""
    fit = findings.verdict.fit or findings.models.null
    relaxed = {cause.frees for cause in fit.causes}
    notes = []
    for k, constant in enumerate(findings.problem.constants):
        far = abs(fit.x[k])
        if constant.is_stated and constant.name not in relaxed and far > FAR_OFF:
            text = f"{constant.name} is {far:.0f} of its stated errors from its stated value."
            notes.append(Note("constant-far", text, float(fit.x[k])))
    return notes


def _with_own_errors(problem: Problem, null: Fit, seed: int) -> tuple[Problem, Fit]:
    """The problem with the errors of the fitted model, and its fit again.

    An error that conditions share must not follow what was measured; and where the model itself
    jumps under tiny changes of its constants, that is an error too.
    """
    problem = problem.with_shared_errors_at(problem.y - null.residual)
    problem = replace(problem, simulator_noise=_simulator_noise(problem, null, seed))
    form = Models(problem, ()).forms["exact"]
    again = finished(problem, minimise(problem, form, (), null.x, slopes=null.slopes))
    return problem, finished(problem, sharpened(problem, form, again))


def _simulator_noise(problem: Problem, null: Fit, seed: int) -> Array:
    """Scatter of the predictions about a plane under tiny changes of the constants, shape (n,)."""
    p = len(null.free)
    random = np.random.default_rng([seed, 5])
    move = random.standard_normal((max(_DRAWS, 3 * p), p))
    step = np.minimum(_SHARE * np.sqrt(np.diag(null.covariance)), _WIDEST)
    x = np.tile(null.x, (len(move), 1))
    x[:, null.free] += move * step
    missed = problem.residuals(x)
    design = np.hstack([np.ones((len(move), 1)), move])
    left = missed - design @ np.linalg.lstsq(design, missed, rcond=None)[0]
    scatter = np.sqrt(np.sum(left**2, axis=0) / max(len(move) - p - 1, 1))
    # A row that is sometimes not computed is lost, and not rough.
    return np.where(scatter < 1e2 * problem.sd, scatter, 0.0)
