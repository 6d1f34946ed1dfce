"""Data, models, priors and causes that cannot be used are refused by name."""

import math

import numpy as np
import pytest

from stickslip.diagnosis import (
    Cause,
    CauseParameter,
    Prior,
    Settings,
    Uncertain,
    diagnose,
    diagnose_model,
)
from stickslip.errors import ScenarioError
from toy_model import CAUSES, UNCERTAIN


@pytest.mark.parametrize(
    ("values", "options", "said"),
    [
        ([1.0, math.nan], {}, "observed"),
        ([1.0, 2.0], {"condition": [0, 2]}, "condition"),
        ([1.0, 2.0], {"block": [0]}, "block"),
        ([1.0, 2.0], {"sd": [0.0, 1.0]}, "sd"),
        ([1.0, 2.0], {"sd": [1.0, 1.0, 1.0]}, "sd"),
        ([1.0, 2.0], {"order": [1, 2, 3]}, "order"),
        ([1.0, 2.0], {"group": [0]}, "group"),
        ([1.0, 2.0], {"source": ["a"]}, "source"),
        ([1.0, "x"], {}, "observed"),
        ([1.0, 2.0], {"sd": [-1.0, 1.0]}, "sd"),
        ([1.0, 2.0], {"order": ["a", "b"]}, "order: allowed is a number"),
        ([1.0, 2.0], {"condition": [0.0, 0.7]}, "condition: allowed are whole numbers"),
        ([1.0, 2.0], {"block": [0, None]}, "block: allowed are whole numbers"),
        ([1.0, 2.0], {"group": [0.5, 1.0]}, "group: allowed are whole numbers"),
        ([1.0, 2.0], {"relative_sd": 0.0}, "relative_sd = 0.0: allowed is a number above 0"),
        ([1.0, 2.0], {"seed": -1}, "seed = -1: allowed is a whole number from 0"),
        ([1.0, 2.0], {"seed": 1.5}, "seed = 1.5: allowed is a whole number from 0"),
        ([1.0, 2.0], {"singleton_condition": 2}, "singleton_condition = 2: allowed is .* 0 to 1"),
        ([1.0, 2.0], {"settings": Settings(np.zeros((3, 1)), np.zeros(3))}, "settings: .* of 2"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(values, options, said):
    with pytest.raises(ScenarioError, match=said):
        diagnose_model(lambda c, p: p, None, values, [], [], **options)


@pytest.mark.parametrize("given", ["m.toml", None, np.zeros(3)])
def test_only_a_measurement_is_diagnosed(given):
    with pytest.raises(
        ScenarioError, match=r"measurement = .*: allowed is a Measurement; "
    ) as said:
        diagnose(given)
    assert "\n" not in str(said.value)


def _line(x, p):
    return p[:, :1] * x


@pytest.mark.parametrize(
    ("model", "uncertain", "causes", "said"),
    [
        (lambda x, p: (p[:, :1] * x)[0], UNCERTAIN[:1], [], r"predict: of 1 .* \(1, 12\)"),
        (lambda x, p: (p[:, :1] * x).T, UNCERTAIN[:1], [], r"shape \(12, 1\)"),
        (lambda x, p: p[:, :1], UNCERTAIN[:1], [], r"shape \(1, 1\)"),
        (lambda x, p: p[:, :1] * x * math.nan, UNCERTAIN[:1], [], "computes no observable"),
        (lambda p: p, UNCERTAIN[:1], [], r"takes \(p\): .* function of \(conditions, parameters\)"),
        (3, UNCERTAIN[:1], [], r"predict = 3: allowed is a function of \(conditions, param"),
        (_line, [UNCERTAIN[0], UNCERTAIN[0]], [], "comes twice"),
        (_line, UNCERTAIN[:1], [CAUSES[0], CAUSES[0]], "causes: .* comes twice"),
        (_line, UNCERTAIN[:1], CAUSES[0], "allowed is a list of Cause"),
        (_line, UNCERTAIN[0], [], "allowed is a list of Uncertain"),
        (_line, UNCERTAIN[:1], [Cause("k0", CAUSES[0].parameters)], "no uncertain parameter's"),
        (_line, UNCERTAIN[:1], [Cause("none", CAUSES[0].parameters)], "nor none or unknown"),
        (_line, UNCERTAIN[:1], [Cause("a", relaxes_prior="b")], "relaxes_prior = b"),
        (_line, UNCERTAIN[:1], [CAUSES[0], Cause("a", CAUSES[0].parameters)], "of two causes"),
    ],
)
def test_an_invalid_model_is_refused(model, uncertain, causes, said):
    x = np.linspace(1.0, 3.0, 12)
    with pytest.raises(ScenarioError, match=said):
        diagnose_model(model, x, x, uncertain, causes, sd=np.full(12, 0.1))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Prior("gauss", 2.0, 0.2), "normal, log-normal, log-uniform"),
        (lambda: Prior("normal", 2.0, -0.2), "sd = -0.2: allowed is a number above 0"),
        (lambda: Prior("normal", math.nan, 0.2), "mean = nan"),
        (lambda: Prior("normal", "a", 0.2), "mean = "),
        (lambda: CauseParameter("a", "-", 1.0, 2.0, 0.5), "absent = 0.0: allowed is 1.0 to 2.0"),
        (lambda: Prior("log-normal", 2.0, 1.0), "factor > 1"),
        (lambda: Prior("log-uniform", -1.0, 2.0), "0 < low < high"),
        (lambda: Prior("log-uniform", 3.0, 2.0), "0 < low < high"),
        (lambda: CauseParameter("a", "-", 2.0, -2.0, 0.5), "low < high"),
        (lambda: CauseParameter("a", "-", "b", 2.0, 0.5), "parameter a: low = .*: .* a number"),
        (lambda: CauseParameter("a", "-", -2.0, 2.0, True), "parameter a: scale = .*: .* a number"),
        (lambda: Uncertain("a", 0.1), "parameter a: prior = 0.1: allowed is a Prior"),
        (lambda: Uncertain(5, Prior("normal", 2.0, 0.2)), "name = 5: allowed is a text"),
        (lambda: CauseParameter("a", "-", -2.0, 2.0, 0.0), "scale = 0.0"),
        (lambda: Cause("a", CauseParameter("a.b", "-", -2.0, 2.0, 0.5)), "needs a comma"),
    ],
)
def test_invalid_priors_and_causes_are_refused(make, said):
    with pytest.raises(ScenarioError, match=said):
        make()
