"""The record of the blind study: how a study is continued, and how its rows are counted."""

import fcntl
import json
import re
import sys
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip.diagnosis.data.velocity import VelocityTable
from stickslip.measurement import read_measurement

sys.path.append(str(Path(__file__).resolve().parents[1] / "bench"))

from blind import __main__ as command
from blind import case, frozen, rerun, stored
from blind import questions as asked
from blind.case import state
from blind.kinds import KINDS, STUDY
from blind.report import FAMILY_WORDS, misses, report, table
from blind.scoring import by_cause, calibration, counted, interval, judged, read
from blind.writing import KEYS

ROOT = Path(__file__).resolve().parents[1]
RECORD = ROOT / "bench" / "blind" / "record.jsonl"


def _row(kind, answer, said, verdict="named", seed=7, **more):
    hidden = {"strength": 30.0, "answer": answer, "effects": {}, **more}
    told = {"verdict": verdict, "cause": said, "probabilities": {"none": 1.0}, "gain": None}
    return {
        "answer": {"kind": kind, "seed": seed, **hidden},
        "said": {**told, "open_set": None, "parameters": {}},
        "gain": None, "reasons": [], "cpu_seconds": 1.0,
    }  # fmt: skip


def _counts(rows, **options):
    return {each["what"]: (each["count"], each["total"]) for each in judged(rows, **options)}


