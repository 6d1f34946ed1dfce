"""Golden verdicts: a few problems are answered as before, and a change of each kind is seen."""

import math

import golden
import pytest
from problems import PROBLEMS, QUICK


@pytest.fixture(scope="module")
def stored():
    return golden.stored()


@pytest.mark.parametrize("name", QUICK)
def test_a_problem_is_answered_as_before(name, stored):
    now = golden.thinned(golden.numbers(name))
    assert list(golden.differences(stored[name], now, exact=False)) == []


def test_each_problem_has_a_stored_answer(stored):
    assert list(stored) == list(PROBLEMS)
    assert len(stored) >= 120
    assert len(set(QUICK)) == 14
    assert not [name for name, each in stored.items() if "refused" in each]


def entry(value, low, sd):
    return {"size": {"value": value, "low": low, "sd": sd, "unit": "m"}}


# What was said, what another machine may say instead, and what is another answer.
PAIRS = {
    "probability": ({"probabilities": {"wave": 0.40}}, {"probabilities": {"wave": 0.41}},
                    {"probabilities": {"wave": 0.45}}),
    "evidence": ({"log_evidence": -3.1}, {"log_evidence": -3.12}, {"log_evidence": -3.4}),
    "size by its error": (entry(1.0, 0.8, 0.1), entry(1.003, 0.803, 0.1), entry(1.0, 0.85, 0.1)),
    "error": (entry(1.0, 0.8, 0.1), entry(1.0, 0.8, 0.101), entry(1.0, 0.8, 0.11)),
    "words": ({"text": "near 1.23 mm"}, {"text": "near 1.24 mm"}, {"text": "near 1.24 m"}),
    "number in words": ({"text": "p = 0.52"}, {"text": "p = 0.53"}, {"text": "p = 0.62"}),
    "count in words": ({"text": "3 of 20"}, {"text": "3 of 20"}, {"text": "4 of 20"}),
    "count": ({"readings": 200}, {"readings": 200}, {"readings": 201}),
    "NaN": ({"share": math.nan}, {"share": math.nan}, {"share": 0.1}),
    "infinity": ({"chi2": math.inf}, {"chi2": math.inf}, {"chi2": 1e300}),
    "nothing": ({"share": None}, {"share": None}, {"share": 0.0}),
    "length": ({"reasons": ["a"]}, {"reasons": ["a"]}, {"reasons": ["a", "b"]}),
    "key": ({"a": 1}, {"a": 1}, {"a": 1, "b": 2}),
    "place": ({"misfit": [{"where": "x 1"}]}, {"misfit": [{"where": "x 2"}]},
              {"misfit": [{"share": 0.4}]}),
    "order": ({"members": ["a", "b"]}, {"members": ["a", "b"]}, {"members": ["b", "a"]}),
}  # fmt: skip


@pytest.mark.parametrize(("before", "alike", "other"), PAIRS.values(), ids=PAIRS)
def test_a_difference_is_seen_beyond_the_tolerance_of_its_kind(before, alike, other):
    assert list(golden.differences(before, alike, exact=False)) == []
    assert any(golden.differences(before, other, exact=False))
    # To the last bit only the same is alike.
    assert any(golden.differences(before, alike, exact=True)) is (repr(before) != repr(alike))
