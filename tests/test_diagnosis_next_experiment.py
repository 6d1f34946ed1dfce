"""Which experiment tells the candidates apart, where nothing was measured."""

import dataclasses

import numpy as np
import pytest

from stickslip.diagnosis.inference.discrimination import separate
from stickslip.diagnosis.inference.experiment_design import _proposals
from stickslip.diagnosis.inference.verdict import MARGIN
from toy_model import (
    X,
    predict,
    shared_diagnosis,
)


def test_candidates_are_compared_at_unmeasured_drives():
    found = shared_diagnosis(0, split=0.4)
    assert found.verdict.kind == "ambiguous"
    places = np.arange(len(X))

    def elsewhere(rows, parameters):
        values = predict(None, parameters)[:, rows]
        values[:, 3] = np.nan
        return values

    worth = separate(found, elsewhere, places, trials=2)
    assert {fit.name for fit in worth.candidates} == set(found.verdict.causes)
    assert worth.chi2[3] == 0.0  # what cannot be computed is worth nothing
    random = np.random.default_rng(3)
    for k, fit in enumerate(worth.candidates):
        # The spread of predictions over draws of the fit; 2000 draws tell it to 1.6 %.
        draws = np.tile(fit.x, (2000, 1))
        draws[:, fit.candidate.free] += random.multivariate_normal(
            np.zeros(len(fit.candidate.free)), fit.covariance, 2000
        )
        drawn = np.std(predict(None, found.problem.physical(draws)), axis=0)
        inside = places != 3
        assert worth.sd[k, inside] == pytest.approx(drawn[inside], rel=0.1)
    level = np.mean(worth.predicted, axis=0)
    noise = (found.noise.floor**2 + (found.noise.relative * level) ** 2) / 2
    noise += np.median(found.roughness) ** 2
    gap = worth.predicted[0] - worth.predicted[1]
    assert worth.chi2 == pytest.approx(gap**2 / (noise + np.sum(worth.sd**2, axis=0)))


def test_a_named_cause_is_compared_with_the_runner_up():
    found = shared_diagnosis(3, wave=1.0)
    worth = separate(found, lambda rows, p: predict(None, p)[:, rows], np.arange(len(X)))
    others = [fit for fit in found.ranking.singles if fit is not found.verdict.fit]
    best = max(others, key=lambda fit: fit.log_evidence)
    assert worth.candidates[:2] == [found.verdict.fit, best]
    near = [fit for fit in others if best.log_evidence - fit.log_evidence < MARGIN]
    assert {fit.name for fit in worth.candidates[2:]} == {fit.name for fit in near} - {best.name}
    assert np.all(worth.pair[:, 0] == 0)


def test_the_one_candidate_of_an_ambiguous_verdict_is_compared_like_a_name():
    found = shared_diagnosis(3, wave=1.0)
    doubted = dataclasses.replace(
        found, verdict=dataclasses.replace(found.verdict, kind="ambiguous")
    )
    # A pair of the cause with any other one says the same of it.
    named, one = (
        separate(each, lambda rows, p: predict(None, p)[:, rows], np.arange(len(X)))
        for each in (found, doubted)
    )
    assert len(one.candidates) > 1
    assert one.candidates == named.candidates
    own = set(found.verdict.causes)
    for fit in one.candidates[1:]:
        assert not own & {cause.name for cause in fit.candidate.causes}


def test_a_candidate_at_the_limit_of_what_can_be_computed_is_compared_too():
    found = shared_diagnosis(3, wave=1.0)
    fit = found.verdict.fit
    least = found.problem.physical(fit.x[None, :])[0, 0]

    def ends(rows, p):
        return np.where(p[:, :1] < least - 1e-12, np.nan, predict(None, p))[:, rows]

    whole = separate(found, lambda rows, p: predict(None, p)[:, rows], np.arange(len(X)))
    worth = separate(found, ends, np.arange(len(X)))
    # The constant's slope changes by 0.06 over a unit, so by 0.003 over half a step of 0.1; with
    # the others' covariances the error may be some times that.
    np.testing.assert_allclose(worth.sd[0], whole.sd[0], rtol=0.02)


def test_proposals_vary_the_middle_of_what_a_mode_was_given():
    def condition(mode, hold, frequency):
        return {
            "drive.mode": mode, "drive.direction": "+x", "drive.edge": "rise", "drive.base": 0.0,
            "drive.peak": 2.5e-3, "drive.hold": hold, "drive.frequency": frequency,
        }  # fmt: skip

    measured = [condition("OPP", 1.3e-3, 20.0)]
    measured += [condition("OPP", 1e-3, 30.0 + k) for k in range(4)]
    measured += [condition("IPP", 2e-3, 30.0)]
    holds = {"OPP": set(), "IPP": set()}
    for each in _proposals(measured):
        holds[each["drive.mode"]].add(each["drive.hold"])
    assert holds == {"OPP": {7e-4, 1e-3, 1.3e-3}, "IPP": {1.4e-3, 2e-3, 2.6e-3}}
