"""Which experiments tell candidates apart, and what is said of them."""

import itertools

import numpy as np
import pandas as pd
import pytest
from scipy.stats import multivariate_normal

from made_velocities import drives, measurement
from stickslip import Scenario
from stickslip.diagnosis.decision import experiments as asked
from stickslip.diagnosis.decision.verdict import Verdict
from stickslip.walker import drives as design
from stickslip.walker.problem import Drives
from stickslip.walker.velocity import drive_settings


def condition(mode="OPP", hold=1e-3, frequency=30.0, **more):
    return {
        "drive.mode": mode, "drive.direction": "+x", "drive.edge": "rise", "drive.base": 0.0,
        "drive.peak": 2.5e-3, "drive.hold": hold, "drive.frequency": frequency, **more,
    }  # fmt: skip


def chosen(level, covariance=None, noise=1.0, count=3, pairs=None, given=None):
    """Experiments of drives at 30 Hz and more, of which candidates predict a level each."""
    level = np.array(level)
    candidates, drives = level.shape
    given = given or [condition(frequency=30.0 + 15.0 * k) for k in range(drives)]
    covariance = np.zeros((candidates, drives, drives)) if covariance is None else covariance
    pairs = list(itertools.combinations(range(candidates), 2)) if pairs is None else pairs
    predicted = level, covariance, np.full(drives, noise)
    return design.choose(given, "abcdef"[:candidates], predicted, pairs, count)[0]


def diagonal(variance):
    return np.stack([np.diag(row) for row in np.asarray(variance, dtype=float)])


# ---------------------------------------------------------------------------------- separation
def test_the_chi_square_is_the_evidence_that_a_reading_is_expected_to_bring():
    # For errors of one size, twice the mean log-evidence for the truth is the squared gap.
    level, noise = np.array([[1.0], [1.6]]), np.array([0.04])
    covariance = diagonal([[0.05], [0.05]])
    chi2 = asked.expected_chi2(level, covariance, noise)[0, 1, 0]
    assert chi2 == pytest.approx(0.6**2 / 0.09)
    y = np.random.default_rng(1).normal(1.0, 0.3, 200_000)
    lead = multivariate_normal(1.0, 0.09).logpdf(y) - multivariate_normal(1.6, 0.09).logpdf(y)
    assert chi2 == pytest.approx(2.0 * np.mean(lead), rel=0.02)
    # A candidate that leaves much open cannot be told from another by what it allows.
    covariance[1] = 1.0
    both = asked.expected_chi2(level, covariance, noise)[..., 0]
    assert both.tolist() == [[0.0, pytest.approx(0.36 / 1.04)], [pytest.approx(0.36 / 1.04), 0.0]]


def test_what_is_uncertain_in_both_cancels_between_two_drives():
    # A constant moves all readings by 1; the candidates lie 0.2 to either side of it.
    level = np.array([[0.1, -0.1, 0.1], [-0.1, 0.1, -0.1]])
    covariance = np.ones((2, 3, 3))
    noise = np.full(3, 0.01)
    alone = asked.expected_chi2(level, covariance, noise)[0, 1]
    assert alone == pytest.approx(np.full(3, 0.04 / 1.01))
    together = asked.expected_chi2(level, covariance, noise, beside=[0])[0, 1]
    # The difference of the first two is free of the constant: 0.4 with an error of 0.02^(1/2).
    assert together[1] == pytest.approx(0.4**2 / 0.02, rel=1e-3)
    # The same again, and the third, which is like it, only halve the noise.
    assert together[[0, 2]] == pytest.approx(0.04 / 1.005)


def test_separations_by_several_drives_are_those_of_all_their_readings():
    random = np.random.default_rng(3)
    level, slopes = random.standard_normal((3, 5)), random.standard_normal((3, 2, 5))
    covariance, noise = slopes.swapaxes(1, 2) @ slopes, random.uniform(0.1, 1.0, 5)
    found = asked.expected_chi2(level, covariance, noise, beside=[4, 1])
    for a, b in itertools.combinations(range(3), 2):
        for k in (0, 2, 3):
            rows = [4, 1, k]
            gap = (level[a] - level[b])[rows]
            errors = [covariance[c][np.ix_(rows, rows)] + np.diag(noise[rows]) for c in (a, b)]
            least = min(gap @ np.linalg.inv(each) @ gap for each in errors)
            assert found[a, b, k] == found[b, a, k] == pytest.approx(least)


