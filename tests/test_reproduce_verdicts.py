"""From curves to criteria to verdicts, on made-up surveys where the answer is known."""

import dataclasses

import numpy as np
import pytest

from stickslip.reproduction import lines
from stickslip.reproduction.criteria import CRITERIA, all_margins
from stickslip.reproduction.field_checks import FieldChecks
from stickslip.reproduction.points import SCANS
from stickslip.reproduction.settings import MODES, Setting
from stickslip.reproduction.statements import (
    deciding_factors,
    judge,
    of_number,
    reference_pair,
    verdict,
)
from stickslip.reproduction.survey import SCANNED, Behaviour, all_pairs

X = {name: np.array(scan.values) for name, scan in SCANS.items()}

# One setting of each mode that does all that the paper says, m/s, and the same upside down.
GOOD = {
    ("IPP", "frequency"): 40e-6 * X["frequency"] / (1 + (X["frequency"] / 150) ** 2),
    ("OPP", "frequency"): 40e-6 * X["frequency"] / (1 + (X["frequency"] / 150) ** 2),
    ("IPP", "friction"): np.full_like(X["friction"], 2e-3),
    ("OPP", "friction"): np.interp(X["friction"], [0.1, 0.2, 1.0, 1.2], [5e-3, 2e-3, 2e-3, 1e-3]),
    ("IPP", "adhesion"): 2e-3 - 1e3 * X["adhesion"],
    ("OPP", "adhesion"): 3e-3 - 4e3 * X["adhesion"],
    ("IPP", "linear"): 2e-3 / (1 + X["linear"] / 3e-5),
    ("OPP", "linear"): 3e-3 / (1 + X["linear"] / 3e-5),
    ("IPP", "rotational"): 2e-3 / (1 + X["rotational"] / 1e-14),
    ("OPP", "rotational"): 3e-3 / (1 + X["rotational"] / 1e-14),
    ("IPP", "field"): 0.6 * X["field"] - 20.0 * X["field"] ** 2,
    ("OPP", "field"): 0.6 * X["field"],
}
BAD = {
    ("IPP", "frequency"): 1e-8 * X["frequency"] ** 3,
    ("OPP", "frequency"): 1e-8 * X["frequency"] ** 3,
    ("IPP", "friction"): np.interp(X["friction"], [0.1, 0.2, 1.0, 1.2], [9e-3, 2e-3, 2e-3, 1e-4]),
    ("OPP", "friction"): np.interp(X["friction"], [0.1, 0.2, 1.0, 1.2], [1e-4, 9e-3, 9e-3, 3e-3]),
    ("IPP", "adhesion"): 9e-3 - 1e4 * X["adhesion"],
    ("OPP", "adhesion"): np.full_like(X["adhesion"], 1e-3),
    ("IPP", "linear"): np.linspace(1e-3, 2e-3, len(X["linear"])),
    ("OPP", "linear"): np.linspace(1e-3, 2e-3, len(X["linear"])),
    ("IPP", "rotational"): np.full_like(X["rotational"], 1e-3),
    ("OPP", "rotational"): 3e-3 / (1 + X["rotational"] / 1e-16),
    ("IPP", "field"): 1e5 * X["field"] ** 4,
    ("OPP", "field"): 5e-3 - 0.6 * X["field"],
}


def strokes(up, down, normal_up, normal_down, tilt):
    share_up = abs(up) / (abs(up) + abs(down))
    names = ("slip_up", "slip_down", "normal_up", "normal_down", "tilt", "share_up")
    return dict(zip(names, (up, down, normal_up, normal_down, tilt, share_up), strict=True))


GOOD_STROKES = {
    "IPP": strokes(1e-6, 99e-6, 1.1, 0.8, 0.9),
    "OPP": strokes(99e-6, 1e-6, 1.3, 0.9, 0.4),
}
BAD_STROKES = {
    "IPP": strokes(99e-6, 1e-6, 1.1, 1.2, 0.3),
    "OPP": strokes(1e-6, 99e-6, 0.9, 0.9, 0.9),
}