def test_an_interrupted_study_is_continued(tmp_path, monkeypatch, capsys):
    record = tmp_path / command.RECORD
    now = {"engine": "a", "data": "b", "commit": "c", "version": "d"}
    assert set(state()) == set(now)
    monkeypatch.setattr(command, "state", lambda: now)
    none, law = _row("none", [], None, "none"), _row("law", [], None, "unexplained", hook="x")
    # Of another engine, of another generator and of none that is known nothing is taken over;
    # another commit may have the same files.
    others = [{**now, "engine": "e"}, {**now, "data": "e"}, {}]
    rows = [{**_row("none", [], "x"), "state": each} for each in others]
    rows += [{**none, "state": {**now, "commit": "f"}}, {**law, "state": now}]
    kept = "".join(json.dumps(each) + "\n" for each in rows)
    record.write_text(kept + json.dumps(none)[:50])
    arguments = ["blind", "--first", "7", "--seeds", "1", "--kinds", "none;law", "--jobs", "1"]
    monkeypatch.setattr(sys, "argv", [*arguments, "--out", str(tmp_path)])
    command.main()
    # The row that was cut off is gone, the other one was not made again.
    assert record.read_text() == kept
    assert "| nothing | false alarm | 0 of 1 |" in capsys.readouterr().out
    with (tmp_path / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(SystemExit):
            command.main()
    assert "another study is at work there" in capsys.readouterr().err


def test_frozen_data_sets_are_set_beside_what_was_found():
    fits = [("a + b", 10.0), ("a", 12.0), ("none", 40.0)]
    old = {
        "hook": None, "verdict": "pair", "cause": ["a", "b"], "p_value": 0.1, "seed": 3,
        "candidates": [{"name": name, "chi2": chi2} for name, chi2 in fits],
    }  # fmt: skip

    def beside(kind, causes, truth):
        """Models none and a were fitted; their chi-square has the prior's part, 2 * 0.5^2."""
        at = {"x": np.array([0.5, 9.0]), "free": np.array([0]), "precision": np.array([[8.0]])}
        chi2 = {frozenset(): 38.0, frozenset("a"): 11.5}
        fits = {names: SimpleNamespace(**at, chi2=each) for names, each in chi2.items()}
        models = SimpleNamespace(get=lambda names: fits.get(frozenset(names)))
        findings = SimpleNamespace(models=models, test=SimpleNamespace(p_value=0.2))
        verdict = SimpleNamespace(kind=kind, causes=causes, share=0.9)
        result = SimpleNamespace(verdict=verdict, findings=findings)
        return rerun.beside(result, {**old, "kind": "single", "truth": truth})

    said, again = beside("named", ("a",), ["a"]), beside("pair", ("b", "a"), [])
    # 12 was found before and is 13.5 now; the pair that led was not fitted.
    assert said["chi2"] == {"none": [40.0, 40.0], "leader": [10.0, None], "truth": [12.0, 13.5]}
    assert again["chi2"]["truth"] == [40.0, 40.0]
    # Without a search there is nothing to compare.
    assert beside("none", (), ["a"])["chi2"] == {}
    rows = [{**said, "cpu_seconds": [8.0, 2.0]}, {**again, "cpu_seconds": [4.0, 4.0]}]
    text = rerun.summary(rows)
    for part in (
        "1 of 2 verdicts are those of before",
        "single 3 | a | pair a, b -> named a",
        "chi-square of the truth at most 1 higher: 1 of 2, 0 not fitted",
        "median 6.0 before, 3.0 now, median ratio 0.62",
    ):
        assert part in text


def test_kinds_of_a_family_are_counted_together():
    assert set(FAMILY_WORDS) == {each.family for each in KINDS.values()}
    rows = [_row("none", [], None, "none"), _row("none, film", [], None, "unexplained")]
    assert [each["total"] for each in judged(rows)] == [1, 1]
    assert _counts(rows, pooled=True) == {"false alarm": (1, 2)}


def test_data_sets_are_written_with_their_answers_apart(tmp_path, monkeypatch):
    arguments = ["blind", "--first", "2", "--seeds", "2", "--kinds", "none, fields"]
    monkeypatch.setattr(sys, "argv", [*arguments, "--write", str(tmp_path)])
    command.main()
    assert {path.name for path in tmp_path.iterdir()} == {"0000", "0001", "answers"}
    answer = json.loads((tmp_path / "answers" / "0001.json").read_text())
    assert (answer["kind"], answer["seed"]) == ("none, fields", 3)


def test_the_study_is_made_in_parts_and_its_answers_are_apart(tmp_path, monkeypatch):
    folder = tmp_path / "study"
    monkeypatch.setattr(frozen, "STUDY_SETS", folder / "sets.jsonl.xz")
    monkeypatch.setattr(frozen, "ANSWERS", folder / "answers.jsonl.xz")
    frozen.freeze(0.0, ["none, fields"])
    assert not frozen.STUDY_SETS.exists()
    wanted = [frozen.name_of("none, fields", STUDY + k) for k in range(3)]
    # What a stopped call had made is kept, but for a line that was cut off.
    (folder / "sets.jsonl.part").write_text(json.dumps({"name": "a", "files": {}}) + '\n{"n')
    frozen.freeze(10.0, ["none, fields"])
    stored = {each["name"]: each for each in frozen.sets(frozen.STUDY_SETS)}
    assert list(stored) == sorted(["a", *wanted])
    assert all(set(each) == {"name", "files"} for each in stored.values())
    answers = frozen.answers()
    assert [answers[name]["seed"] for name in wanted] == [STUDY, STUDY + 1, STUDY + 2]
    path = frozen.unpacked(stored[wanted[0]], tmp_path / "one")
    assert len(read_measurement(path).field) == 1
    made = frozen.STUDY_SETS.read_bytes()
    frozen.freeze(10.0, ["none, fields"])
    assert frozen.STUDY_SETS.read_bytes() == made
    assert {path.name for path in folder.iterdir()} == {"answers.jsonl.xz", "sets.jsonl.xz"}


SIX = ["restitution", "edge_time", "eddy_lag", "field_gain", "ambient_field", "angle_drag"]
UNLIKE, LIKE = {"cosine": 0.5, "hook": "friction_speed"}, {"cosine": 0.95, "hook": "friction_speed"}
CLAIMS = [
    # A dominant cause is a claim of its own.
    ("single", ["restitution"],
     [("restitution", "dominant", {}), ("edge_time", "dominant", {}), ("restitution", "named", {})],
     {"named": (1, 3), "right when named": (1, 1), "right when dominant": (1, 2)}),
    ("none, correlated strong", [], [("edge_time", "dominant", {})],
     {"false alarm": (1, 1), "named, a pair or dominant": (1, 1)}),
    # Sets by their size.
    ("weak", ["restitution"],
     [(SIX, "ambiguous", {}), ([*SIX, "sample_hold"], "ambiguous", {}),
      ("restitution", "named", {})],
     {"in the set when detected": (3, 3), "the same, in at most six causes": (2, 3),
      "sets of at most six causes": (1, 2)}),
    # What no cause lists, by how alike it is.
    ("unlisted, unlike", [],
     [("edge_time", "dominant", {**UNLIKE, "hook": None}), ("stribeck_friction", "named", UNLIKE),
      ("edge_time", "named", LIKE), ("edge_time", "dominant", {**LIKE, "hook": "drag_speed"})],
     {"unlike all causes: wrongly named": (0, 2), "unlike all causes: wrongly dominant": (1, 2),
      "like a cause: wrongly named": (1, 2), "like a cause: said to act like one": (1, 2)}),
    # Causes that cannot be as strong as asked for are not counted.
    ("single", ["restitution"], [("restitution", "named", {"strength": 2.0})], {}),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "answer", "said", "expected"), CLAIMS)
