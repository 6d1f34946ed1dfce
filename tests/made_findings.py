"""Diagnoses of a toy model whose truth is known."""

import copy
from dataclasses import replace

import numpy as np

from stickslip._util.note import Note
from stickslip._util.prior import Prior
from stickslip.diagnosis.data.table import Table
from stickslip.diagnosis.decision.verdict import Verdict
from stickslip.diagnosis.entry import diagnose_model
from stickslip.diagnosis.fitting.problem import Cached, Problem
from stickslip.diagnosis.fitting.search import Start
from stickslip.diagnosis.model import relaxed
from stickslip.diagnosis.pipeline import run
from stickslip.diagnosis.result import Diagnosis
from stickslip.diagnosis.terms.cause import Cause
from stickslip.diagnosis.terms.laws import free_law
from stickslip.diagnosis.terms.parameter import Parameter

SD, BUMP = 0.05, 0.9
TRUTH = (1.1, 1.9, BUMP, 0.0, 0.0)
CONSTANTS = (
    Parameter("level", Prior("normal", 1.0, 0.3), "V"),
    Parameter("slope", Prior("normal", 2.0, 0.3), "V"),
)
CAUSES = (
    Cause("bump", Parameter("bump.height", None, "V", -9.0, 9.0, 0.5), "a bump in the middle"),
    Cause("wave", Parameter("wave.size", None, "V", 0.0, 5.0, 0.5), "a wave"),
    Cause("kink", Parameter("kink.slope", None, "V", -9.0, 9.0, 0.5), "a kink at the end"),
)


def predict(x, values):
    """Predictions of each vector (level, slope, bump, wave, kink), shape (vectors, len(x))."""
    shapes = [np.ones_like(x), x, np.exp(-(((x - 0.5) / 0.12) ** 2)), np.sin(25.0 * x),
              np.maximum(x - 0.7, 0.0)]  # fmt: skip
    return values[:, :5] @ np.stack(shapes)


def toy(truth, error=0.0, seed=3):
    """The diagnosis of two curves of readings with noise, and perhaps scatter beyond it."""
    random = np.random.default_rng(seed)
    x = np.tile(np.linspace(0.0, 1.0, 20), 2)
    side = np.repeat(["left", "right"], 20)
    y = predict(x, np.array([truth]))[0] + SD * random.standard_normal(len(x))
    y += error * random.standard_normal(len(x))
    table = Table({"side": side, "x": x}, y, sd=SD, name="volts", unit="V")
    causes = (*CAUSES, *relaxed(CONSTANTS))
    forward = lambda at, values: predict(np.asarray(at, dtype=float), values)  # noqa: E731
    model = Cached(lambda v: predict(x, v))
    return Diagnosis(run(Problem((table,), model, CONSTANTS, causes, forward=forward), 0))


def with_pairs(result):
    """The same with each further cause fitted beside the best ones: a search looks for none."""
    models, best = copy.copy(result.findings.models), result.best.fit
    models.best = dict(models.best)
    more = [cause for cause in models.offered if cause not in best.causes]
    models.add_fits([Start(best.form, (*best.causes, cause), best.x, h=best.h) for cause in more])
    return replace(result, findings=replace(result.findings, models=models))


def friction(seed=1):
    """A force whose friction falls with the speed, and a law of a free shape in its place."""
    u = np.linspace(0.02, 1.0, 40)
    true = 0.3 * (1.0 - 0.4 * (1.0 - np.exp(-u / 0.2)))
    y = true + 0.002 * np.random.default_rng(seed).standard_normal(len(u))
    law = free_law("friction", "speed", "m/s", 0.0, 1.0, factor_of="mu")
    mu = Parameter("mu", Prior("normal", 0.3, 0.02))

    def force(table, p, curves):
        return p["mu"] * (1.0 + curves["friction over speed"](table["u"]))

    table = Table({"u": u}, y, sd=0.002, name="force", unit="N")
    return diagnose_model(force, table, [mu], [law, CAUSES[1]])


def said(result, kind, **changes):
    """The same with another kind of verdict, to see how it is told."""
    verdict = replace(result.verdict, kind=kind, **changes)
    return replace(result, findings=replace(result.findings, verdict=verdict))


def refused(result):
    """A diagnosis of the same data that were refused, without any fit."""
    findings = result.findings
    models = type(findings.models)(findings.problem, findings.problem.causes)
    reason = Note("conditions-alike", "All conditions read <alike>.", 1.0)
    verdict = Verdict("data-problem", reasons=(reason,))
    return replace(result, findings=replace(findings, models=models, verdict=verdict))