def made_up(good=(True, False)):
    """A survey with a setting of each mode for each entry of `good`."""
    return {mode: behaviour(mode, good) for mode in MODES}


def behaviour(mode, good):
    count = len(good)
    settings = [Setting(mode, "rise" if flag else "fall", "down", 1e-3, 2e-3) for flag in good]
    still_tilts = {"IPP": (1.0, 0.2), "OPP": (0.5, 1.2)}[mode]
    by_stroke = [(GOOD_STROKES if flag else BAD_STROKES)[mode] for flag in good]
    return Behaviour(
        settings=np.array(settings, dtype=object),
        **{
            name: np.array([(GOOD if flag else BAD)[mode, name] for flag in good])
            for name in SCANNED
        },
        painleve=np.zeros((count, len(X["friction"]), 1), dtype=int),
        tilt_low=np.full(count, 0.1),
        tilt_high=np.full(count, 1.0),
        still_tilt=np.array([still_tilts[0 if flag else 1] for flag in good]),
        still_velocity=np.array([1e-9 if flag else 1e-3 for flag in good]),
        **{name: np.array([each[name] for each in by_stroke]) for name in by_stroke[0]},
    )


@pytest.mark.parametrize("criterion", CRITERIA, ids=lambda criterion: criterion.name)
def test_a_criterion_tells_what_the_paper_says_from_its_opposite(criterion):
    pairs = all_pairs(made_up())
    holds = all_margins(pairs)[CRITERIA.index(criterion)] >= 0.0
    assert holds.shape == (2, 2)
    assert holds[0, 0]
    assert not holds[1, 1]
    for place in (0, 1):
        words = criterion.numbers(pairs.at(np.s_[:, place, place]))
        assert words
        assert "\n" not in words


def test_criteria_are_those_of_the_statements_that_depend_on_settings():
    assert [each.name for each in CRITERIA] == [f"S{number}" for number in range(1, 15)]


def test_the_slip_of_a_stroke_must_go_forwards():
    found = made_up()
    assert all_margins(all_pairs(found))[0, 0, 0] >= 0.0
    found["IPP"].slip_down[0] = -99e-6
    assert all_margins(all_pairs(found))[0, 0, 0] < 0.0


def test_a_setting_works_that_walks_forwards_between_flat_and_upright():
    found = made_up((True, True, True, True))
    found["IPP"].frequency[1] *= -1.0
    found["IPP"].tilt_high[2] = 1.6
    found["IPP"].tilt_low[3] = -0.1
    assert found["IPP"].works.tolist() == [True, False, False, False]
    assert found["OPP"].works.all()


def test_the_reference_has_the_motion_first_then_the_most_then_the_likeliest_speed():
    found = made_up((False, True, True))
    none = np.zeros((3, 3), dtype=bool)
    motion, trends = none.copy(), none.copy()
    # The motion of (1, 1) outweighs any number of trends of (2, 2).
    motion[1, 1] = True
    trends[2, 2] = True
    assert reference_pair(all_pairs(found), np.array([motion] * 4 + [trends] * 10)) == (1, 1)
    # As good twice: the one nearer to 0.88 mm/s.
    motion[2, 2] = True
    trends[1, 1] = True
    for mode in MODES:
        found[mode].frequency[1] = 5e-3
        found[mode].frequency[2] = 1e-3
    assert reference_pair(all_pairs(found), np.array([motion] * 4 + [trends] * 10)) == (2, 2)
    # What does not work is never chosen.
    found["IPP"].tilt_high[2] = 3.0
    assert reference_pair(all_pairs(found), np.array([motion] * 4 + [trends] * 10)) == (1, 1)
    found["IPP"].tilt_high[:] = 3.0
    with pytest.raises(ValueError, match="no setting"):
        reference_pair(all_pairs(found), np.array([motion] * 14))


ALL = np.ones((2, 2), dtype=bool)
FACTORS = {
    "IPP edge": ["rise", "fall"],
    "OPP edge": ["rise", "fall"],
    "OPP hold": ["1 mT", "1 mT"],
}