def test_claims_are_counted(kind, answer, said, expected):
    rows = [
        _row(kind, answer, causes, verdict, seed, **more)
        for seed, (causes, verdict, more) in enumerate(said)
    ]
    found = _counts(rows)
    assert {what: found.get(what) for what in expected} == expected
    assert bool(found) == bool(expected)
    if not expected:
        assert "Not counted: 1 data sets" in report(rows)


@pytest.mark.parametrize(
    ("beside", "said", "verdict", "right", "wrongly_named", "wrongly_dominant"),
    [
        ("smooth_error", "restitution", "named", 1, 0, 0),
        ("smooth_error", "restitution", "dominant", 1, 0, 0),
        ("smooth_error", "restitution", "ambiguous", 0, 0, 0),
        ("smooth_error", "edge_time", "named", 0, 1, 0),
        ("smooth_error", ["restitution", "edge_time"], "pair", 0, 1, 0),
        ("smooth_error", "edge_time", "dominant", 0, 0, 1),
        ("edge_time", ["restitution", "edge_time"], "pair", 1, 0, 0),
        ("edge_time", "edge_time", "dominant", 0, 0, 1),
    ],
)
def test_beside_a_model_error_both_grades_of_a_claim_may_be_right(
    beside, said, verdict, right, wrongly_named, wrongly_dominant
):
    kind = f"model error, {'smooth' if beside == 'smooth_error' else 'physical'}"
    row = _row(kind, ["restitution"], said, verdict, hidden={"restitution": {}, beside: {}})
    found = {what: count for what, (count, _) in _counts([row]).items()}
    assert found["right as named or dominant"] == right
    assert found["wrongly named"] == wrongly_named
    assert found["wrongly dominant"] == wrongly_dominant


def test_shares_come_with_the_interval_of_wilson():
    # Its ends are the shares p of which the count is 1.96 standard deviations away.
    for count, total in ((0, 20), (3, 20), (20, 20)):
        ends = interval(count, total)
        assert (ends[0] == 0.0, ends[1] == 1.0) == (count == 0, count == total)
        for end in ends:
            if 0.0 < end < 1.0:
                away = (count / total - end) / np.sqrt(end * (1.0 - end) / total)
                assert abs(away) == pytest.approx(1.959964)
    rows = [_row("none", [], None, verdict) for verdict in ("none", "none", "none", "unexplained")]
    (counted,) = judged(rows)
    assert (counted["count"], counted["total"], counted["met"]) == (1, 4, False)
    assert counted["missed"] == [7]


