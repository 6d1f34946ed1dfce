"""The log-evidence of fits beside that of nested sampling, which makes no step of Laplace's."""

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import multivariate_normal

from stickslip.diagnosis.fitting.forms import forms
from toys import BEND, STEP, TWIN, WAVE, data, fitted, problem, shapes

X = np.linspace(1.0, 3.0, 30)
SHAPE = {name.partition(".")[0]: shape for name, shape in shapes(X).items()}
DRIFT = np.convolve(np.random.default_rng(5).standard_normal(40), 0.6 ** np.arange(11), "valid")

TOYS = {
    "linear": ([], 0.0, "exact"),
    "two causes": ([WAVE, BEND], 0.3 * SHAPE["wave"] + 0.2 * SHAPE["bend"], "exact"),
    "half-normal": ([STEP], 0.4 * SHAPE["step"], "exact"),
    "at its end": ([STEP], -0.1 * SHAPE["step"], "exact"),
    "correlated": ([WAVE], 0.4 * SHAPE["wave"] + 0.15 * DRIFT, "ar1"),
    "twins": ([WAVE, TWIN], 0.6 * SHAPE["wave"], "exact"),
}
"""Causes of the model, what is added to the line, and the noise model."""


@pytest.mark.nightly
@pytest.mark.parametrize("toy", TOYS)
def test_evidence_is_that_of_nested_sampling(toy):
    dynesty = pytest.importorskip("dynesty", reason="the group `oracle` is not installed")
    causes, extra, name = TOYS[toy]
    posed = problem(data(extra, **({"run": np.zeros(30)} if name == "ar1" else {})), causes)
    form, free = forms(posed)[name], posed.free(causes)
    fit = fitted(posed, causes, name)
    middle, sd, low, high = form.limits()
    half = np.array([posed.parameters[k].one_sided for k in free])

    def of_unit_cube(u):
        x = np.where(half, ndtri(0.5 + 0.5 * u[: len(free)]), ndtri(u[: len(free)]))
        return np.concatenate([x, middle + sd * ndtri(u[len(free) :])])

    def likelihood(point):
        x, h = np.zeros((1, posed.size)), point[len(free) :]
        x[0, free] = point[: len(free)]
        if np.any((x < posed.limits[0]) | (x > posed.limits[1])) or np.any((h < low) | (h > high)):
            return -1e100
        return float(form.density(posed.residuals(x), h)[0])

    sampler = dynesty.NestedSampler(
        likelihood, of_unit_cube, len(free) + len(middle), nlive=400,
        rstate=np.random.default_rng(1),
    )  # fmt: skip
    sampler.run_nested(dlogz=0.01, print_progress=False)
    found, error = sampler.results.logz[-1], sampler.results.logzerr[-1]
    # Its error is some 0.1. A decision takes a lead of three.
    assert fit.log_evidence == pytest.approx(found, abs=3.0 * error)
    if toy == "linear":
        covariance = np.diag(posed.sd**2) + fit.slopes @ fit.slopes.T
        law = multivariate_normal(np.zeros(len(X)), covariance)
        begin = posed.residuals(np.zeros((1, posed.size)))[0]
        assert fit.log_evidence == pytest.approx(law.logpdf(begin), abs=1e-6)