@pytest.mark.parametrize(
    ("holds", "word", "text"),
    [
        (ALL, "reproduced", "reproduced"),
        (~ALL, "not reproduced", "not reproduced"),
        (
            np.array([[True, True], [False, False]]),
            "depends",
            "depends on IPP edge (most often with rise: 100%)",
        ),
        (np.array([[True, False], [False, True]]), "depends", "depends on the settings together"),
        (np.array([[True], [True]]), "reproduced", "reproduced"),
    ],
)
def test_a_verdict_goes_by_the_share_of_working_pairs(holds, word, text):
    found = verdict(holds, ALL, FACTORS, (0, 0))
    assert (found.word, found.text) == (word, text)
    assert found.share == np.broadcast_to(holds, ALL.shape).mean()
    assert found.at_reference == bool(np.broadcast_to(holds, ALL.shape)[0, 0])


def test_settings_that_do_not_walk_are_not_counted():
    works = np.array([[True, False], [False, False]])
    holds = np.array([[True, False], [False, False]])
    assert verdict(holds, works, FACTORS, (0, 0)).share == 1.0
    nothing = verdict(holds, ~ALL, FACTORS, (0, 0))
    assert (nothing.word, nothing.share) == ("not reproduced", 0.0)


def test_the_most_informative_factors_come_first_and_at_most_two():
    levels = ["a", "a", "b", "b"]
    factors = {"IPP x": levels, "OPP y": levels, "OPP z": ["c", "d", "c", "d"]}
    holds = np.zeros((4, 4), dtype=bool)
    holds[2:] = True
    holds[0, 2:] = True
    works = np.ones((4, 4), dtype=bool)
    assert deciding_factors(holds, works, factors) == [
        "IPP x (most often with b: 100%)",
        "OPP y (most often with b: 75%)",
    ]


def test_a_number_is_reproduced_or_not():
    assert of_number(True).word == "reproduced"
    assert of_number(False, "not reproduced; but nearly").text == "not reproduced; but nearly"
    assert of_number(False).share is None


CHECKS = FieldChecks(10.5e-9, 240e-9, 0.149, 0.0, 240e-9, 0.01, 0.02, 0.02, 0.01)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, ["reproduced", "reproduced", "reproduced"]),
        ({"force_at_centre": 197e-9}, ["depends", "reproduced", "reproduced"]),
        ({"torque": 5e-9}, ["not reproduced", "reproduced", "reproduced"]),
        ({"winding_flat": 0.03}, ["reproduced", "not reproduced", "reproduced"]),
        ({"fringe": 0.12}, ["reproduced", "reproduced", "not reproduced"]),
    ],
)
def test_statements_on_the_field(changes, words):
    statements, _, _ = judge(made_up(), dataclasses.replace(CHECKS, **changes))
    assert [each.name for each in statements] == [f"S{number}" for number in range(1, 18)]
    assert [each.verdict.word for each in statements[14:]] == words


def test_fits():
    x = np.array([1.0, 2.0, 3.0, 4.0])
    y = np.array([2.0 * x, 2.0 * x + 1.0])
    line = lines.proportional(x, y)
    assert line.slope == pytest.approx([2.0, 2.0 + 10 / 30])
    assert line.explained[0] == pytest.approx(1.0)
    assert line.worst[0] == pytest.approx(0.0)
    assert line.worst[1] == pytest.approx(3.0 / (2.0 + 10 / 30) - 1.0)
    assert lines.straight(x, y).slope == pytest.approx([2.0, 2.0])
    assert lines.straight(x, y).explained == pytest.approx([1.0, 1.0])
    bent = np.array([[0.0, 2.0, 4.0, 5.0, 6.0]])
    assert lines.bend(np.arange(5.0), bent) == pytest.approx([0.5])


def test_crossing_is_between_points_in_the_logarithm():
    x, y = np.array([1.0, 10.0, 100.0]), np.array([1.0, 0.8, 0.0])
    assert lines.crossing(y, x, 0.9) == pytest.approx(10**0.5)
    assert lines.crossing(y, x, 0.4) == pytest.approx(10**1.5)
    assert np.isnan(lines.crossing(np.ones(3), x, 0.5))
    assert np.isnan(lines.crossing(np.zeros(3), x, 0.5))
