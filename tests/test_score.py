"""The score of the diagnosis: its rows, its parts, its table, and what has changed."""

import json

import numpy as np
import pytest
from score import __main__ as score
from score import rows
from score.problems import CLASSES, of_logged
from scores import answer

CHEAP = "clean, few repeats: clean 700[0-3]"
COULOMB, TWO = ["coulomb"], ["coulomb", "load"]


@pytest.mark.parametrize(
    ("said", "causes", "truth", "outcome", "credit"),
    [
        ("none", [], [], "rightly silent", 0.0),
        ("named", ["load"], [], "wrong name", 0.0),
        ("ambiguous", ["load", "zero"], [], "wrong set", 0.0),
        ("named", COULOMB, COULOMB, "right name", 1.0),
        ("dominant", ["load"], COULOMB, "wrong name", 0.0),
        ("pair", TWO, COULOMB, "wrong name", 0.0),
        ("pair", TWO, TWO, "right name", 1.0),
        ("named", COULOMB, TWO, "wrong name", 0.0),
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
    one = answer({"said": said, "causes": causes, "truth": truth, "listed": True})
    assert (one.outcome, one.credit) == (outcome, pytest.approx(credit))
    # What is hidden and not listed is no truth.
    other = answer({"said": said, "causes": causes, "truth": truth, "listed": False})
    assert other.outcome in ("rightly silent", "wrong set", "wrong name")


@pytest.mark.parametrize(
    ("more", "said", "causes", "outcome"),
    [
        ({"also": ["zero"]}, "pair", [*COULOMB, "zero"], "right name"),
        ({"also": ["zero"]}, "named", ["zero"], "silent"),
        ({"also": [], "far": ["load.force"]}, "named", COULOMB, "wrong name"),
        ({"alike": True}, "unexplained", [], "silent"),
        ({"alike": True, "truth": []}, "unexplained", [], "wrong set"),
        ({"alike": False, "truth": []}, "unexplained", [], "rightly silent"),
        ({"alike": True, "truth": []}, "named", ["load"], "rightly silent"),
    ],
)
def test_a_part_is_right_where_more_may_act_and_what_both_sides_have_is_no_change(
    more, said, causes, outcome
):
    row = {"said": said, "causes": causes, "truth": COULOMB, "listed": True, **more}
    assert answer(row).outcome == outcome


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("score") / "rows.jsonl"
    problems = rows.in_turns(1, 8, CHEAP)
    assert len(problems) == 3
    rows.ask(path, problems[:1], 5.0, jobs=1)
    with path.open("a") as file:
        file.write('{"class": "cl')  # of a call that was stopped
    rows.ask(path, problems, 5.0, jobs=2)
    return path


def test_a_part_goes_on_where_it_stopped(path, capsys):
    found = rows.read(path)
    assert sorted(row["problem"] for row in found) == sorted(
        each.name for each in rows.in_turns(1, 8, CHEAP)
    )
    assert {row["outcome"] for row in found} == {"rightly silent"}
    assert all(size["name"] == "slope" for row in found for size in row["sizes"])
    before = path.read_bytes()
    rows.ask(path, rows.in_turns(1, 8, CHEAP), 5.0, jobs=1)
    assert path.read_bytes() == before
    assert "0 rows, 0 problems left" in capsys.readouterr().out


def test_the_table_counts_rows_beside_what_is_asked(path):
    line = next(each for each in score.page(path).splitlines() if each.startswith("| clean "))
    assert "| 3 of 245 |" in line
    assert "| 3 of 3 | 0 of 3 |" in line
    assert line.endswith("| no name | - |")
    wrong = [{**row, "said": "named", "causes": ["bend"]} for row in rows.read(path)]
    assert score.table(wrong).splitlines()[2].endswith("| no |")


def test_what_has_changed_is_told_problem_by_problem(path, tmp_path, capsys, monkeypatch):
    found = rows.read(path)
    tampered = [{**found[0], "said": "ambiguous", "causes": ["bend", "wave"]}, *found[1:]]
    other = tmp_path / "other.jsonl"
    other.write_text("".join(json.dumps(row) + "\n" for row in tampered))
    for file, changed in ((path, 0), (other, 1)):
        monkeypatch.setattr("sys.argv", ["score", "--rows", str(path), "--against", str(file)])
        score.main()
        said = capsys.readouterr().out
        assert f"{changed} of 3 problems that both have differ" in said
        words = f"{found[0]['problem']}: ambiguous bend, wave (wrong set) → none"
        assert said.count(words) == changed
        assert ("| clean | 3 |" in said, "| 1 → 0 |" in said) == (True, bool(changed))


def test_every_problem_is_of_one_part_and_of_a_class_that_is_asked():
    parts = [[each.name for each in rows.in_turns(part, 8)] for part in range(1, 9)]
    every = [each for listed in CLASSES for each in listed()]
    assert sorted(name for part in parts for name in part) == sorted(each.name for each in every)
    assert max(map(len, parts)) - min(map(len, parts)) < 20
    asked = score.groups([{"class": each.group} for each in every])
    assert set(asked) == set(score.ASKED)
    for name, own in asked.items():
        assert len(own) == score.ASKED[name].get("sets", len(own)), name


def test_rows_of_a_faster_logger_end_with_its_readings():
    plain, *others = (each for each in of_logged() if ", joint, " in each.name)
    first = plain.asked().diagnosed.args[0]
    for each in others[:5]:
        log = each.asked().diagnosed.args[0]
        n = int(each.name.split()[-1])
        np.testing.assert_allclose(log.t[::n], first.t, atol=1e-12)
        assert (log.y[::n] == first.y).all()
