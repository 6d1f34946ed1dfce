"""Counts of the rules of the diagnosis: each is there, and answers change without one."""

import pytest
import rules
from score import rows

from stickslip.diagnosis.decision.verdict import Verdict


@pytest.mark.parametrize("of", [rules.of_decision, rules.of_search])
def test_each_rule_is_of_the_package_and_comes_back(of):
    for name, patches in of().items():
        before = [vars(where)[key] for where, key, _ in patches]
        with rules.patched(patches):
            now = [vars(where)[key] for where, key, _ in patches]
        assert patches, name
        assert all(one is not other and one != other
                   for one, other in zip(before, now, strict=True)), name  # fmt: skip
        assert [vars(where)[key] for where, key, _ in patches] == before


def test_numbers_of_the_decision_are_moved_both_ways_for_each_user():
    moved = dict(rules.numbers())
    assert [moved[f"`SURE` 0.95 → {each}"][0][2] for each in ("0.925", "0.967")] == [0.925, 0.967]
    users = [each[0].__name__.rpartition(".")[2] for each in moved["`SURE` 0.95 → 0.925"]]
    assert users == ["verdict", "posterior"]
    assert moved["`SECOND` 0.1 → 0.15"] == [(rules.verdict, "SECOND", 0.15)]


def test_a_problem_that_was_kept_is_decided_without_each_rule(tmp_path, monkeypatch):
    monkeypatch.setattr(rows, "KEPT", tmp_path)
    problems = rows.in_turns(1, 8, "own, listed, few repeats")
    found = (rows.row_of(each, keep=True) for each in problems)
    row = next(each for each in found if each["outcome"] == "right name")
    path = next(each for each in tmp_path.rglob("*.pickle") if each.stem == row["problem"])
    silent = [(rules.verdict, "_claimed", lambda *_: Verdict("none"))]
    every = {"silent": silent, "idle": [(rules.verdict, "CALM", 0.0)]}
    monkeypatch.setattr(rules, "of_decision", lambda: every)
    name, said = rules.decided(path)
    assert (name, said[""], said["idle"]) == (row["problem"], said["idle"], said[""])
    assert (said[""][:2], said["silent"]) == (("right name", row["said"]), ("silent", "none", []))
    count = rules.counted({name: said[""]}, {name: said["silent"]})
    assert (count["worse"], count["better"], count["of"]) == ([name], [], 1)