NAME = "friction over slip speed"


@pytest.mark.parametrize(
    ("said", "effect", "right"),
    [
        ("free_friction_speed", None, True), ("stribeck_friction", None, True),
        ("surface_tilt", None, False),
        (["free_friction_speed", "viscous_friction"], None, True),
        (["free_friction_speed", "free_drag_speed"], None, False),
        # Without a cause, by the law that is accepted.
        (None, None, False), (None, "free_friction_speed", True), (None, "free_drag_speed", False),
        # A law that is a cause itself has a name in words.
        (NAME, "free_friction_speed", True), (NAME, "free_drag_speed", False),
        ([NAME, "surface_tilt"], "free_friction_speed", False),
    ],
)  # fmt: skip
def test_a_law_is_judged_by_where_it_acts(said, effect, right):
    row = _row("law", [], said, "dominant" if said else "unexplained", hook="friction_speed")
    row["said"] |= {"laws": {NAME: effect}, "open_set": {"accepted": bool(effect)}}
    row["said"]["open_set"] |= {"effect": effect, "formula": None, "gain": None}
    assert asked.hook_right(row) is right
    if effect:
        assert asked.right_shape(row) is right
        row["said"]["open_set"]["accepted"] = False
        assert asked.hook_right(row) is (right and said == NAME)


def test_laws_are_counted_beside_causes():
    said = ("surface_tilt", "free_friction_speed")
    rows = [_row("law", [], each, seed=7 + k, hook="friction_speed") for k, each in enumerate(said)]
    found = _counts(rows)
    assert (found["hook right"], found["false terms"]) == ((1, 2), (1, 2))
    (cause,) = by_cause(rows)
    assert (cause["cause"], cause["in_set"], cause["wrong"]) == ("friction_speed", 1, 1)
    assert "| law | 7 | friction_speed | 30.0 | named surface_tilt |" in misses(rows)


def test_a_curve_is_judged_by_its_band_and_its_form():
    law = {"target": "sliding", "argument": "slip_speed", "form": "hump", "amplitude": 0.3}
    law |= {"scale": 0.01, "exponent": 0.5}
    row = _row("law", [], None, "unexplained", hook="friction_speed", effects={"law": law},
               constants={"contact.kinetic_friction": 0.1})  # fmt: skip
    shape = {"accepted": True, "effect": "free_friction_speed"}
    row["said"]["open_set"] = shape
    # mu (1 + 0.3 exp(-2 ln(u / 0.01)^2)), by hand at u of 0, 0.01 and 0.02 m/s.
    true = np.array([0.1, 0.13, 0.1 * (1.0 + 0.3 * np.exp(-2.0 * np.log(2.0) ** 2))])
    forms = ("a (u / b) exp(1 - |u| / b)", "a u")
    for holds, right in ((3, True), (2, False)):
        high = true + np.where(np.arange(3) < holds, 0.001, -0.0005)
        first, second = forms if right else forms[::-1]
        shape |= {"curve": {"argument": [0.0, 0.01, 0.02], "low": true - 0.001, "high": high}}
        shape |= {"formula": first, "others": [second]}
        assert asked.band_holds(row) is asked.band_holds_all(row) is asked.form_right(row) is right
        assert asked.form_said(row)
        shape["others"] = []
        assert asked.form_said(row) is right
    for after, is_half in ((1.5, True), (1.6, False)):
        # By table, as there may be several.
        for before, left in ((3.0, after), ({"velocity": 3.0}, {"velocity": after})):
            shape["gain"] = {"mae_before": before, "mae_after": left}
            assert asked.halved(row) is is_half
        shape["gain"] = {"mae_before": 3.0, "mae_after": 1.0}
        assert asked.halved_by_truth({**row, "truth_error": after}) is is_half
    # The truth at 4 of 5 points.
    low = np.array([0.1, 0.1, 0.13, 0.13, true[2] + 0.01]) - 0.001
    shape["curve"] = {"argument": [0.0, 0.0, 0.01, 0.01, 0.02], "low": low, "high": low + 0.002}
    assert (asked.band_holds(row), asked.band_holds_all(row)) == (True, False)
    assert asked.right_shape(row)
    shape["accepted"] = False
    questions = (asked.band_holds, asked.form_right, asked.right_shape, asked.halved)
    assert not any(question(row) for question in questions)