def test_what_a_candidate_cannot_compute_is_no_proposal():
    level = np.array([[0.0, 1.0, 0.0], [1.0, np.nan, 1.0]])
    covariance = diagonal(np.zeros((2, 3)))
    covariance[0, 2, 2] = np.nan
    chi2 = asked.expected_chi2(level, covariance, np.ones(3))
    assert chi2[0, 1].tolist() == [1.0, 0.0, 0.0]


# --------------------------------------------------------------------------------------- choice


def test_the_best_of_each_kind_is_chosen_and_none_is_mirrored():
    given = [condition(), condition(hold=2e-3), condition(**{"drive.direction": "-x"}),
             condition(frequency=45.0), condition(frequency=60.0)]  # fmt: skip
    level = 1e-3 * np.array([[3.0, 2.0, -3.0, 1.0, 0.0], [1.0, 1.0, -1.0, 0.5, 0.0]])
    found, (weak,) = (
        chosen(level, diagonal(np.full((2, 5), variance)), 1e-7, n, given=given)
        for variance, n in ((0.0, 5), (1e-5, 1))
    )
    # The second is of the first one's kind, the third its mirror image, the last tells nothing.
    assert paces(found) == [30.0, 45.0]
    assert found[0].drive["hold"] == 1e-3
    assert found[0].separation == pytest.approx(2e-3**2 / 1e-7)
    assert found[0].decides
    assert found[0].predictions["b"] == {"velocity": 1e-3, "sd": 0.0}
    assert found[0].why.code == "separates"
    assert str(found[0]).startswith("mode OPP, direction +x, frequency 30 Hz, peak 2.5 mT, hold 1 ")
    assert "from b: with 3 trials their predictions lie 6.3 standard errors apart" in str(found[0])
    assert (weak.decides, weak.why.code) == (False, "separates-too-little")


def paces(found):
    return [each.drive["frequency"] for each in found]


def test_the_second_drive_is_for_those_that_the_first_leaves_alike():
    # The first tells a from b and c by ten errors, the second by nine, the third c by three.
    level = [[10.0, 9.0, 3.0], [0.0, 0.0, 3.0], [0.0, 0.0, 0.0]]
    found = chosen(level, count=2)
    assert paces(found) == [30.0, 60.0]
    assert "separates b from c" in found[1].why.text
    # Where a is named, b and c need not be told apart.
    assert paces(chosen(level, count=2, pairs=[(0, 1), (0, 2)])) == [30.0, 45.0]


def test_a_second_drive_that_pins_the_constants_is_worth_its_time():
    # All readings share a constant; the candidates differ most at the first and the third alone,
    # but in the same way.
    level = [[0.3, -0.2, 0.3], [-0.3, 0.2, -0.3]]
    found = chosen(level, noise=0.01, covariance=np.ones((2, 3, 3)), count=2)
    assert paces(found) == [30.0, 45.0]
    # Their difference is free of the constant, 1.0 with an error of 0.02^(1/2).
    assert sum(each.separation for each in found) == pytest.approx(1.0 / 0.02, rel=0.02)
    assert [each.decides for each in found] == [False, True]
    assert "beside the drives before it" in found[1].why.text
    # So the first is needed too, though alone it tells little.
    assert found[0].separation < asked.DECISIVE / 3


def separated(level, covariance, rows):
    """Pairs of candidates that are two standard errors apart by some drives together."""
    chi2 = asked.expected_chi2(level, covariance, np.ones(level.shape[1]), rows[:-1])
    return np.sum(np.triu(chi2[..., rows[-1]], 1) > asked.DECISIVE)


