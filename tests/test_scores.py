"""How answers are scored, which seeds are used, and that judged rows are of free seeds."""

from itertools import combinations, product

import numpy as np
import pytest
from blind import seeds
from score.problems import drawn
from score.rows import HERE, ask, read
from scores import Answer, answer, interval

COULOMB, TWO = ["coulomb"], ["coulomb", "load"]


@pytest.mark.parametrize(
    ("said", "causes", "truth", "outcome", "credit"),
    [
        ("none", [], [], "rightly silent", 0.0),
        ("unexplained", [], [], "rightly silent", 0.0),
        ("named", ["load"], [], "wrong name", 0.0),
        ("ambiguous", ["load", "zero"], [], "wrong set", 0.0),
        ("named", COULOMB, COULOMB, "right name", 1.0),
        ("dominant", COULOMB, COULOMB, "right name", 1.0),
        ("named", ["load"], COULOMB, "wrong name", 0.0),
        ("pair", TWO, COULOMB, "wrong name", 0.5),
        ("pair", TWO, TWO, "right name", 1.0),
        ("named", COULOMB, TWO, "wrong name", 0.0),
        ("ambiguous", TWO, COULOMB, "right set", 0.5),
        ("ambiguous", [*TWO, "zero"], TWO, "right set", 2 / 3),
        ("ambiguous", [*TWO, "zero", "late"], COULOMB, "large set", 0.25),
        ("ambiguous", ["zero", "load"], COULOMB, "wrong set", 0.0),
        # A problem of the data is an answer if it tells a unit.
        ("data-problem", ["unit of time"], ["unit of time"], "right name", 1.0),
        ("data-problem", [], ["unit of time"], "silent", 0.0),
        # A leader of what stays unexplained is no answer.
        ("unexplained", COULOMB, COULOMB, "silent", 0.0),
    ],
)
def test_an_answer_is_worth(said, causes, truth, outcome, credit):
    one = Answer(said, causes, truth)
    assert (one.outcome, one.credit) == (outcome, pytest.approx(credit))


def utility(said, truth, components):
    """Utility of DXC 2026: mean 1 - n (N + 1) / f (n + 1) - m (f - N + 1) / f (m + 1) of pairs.

    n causes are said too many and m too few, of N that are said and f components.
    """
    found = []
    for one, true in product(said, truth):
        n, m, size = len(one - true), len(true - one), len(one)
        more, less = n * (size + 1) / (n + 1), m * (components - size + 1) / (m + 1)
        found.append(1.0 - (more + less) / components)
    return np.mean(found)


@pytest.mark.parametrize("causes", ["a", "b", "ab", "abc", "bc"])
def test_the_credit_is_the_utility_of_the_competition_with_silence_at_nought(causes):
    said, truth = ([{each} for each in names] for names in (causes, "a"))
    best, silent, found = (utility(each, truth, 1e9) for each in (truth, [set()], said))
    one = Answer("ambiguous", causes, "a")
    expected = 0.0 if "a" not in causes else (found - silent) / (best - silent)
    assert one.credit == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(
    ("said", "causes", "also", "outcome"),
    [
        ("named", COULOMB, ["zero"], "right name"),
        ("pair", [*COULOMB, "zero"], ["zero"], "right name"),
        ("named", ["zero"], ["zero"], "silent"),
        ("named", ["late"], ["zero"], "wrong name"),
        ("ambiguous", [*COULOMB, "late"], [], "right set"),
        ("ambiguous", ["late", "zero"], ["zero"], "wrong set"),
    ],
)
def test_a_part_of_what_acts_is_right_where_others_may_act(said, causes, also, outcome):
    row = {"said": said, "causes": causes, "truth": TWO, "listed": True, "also": also}
    assert answer(row).outcome == outcome
    # A size that is far from the known one is wrong.
    if outcome == "right name":
        assert answer({**row, "far": ["coulomb"[:3]]}).outcome == "wrong name"


@pytest.mark.parametrize(
    ("said", "causes", "truth", "alike", "outcome"),
    [
        ("named", ["load[after]"], ["load[after]"], True, "right name"),
        ("named", ["load"], [], True, "rightly silent"),
        ("unexplained", [], [], True, "wrong set"),
        ("unexplained", [], [], False, "rightly silent"),
        ("ambiguous", ["load", "zero[before]"], [], False, "wrong set"),
    ],
)
def test_what_both_sides_have_is_no_difference(said, causes, truth, alike, outcome):
    row = {"said": said, "causes": causes, "truth": truth, "listed": True, "alike": alike}
    assert answer(row).outcome == outcome


def test_shares_come_with_the_interval_of_wilson():
    # Its ends are the shares p of which the count is 1.96 standard deviations away.
    for count, total in ((0, 20), (3, 20), (20, 20)):
        ends = interval(count, total)
        assert (ends[0] == 0.0, ends[1] == 1.0) == (count == 0, count == total)
        for end in ends:
            if 0.0 < end < 1.0:
                away = (count / total - end) / np.sqrt(end * (1.0 - end) / total)
                assert abs(away) == pytest.approx(1.959964)


def test_every_judged_row_is_of_a_range_that_is_listed():
    rows, judged = [row for row in read(HERE / "earlier.jsonl") if "seed" in row], set()
    assert len({row["problem"] for row in rows}) == len(rows) > 0
    for row in rows:
        mine = seeds.of(row["study"], row["seed"])
        assert mine.purpose == "judged", (row["study"], row["seed"])
        judged |= {(mine, row["engine"]["commit"])}
    # What is said to have judged a range is the commit of rows that are stored.
    for mine in {each for each, _ in judged if each.commit}:
        assert (mine, mine.commit) in judged


def test_no_two_ranges_of_a_study_overlap():
    every = seeds.ranges()
    assert {each.purpose for each in every} == {"judged", "tried", "tests"}
    for one, other in combinations(every, 2):
        # Studies draw by themselves: a seed of two of them is no same data.
        apart = one.seeds.stop <= other.first or other.seeds.stop <= one.first
        assert apart or one.study != other.study, (one, other)


def test_seeds_that_were_judged_are_refused(tmp_path):
    closed = next(each for each in seeds.ranges("own") if each.closed)
    never = max(each.seeds.stop for each in seeds.ranges("own"))
    for first, said in ((closed.first, f"judged at {closed.commit}"), (never, "in no range")):
        with pytest.raises(SystemExit, match=said):
            ask(tmp_path / "rows.jsonl", [drawn("own", "own", first, "", dict)], 1.0)