def test_the_error_of_the_truth_is_over_what_was_measured(monkeypatch):
    answer = _row("law", [], None, hook="friction_speed")["answer"]
    table = object.__new__(VelocityTable)
    table.conditions = [{f"drive.{key}": float(k) for key in KEYS} for k in (1, 3)]
    table.mean = np.array([1.5, 2.0])
    monkeypatch.setattr(case, "Truth", SimpleNamespace(of=lambda each: each))
    # The truth is at 1 and 3, where 1.5 and 2 were measured.
    monkeypatch.setattr(
        case, "velocities", lambda truth, drives: np.array([each["frequency"] for each in drives])
    )
    assert case._truth_error(table, answer) == pytest.approx(0.75)


def test_what_is_blamed_and_what_is_said_beside_it():
    def instrument(hidden, said, verdict="named"):
        row = _row("instrument", [hidden], said, verdict)
        return asked.instrument_said(row), asked.physical_claimed(row)

    assert instrument("length_scale", "clock_scale") == (True, False)
    assert instrument("velocity_offset", "surface_tilt") == (False, True)
    assert not instrument("velocity_offset", ["a"], "ambiguous")[1]
    answer = ["misalignment", "ambient_field"]
    for said, verdict, reasons, right in (
        (answer, "pair", [], True),
        (answer, "ambiguous", [], True),
        ("misalignment", "named", [], False),
        ("misalignment", "named", ["second-cause-predicts-nothing"], True),
        ("misalignment", "dominant", [], True),
        ("edge_time", "dominant", [], False),
    ):
        assert (
            asked.second_said({**_row("hiding", answer, said, verdict), "reasons": reasons})
            is right
        )


def test_calibration_counts_answers_by_their_probability():
    rows = [
        {"answer": {"kind": kind, "answer": answer}, "said": {"probabilities": chance}}
        for kind, answer, chance in (
            ("none", [], {"none": 0.9, "a": 0.1}),
            ("single", ["a"], {"none": 0.1, "a": 0.85, "b": 0.05}),
            ("single", ["a"], {"none": 0.1, "b": 0.9}),
            ("unknown", [], {"unknown": 1.0}),
            ("unknown", [], {"none": 0.7, "a": 0.3}),
            ("pair", ["a", "b"], {"a": 0.9, "none": 0.1}),
        )
    ]
    low, high, sure = calibration(rows)
    # What no cause explains is none of them.
    assert [(each["count"], each["total"]) for each in (low, high, sure)] == [
        (1, 1),
        (2, 3),
        (1, 1),
    ]
    assert high["mean"] == pytest.approx((0.9 + 0.85 + 0.9) / 3)