@pytest.mark.parametrize("seed", range(5))
def test_chosen_drives_are_hardly_worse_than_the_best_of_all_and_better_than_most(seed):
    random = np.random.default_rng(seed)
    level, slopes = 1.2 * random.standard_normal((6, 9)), random.standard_normal((1, 9))
    covariance = np.tile(slopes.T @ slopes, (6, 1, 1))
    found = [round((pace - 30.0) / 15.0) for pace in paces(chosen(level, covariance))]
    every = [separated(level, covariance, rows) for rows in itertools.combinations(range(9), 3)]
    told = separated(level, covariance, found)
    assert told >= 0.9 * max(every)
    assert told > np.quantile(every, 0.9)


def test_nothing_to_choose_from_gives_nothing():
    assert chosen([[0.0]]) == []
    assert chosen(np.zeros((2, 0))) == []


# ------------------------------------------------------------------------------------ proposals
def test_proposals_vary_the_middle_of_what_a_mode_was_given():
    measured = [condition(hold=1.3e-3, frequency=20.0)]
    measured += [condition(frequency=30.0 + k) for k in range(4)]
    measured += [condition("IPP", 2e-3)]
    holds = {"OPP": set(), "IPP": set()}
    for each in design.proposals(measured):
        holds[each["drive.mode"]].add(each["drive.hold"])
    assert holds == {"OPP": {7e-4, 1e-3, 1.3e-3}, "IPP": {1.4e-3, 2e-3, 2.6e-3}}
    assert design.proposals([]) == []


def test_what_was_measured_is_not_proposed_again():
    found = design.proposals([condition(frequency=33.3333)])
    # All of 2 * 2 * 3 * 3 * 3 * 2 but the measured one, whose frequency has more than three digits.
    assert len(found) == 215
    assert not any(
        each["drive.frequency"] == 33.3
        and all(each[key] == condition()[key] for key in design.CHOICES if key != "drive.frequency")
        for each in found
    )
    # A peak is not below the base.
    high = design.proposals([condition(**{"drive.base": 2e-3})])
    assert min(each["drive.peak"] for each in high) == 2e-3


# ------------------------------------------------------------------------------ what is said
@pytest.mark.parametrize("kind", ["named", "dominant", "pair"])
def test_a_safe_name_asks_for_nothing(kind):
    step, open_step = (
        asked.next_step(Verdict(k), ["warm coils"], 0.9812) for k in (kind, "ambiguous")
    )
    assert step.code == "name-safe"
    assert "safe: warm coils, with a probability of 0.981" in step.text
    assert open_step.code == "no-safe-name"
    assert asked.next_step(Verdict("none"), [], 0.0).code == "nothing-to-separate"
    left = asked.next_step(Verdict("none"), ["warm coils"], 0.3, ["direction"])
    assert (left.code, left.value) == ("cause-left", 0.3)
    assert "direction" in str(left)


def test_advice_is_given_where_it_tells_causes_apart():
    names = {"coil_heating": "warm coils", "surface_tilt": "a tilted stage", "edge_time": "an edge"}
    advice = Drives(measurement(drives().assign(velocity=1e-3)), ()).advice
    said = {each.code: each.text for each in advice(names, [])}
    assert set(said) == {"look-at-currents", "look-at-tilt"}
    assert said["look-at-currents"].endswith("This shows warm coils and an edge alone.")
    assert advice({"coil_heating": "warm coils", "edge_time": "an edge"}, []) == []
    assert [each.code for each in advice({}, chosen([[0.0], [1.0]]))] == ["none-separates"]


def test_drives_are_read_as_a_person_writes_them():
    rows = [{"frequency": 40.0}, {"drive.frequency": 55, "direction": "-x"}]
    expected = [{"drive.frequency": 40.0}, {"drive.frequency": 55, "drive.direction": "-x"}]
    assert drive_settings(rows, Scenario()) == expected
    written = pd.DataFrame({"frequency": [40], "mode": "ipp", "direction": " X "})
    written = written.assign(velocity=1e-3, trial=1, block="a", order=3, velocity_sd=0.1)
    expected = [{"drive.frequency": 40, "drive.mode": "IPP", "drive.direction": "+x"}]
    for given in (written, written.set_index("frequency")):
        assert drive_settings(given, Scenario()) == expected
