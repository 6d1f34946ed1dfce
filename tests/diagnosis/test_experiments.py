"""Which experiments tell candidates apart, and tables of them."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import multivariate_normal

from stickslip import Scenario, ScenarioError
from stickslip.diagnosis.decision.experiments import (
    CHOICES,
    DECISIVE,
    advice,
    choose,
    drive_settings,
    expected_chi2,
    next_step,
    prediction_table,
    proposals,
    setting_columns,
    trial_table,
    worth_measuring,
)

PAIR = [(0, 1)]


def condition(mode="OPP", hold=1e-3, frequency=30.0, **more):
    return {
        "drive.mode": mode, "drive.direction": "+x", "drive.edge": "rise", "drive.base": 0.0,
        "drive.peak": 2.5e-3, "drive.hold": hold, "drive.frequency": frequency, **more,
    }  # fmt: skip


def diagonal(variance):
    return np.stack([np.diag(row) for row in np.asarray(variance, dtype=float)])


# ---------------------------------------------------------------------------------- separation
def test_the_chi_square_is_the_evidence_that_a_reading_is_expected_to_bring():
    # For errors of one size, twice the mean log-evidence for the truth is the squared gap.
    level, noise = np.array([[1.0], [1.6]]), np.array([0.04])
    covariance = diagonal([[0.05], [0.05]])
    (chi2,) = expected_chi2(level, covariance, noise, PAIR)[:, 0]
    assert chi2 == pytest.approx(0.6**2 / 0.09)
    y = np.random.default_rng(1).normal(1.0, 0.3, 200_000)
    lead = multivariate_normal(1.0, 0.09).logpdf(y) - multivariate_normal(1.6, 0.09).logpdf(y)
    assert chi2 == pytest.approx(2.0 * np.mean(lead), rel=0.02)
    # A candidate that leaves much open cannot be told from another by what it allows.
    covariance[1] = 1.0
    assert expected_chi2(level, covariance, noise, PAIR)[0, 0] == pytest.approx(0.36 / 1.04)


def test_what_is_uncertain_in_both_cancels_between_two_drives():
    # A constant moves all readings by 1; the candidates lie 0.2 to either side of it.
    level = np.array([[0.1, -0.1, 0.1], [-0.1, 0.1, -0.1]])
    covariance = np.ones((2, 3, 3))
    noise = np.full(3, 0.01)
    alone = expected_chi2(level, covariance, noise, PAIR)[0]
    assert alone == pytest.approx(np.full(3, 0.04 / 1.01))
    together = expected_chi2(level, covariance, noise, PAIR, beside=[0])[0]
    # The difference of the first two is free of the constant: 0.4 with an error of 0.02^(1/2).
    assert together[1] == pytest.approx(0.4**2 / 0.02, rel=1e-3)
    assert together[0] == pytest.approx(alone[0])
    # The third, like the first, only halves the noise.
    assert together[2] < 1.01 * alone[0]


def test_what_a_candidate_cannot_compute_is_no_proposal():
    level = np.array([[0.0, 1.0, 0.0], [1.0, np.nan, 1.0]])
    covariance = diagonal(np.zeros((2, 3)))
    covariance[0, 2, 2] = np.nan
    chi2 = expected_chi2(level, covariance, np.ones(3), PAIR)
    assert chi2.tolist() == [[1.0, 0.0, 0.0]]


# --------------------------------------------------------------------------------------- choice
def drives(*settings):
    return [condition(frequency=f, **{"drive.direction": d}) for f, d in settings]


def test_the_best_of_each_kind_is_chosen_and_none_is_mirrored():
    given = drives((30.0, "+x"), (30.0, "+x"), (30.0, "-x"), (45.0, "+x"), (60.0, "+x"))
    given[1] = {**given[1], "drive.hold": 2e-3}
    level = 1e-3 * np.array([[3.0, 2.0, -3.0, 1.0, 0.0], [1.0, 1.0, -1.0, 0.5, 0.0]])
    found = choose(given, ["a", "b"], level, diagonal(np.zeros((2, 5))), np.full(5, 1e-7), count=5)
    # The second is of the first one's kind, the third its mirror image, the last tells nothing.
    assert [each.drive["frequency"] for each in found] == [30.0, 45.0]
    assert found[0].drive["hold"] == 1e-3
    assert found[0].separation == pytest.approx(2e-3**2 / 1e-7)
    assert found[0].decides
    assert found[0].predictions["b"] == {"velocity": 1e-3, "sd": 0.0}
    assert found[0].why.code == "separates"
    assert str(found[0]).startswith("mode OPP, direction +x, frequency 30 Hz, peak 2.5 mT, hold 1 ")
    assert "from b: with 3 trials their predictions lie 6.3 standard errors apart" in str(found[0])
    weak = choose(given, ["a", "b"], level, diagonal(np.full((2, 5), 1e-5)), np.full(5, 1e-7))[0]
    assert (weak.decides, weak.why.code) == (False, "separates-too-little")


def test_the_second_drive_is_for_those_that_the_first_leaves_alike():
    given = drives((30.0, "+x"), (45.0, "+x"), (60.0, "+x"))
    # The first tells a from b and c by ten errors, the second by nine, the third b from c by three.
    level = np.array([[10.0, 9.0, 1.5], [0.0, 0.0, 3.0], [0.0, 0.0, 0.0]])
    covariance = diagonal(np.zeros((3, 3)))
    found = choose(given, ["a", "b", "c"], level, covariance, np.ones(3), count=2)
    assert [each.drive["frequency"] for each in found] == [30.0, 60.0]
    assert "separates b from c" in found[1].why.text
    # Where a is named, b and c need not be told apart.
    named = choose(given, ["a", "b", "c"], level, covariance, np.ones(3), count=2,
                   pairs=[(0, 1), (0, 2)])  # fmt: skip
    assert [each.drive["frequency"] for each in named] == [30.0, 45.0]


def test_a_second_drive_that_pins_the_constants_is_worth_its_time():
    given = drives((30.0, "+x"), (45.0, "+x"), (60.0, "+x"))
    # All readings share a constant; the candidates differ most at the first and the third alone,
    # but in the same way.
    level = np.array([[0.3, -0.2, 0.3], [-0.3, 0.2, -0.3]])
    covariance = np.ones((2, 3, 3))
    found = choose(given, ["a", "b"], level, covariance, np.full(3, 0.01), count=2)
    assert [each.drive["frequency"] for each in found] == [30.0, 45.0]
    # Their difference is free of the constant, 1.0 with an error of 0.02^(1/2).
    assert sum(each.separation for each in found) == pytest.approx(1.0 / 0.02, rel=0.02)
    assert [each.decides for each in found] == [False, True]
    assert "beside the drives before it" in found[1].why.text
    # So the first is needed too, though alone it tells little.
    assert found[0].separation < DECISIVE / 3
    assert worth_measuring(next_step("ambiguous", ["a", "b"], 0.5), found) == found


def test_nothing_to_choose_from_gives_nothing():
    empty = np.zeros((1, 1))
    assert choose(drives((30.0, "+x")), ["a"], empty, empty[None], np.ones(1)) == []
    none = np.zeros((2, 0))
    assert choose([], ["a", "b"], none, np.zeros((2, 0, 0)), np.ones(0)) == []


# ------------------------------------------------------------------------------------ proposals
def test_proposals_vary_the_middle_of_what_a_mode_was_given():
    measured = [condition(hold=1.3e-3, frequency=20.0)]
    measured += [condition(frequency=30.0 + k) for k in range(4)]
    measured += [condition("IPP", 2e-3)]
    holds = {"OPP": set(), "IPP": set()}
    for each in proposals(measured):
        holds[each["drive.mode"]].add(each["drive.hold"])
    assert holds == {"OPP": {7e-4, 1e-3, 1.3e-3}, "IPP": {1.4e-3, 2e-3, 2.6e-3}}
    assert proposals([]) == []


def test_what_was_measured_is_not_proposed_again():
    found = proposals([condition(frequency=33.3333)])
    # All of 2 * 2 * 3 * 3 * 3 * 2 but the measured one, whose frequency has more than three digits.
    assert len(found) == 215
    assert not any(
        each["drive.frequency"] == 33.3
        and all(each[key] == condition()[key] for key in CHOICES if key != "drive.frequency")
        for each in found
    )
    # A peak is not below the base.
    high = proposals([condition(**{"drive.base": 2e-3})])
    assert min(each["drive.peak"] for each in high) == 2e-3


# ------------------------------------------------------------------------------ what is said
@pytest.mark.parametrize("kind", ["named", "dominant", "pair"])
def test_a_safe_name_asks_for_nothing(kind):
    step = next_step(kind, ["warm coils"], 0.9812)
    assert step.code == "name-safe"
    assert "safe: warm coils, with a probability of 0.981" in step.text
    level, covariance = np.array([[0.0], [5.0]]), np.zeros((2, 1, 1))
    found = choose(drives((30.0, "+x")), ["a", "b"], level, covariance, np.ones(1))
    assert worth_measuring(step, found) == []
    assert worth_measuring(next_step("none", [], 0.0), found) == []
    assert worth_measuring(next_step("ambiguous", ["a", "b"], 0.5), found) == found
    # Three in a row would not be enough.
    poor = choose(drives((30.0, "+x")), ["a", "b"], 0.2 * level, covariance, np.ones(1))
    assert poor[0].separation < DECISIVE / 3
    assert worth_measuring(next_step("ambiguous", ["a", "b"], 0.5), poor) == []


def test_advice_is_given_where_it_tells_causes_apart():
    names = {"coil_heating": "warm coils", "surface_tilt": "a tilted stage", "edge_time": "an edge"}
    said = {each.code: each.text for each in advice(names, [])}
    assert set(said) == {"look-at-currents", "look-at-tilt"}
    assert said["look-at-currents"].endswith(
        "this shows warm coils and an edge, and nothing of a tilted stage."
    )
    assert advice({"coil_heating": "warm coils", "edge_time": "an edge"}, []) == []
    level, covariance = np.array([[0.0], [1.0]]), np.zeros((2, 1, 1))
    poor = choose(drives((30.0, "+x")), ["a", "b"], level, covariance, np.ones(1))
    assert [each.code for each in advice({}, poor)] == ["none-separates"]


# --------------------------------------------------------------------------------------- tables
def test_a_table_has_a_row_for_each_trial_and_each_prediction():
    level, covariance = np.array([[0.0, 0.0], [5.0, 4.0]]), diagonal([[0.0, 0.0], [0.04, 0.04]])
    given = drives((30.0, "+x"), (45.0, "+x"))
    given = [{**each, "drive.ramp": 0.01} for each in given]
    found = choose(given, ["a", "b"], level, covariance, np.ones(2))
    columns = setting_columns(given, Scenario())
    varied = [key.removeprefix("drive.") for key in CHOICES]
    assert columns[:6] == varied
    assert "ramp" in columns
    assert "coils" not in columns
    table = trial_table(found, columns, 2, block="after-7")
    assert list(table) == [*columns, "trial", "block", "velocity"]
    assert table["frequency"].tolist() == [30.0, 30.0, 45.0, 45.0]
    assert table["trial"].tolist() == [1, 2, 1, 2]
    assert table["velocity"].isna().all()
    predicted = prediction_table(found, columns)
    assert predicted["experiment"].tolist() == [1, 1, 2, 2]
    assert predicted["candidate"].tolist() == ["a", "b"] * 2
    assert predicted["velocity"].tolist() == [0.0, 5.0, 0.0, 4.0]
    assert predicted["sd"].tolist() == [0.0, 0.2, 0.0, 0.2]
    # What is filled in is read again as it is.
    assert drive_settings(table, Scenario())[2]["drive.frequency"] == 45.0
    assert list(trial_table([], columns)) == [*columns, "trial", "velocity"]


def test_drives_are_read_as_a_person_writes_them():
    rows = [{"frequency": 40.0}, {"drive.frequency": 55, "direction": "-x"}]
    assert drive_settings(rows, Scenario()) == [
        {"drive.frequency": 40.0},
        {"drive.frequency": 55, "drive.direction": "-x"},
    ]
    written = pd.DataFrame({"frequency": [40], "mode": "ipp", "direction": " X "})
    written = written.assign(velocity=1e-3, trial=1, block="a", order=3, velocity_sd=0.1)
    expected = [{"drive.frequency": 40, "drive.mode": "IPP", "drive.direction": "+x"}]
    assert drive_settings(written, Scenario()) == expected
    assert drive_settings(written.set_index("frequency"), Scenario()) == [
        {**expected[0], "drive.frequency": 40}
    ]


@pytest.mark.parametrize(
    ("bad", "said"),
    [
        ([{"frequencies": 40.0}], 'row 0: .*did you mean "drive.frequency"'),
        ([{"robot.length": 1e-3}], "row 0: drive.robot.length"),
        ([{"frequency": 40.0}, {"frequency": -1.0}], "row 1: drive.frequency = -1.0: allowed is"),
        ([{"frequency": None}], "row 0: drive.frequency = None: allowed is"),
        ({"frequency": 40.0}, "allowed is a DataFrame or a list of dicts"),
        ("frequency", "allowed is a DataFrame or a list of dicts"),
        (None, "allowed is a DataFrame or a list of dicts"),
        ([40.0], "allowed is a DataFrame or a list of dicts"),
        ([], "there is no row"),
        (pd.DataFrame({"frequency": []}), "there is no row"),
        (pd.DataFrame({"frequency": [np.nan]}, index=["a"]), "row a: drive.frequency = nan"),
    ],
)
def test_what_is_no_drive_is_refused_in_one_line(bad, said):
    with pytest.raises(ScenarioError, match=said) as error:
        drive_settings(bad, Scenario())
    assert "\n" not in str(error.value)