def test_the_documentation_has_the_numbers_of_the_record():
    rows = read(RECORD)
    page, readme = (
        (ROOT / name).read_text() for name in ("docs/theory/blind-study.md", "README.md")
    )
    shown = [line for line in page.splitlines() if re.search(r"\| \d+ of \d+", line)]
    assert len(shown) > 20 and set(shown) <= set(table(rows).splitlines())
    page, readme = (" ".join(each.split()) for each in (page, readme))
    counts = {(each["kind"], each["what"]): each for each in judged(rows, pooled=True)}
    for kind, what, text, words in (
        ("none", "false alarm", readme, "{count} false alarms in {total} sets without a cause"),
        ("single", "named", readme,
         "Of {total} sets with one strong cause, it named {count}, all correctly"),
        ("constant 5 sd", "that constant named", page, "of the {left} missed constants are the rotational drag"),
        ("weak", "detected", page, "{left} are not detected"),
        ("pair", "exact pair", page, "of the {left} that are not claimed exactly"),
        ("law", "hook right", page, "Of the {left} that are missed"),
        ("law", "its formula has the right form", page, "Of the {left} formulas with another form"),
    ):  # fmt: skip
        each = counts[kind, what]
        assert words.format(**each, left=each["total"] - each["count"]) in text, (kind, what)
    right = counts["single", "right when named"]
    assert right["count"] == right["total"] == counts["single", "named"]["count"]
    assert f"on {len(rows)} synthetic data sets" in readme
    alarms = Counter(
        row["said"]["verdict"] for row in counted(rows) if row["answer"]["kind"].startswith("none")
    )
    sets, other = alarms["ambiguous"], alarms["unexplained"]
    assert f"{sets} are sets of causes, {other} is `unexplained`" in page
    assert alarms.total() == alarms["none"] + sets + other
    slow = Counter(row["answer"]["kind"] for row in rows if row["cpu_seconds"] > 240.0)
    longest = max(rows, key=lambda row: row["cpu_seconds"])
    most = f"{longest['cpu_seconds']:.0f} s at most, {longest['answer']['seed']}"
    kinds = f"{slow['law']} laws ({most}), {slow['pair']} pairs and {slow['unknown']} waves"
    assert f"{slow.total()} took more than 240 s of CPU time: {kinds}" in page


def test_every_family_of_the_table_has_words():
    assert set(FAMILY_WORDS) == {each.family for each in KINDS.values()}


def test_stored_data_sets_are_diagnosed_before_their_answers_are_opened(tmp_path, monkeypatch):
    """A row for each set of the present engine, without the answer; another call adds none."""
    stored_sets = [{"name": f"set {k}", "files": {"measurement.toml": str(k)}} for k in range(3)]
    now = {"engine": "a", "data": "b"}
    said = {**_row("none", [], None, "none"), "cpu_seconds": 1.0}
    said["said"] |= {"p_value": 0.5, "laws": {}, "next_experiments": []}
    del said["answer"]

    def refused():
        raise AssertionError("an answer was opened")

    for name, value in {
        "SAID": tmp_path / "said.jsonl", "RECORD": tmp_path / "record.jsonl",
        "state": lambda: now, "sets": lambda path: stored_sets, "answers": refused,
        "diagnosed": lambda folder: {**said, "said": dict(said["said"])},
    }.items():  # fmt: skip
        monkeypatch.setattr(stored, name, value)
    (tmp_path / "said.jsonl").write_text(json.dumps({"name": "set 0", "state": {"engine": "e"}}))
    with (tmp_path / "said.jsonl").open("a") as file:
        file.write("\n")
    for part in (0, 1, 0):
        stored.diagnose_stored(1.0, part, 2)
    assert sorted(stored.said(now)) == ["set 0", "set 1", "set 2"]
    assert len((tmp_path / "said.jsonl").read_text().splitlines()) == 4
    assert "answer" not in (tmp_path / "said.jsonl").read_text()
    answer = _row("none", [], None)["answer"] | {"hook": ""}
    monkeypatch.setattr(stored, "answers", lambda: {each["name"]: answer for each in stored_sets})
    stored.judge()
    rows = (tmp_path / "record.jsonl").read_text().splitlines()
    assert [json.loads(row)["answer"]["kind"] for row in rows] == ["none"] * 3


def test_the_documentation_counts_the_stored_study():
    rows = read(stored.RECORD)
    page = (ROOT / "docs/theory/blind-study.md").read_text()
    assert f"diagnosed {len(rows)} stored data sets" in " ".join(page.split())
    assert len({json.dumps(row["state"]) for row in rows}) == 1
