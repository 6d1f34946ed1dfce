"""Causes whose minima are narrow: found by a dense scan, alone and beside another cause."""

import numpy as np
import pytest

from stickslip import ScenarioError
from stickslip.diagnosis import Cause, CauseParameter, Prior, Uncertain, diagnose_model

# Readings of a straight line over 100 s with a ripple, of which only the period is not known. At
# the end a period T that is off by dT has another phase by 2 pi 100 s dT / T^2: a minimum is a few
# thousandths of T wide, and the range has hundreds.
LONG, SD, PERIOD, RIPPLE = 100.0, 0.1, 0.9137, 0.3
WHEN = np.sort(np.random.default_rng(5).uniform(0.0, LONG, 30))
LINE = (
    Uncertain("level", Prior("normal", 0.0, 1.0)),
    Uncertain("slope", Prior("normal", 0.0, 1.0)),
)
BEND = Cause("bend", (CauseParameter("bend.size", "-", -9.0, 9.0, 1.0),))


def ripple(fineness):
    period = CauseParameter("ripple.period", "s", 0.0, 4.0, 0.5, negligible=0.2, fineness=fineness)
    return Cause("ripple", (period,), "a ripple of a known size")


def predict(when, parameters):
    level, slope, bend, period = parameters.T[:, :, None]
    wave = np.where(
        period > 0.0, np.sin(2.0 * np.pi * when / np.where(period > 0.0, period, 1.0)), 0.0
    )
    along = when / LONG
    return level + slope * along + bend * along * (1.0 - along) + RIPPLE * wave


def diagnosed(fineness, bend=0.0):
    truth = predict(WHEN, np.array([[0.2, -0.4, bend, PERIOD]]))[0]
    noise = np.random.default_rng(11).normal(0.0, SD, len(WHEN))
    sd = np.full(len(WHEN), SD)
    return diagnose_model(predict, WHEN, truth + noise, LINE, [BEND, ripple(fineness)], sd=sd)


def test_a_narrow_minimum_is_found_by_its_fineness():
    # The coordinate of T is asinh(sinh(1) T / scale), so that dT is cosh(u) / sinh(1) times the
    # scale and du: of a spacing of 0.15 x 0.01 it is 0.0015 s, a third of a radian each way.
    found = diagnosed(0.01)
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("ripple",))
    period = found.findings.problem.parameters[1].value(found.verdict.fit.x[-1:])[0]
    # The derivative of the ripple by T is 2 pi t / T^2 times its size and a cosine.
    phase = 2.0 * np.pi * WHEN / PERIOD
    sd = SD / np.linalg.norm(RIPPLE * phase / PERIOD * np.cos(phase))
    assert abs(period - PERIOD) < 4.0 * sd


def test_without_it_the_minimum_is_missed():
    # So the test above holds nothing that any search would have found.
    assert diagnosed(1.0).verdict.kind != "named"


@pytest.mark.parametrize("size", [0.8, -1.7])
def test_a_narrow_minimum_is_found_of_a_cause_whose_size_is_not_known(size):
    # The size is not that of the scan's responses, and may be below zero.
    height = CauseParameter("wave.height", "-", -9.0, 9.0, 1.0)
    period = CauseParameter(
        "wave.period", "s", 0.1, 10.0, 1.0, absent=1.0, shape=True, fineness=0.01
    )
    wave = Cause("wave", (height, period), "a wave of an unknown size")

    def model(when, parameters):
        size, period = parameters.T[3:, :, None]
        flat = predict(when, np.hstack([parameters[:, :3], np.zeros((len(parameters), 1))]))
        return flat + size * RIPPLE * np.sin(2.0 * np.pi * when / period)

    truth = model(WHEN, np.array([[0.2, -0.4, 0.0, size, PERIOD]]))[0]
    noise = np.random.default_rng(11).normal(0.0, SD, len(WHEN))
    sd = np.full(len(WHEN), SD)
    found = diagnose_model(model, WHEN, truth + noise, LINE, [BEND, wave], sd=sd)
    assert (found.verdict.kind, found.verdict.causes) == ("named", ("wave",))
    values = found.findings.problem.physical(found.verdict.fit.x[None, :])[0]
    # The mean square of a sine is a half.
    error = SD * np.sqrt(2.0 / len(WHEN)) / RIPPLE
    assert abs(values[3] - size) < 4.0 * error
    assert values[4] == pytest.approx(PERIOD, rel=1e-3)


def test_a_narrow_minimum_is_found_beside_another_cause():
    found = diagnosed(0.01, bend=2.0)
    assert (found.verdict.kind, found.verdict.causes) == ("pair", ("bend", "ripple"))


@pytest.mark.parametrize("wrong", [0.0, -1.0, 1.5, np.nan])
def test_fineness_has_a_range(wrong):
    with pytest.raises(ScenarioError, match=r"ripple\.period: fineness = .* is 0\.0001 to 1"):
        ripple(wrong)
