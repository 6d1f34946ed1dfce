"""The record of the blind study: how a study is continued, and how its rows are counted."""

import fcntl
import json
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
from blind.case import same_state, state
from blind.kinds import KINDS, STUDY
from blind.questions import (
    band_holds,
    band_holds_all,
    form_right,
    form_said,
    halved,
    halved_by_truth,
    hook_right,
    instrument_said,
    physical_claimed,
    right_shape,
    second_said,
)
from blind.report import FAMILY_WORDS, misses, report, table
from blind.scoring import by_cause, calibration, counted, interval, judged, read
from blind.writing import KEYS

ROOT = Path(__file__).resolve().parents[1]
RECORD = ROOT / "bench" / "blind" / "record.jsonl"


def _row(kind, answer, said, verdict="named", **more):
    hidden = {"strength": 30.0, "answer": answer, "effects": {}, **more}
    chance = {"none": 1.0}
    return {
        "answer": {"kind": kind, "seed": 7, **hidden},
        "said": {
            "verdict": verdict, "cause": said, "probabilities": chance, "gain": None,
            "open_set": None, "parameters": {},
        },
        "gain": None,
        "reasons": [],
        "cpu_seconds": 1.0,
    }  # fmt: skip


def test_an_interrupted_study_is_continued(tmp_path, monkeypatch, capsys):
    record = tmp_path / command.RECORD
    now = {"engine": "a", "data": "b", "commit": "c", "version": "d"}
    monkeypatch.setattr(command, "state", lambda: now)
    # Another commit may have the same files.
    done = json.dumps({**_row("none", [], None, "none"), "state": {**now, "commit": "f"}})
    # Of other files nothing is taken over.
    other = json.dumps({**_row("none", [], "x"), "state": {**now, "engine": "e"}})
    law = _row("law", [], None, "unexplained", hook="friction_speed")
    law = json.dumps({**law, "state": now})
    record.write_text(f"{other}\n{done}\n{law}\n{done[:50]}")
    arguments = ["blind", "--first", "7", "--seeds", "1", "--kinds", "none;law", "--jobs", "1"]
    monkeypatch.setattr(sys, "argv", [*arguments, "--out", str(tmp_path)])
    command.main()
    # The row that was cut off is gone, the other one was not made again.
    assert record.read_text() == f"{other}\n{done}\n{law}\n"
    assert "| nothing | false alarm | 0 of 1 |" in capsys.readouterr().out
    with (tmp_path / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(SystemExit):
            command.main()
    assert "another study is at work there" in capsys.readouterr().err


def test_a_row_counts_for_the_engine_and_the_generator_that_made_it():
    now = {"engine": "a", "data": "b"}
    row = {**_row("law", [], None), "state": {**now, "commit": "c"}}
    assert same_state(row, now)
    assert not same_state(row, {**now, "data": "c"})
    assert not same_state(row, {**now, "engine": "c"})
    assert not same_state({**row, "state": {}}, now)


def test_frozen_data_sets_are_set_beside_what_was_found(tmp_path, monkeypatch):
    monkeypatch.setattr(frozen, "SETS", tmp_path / "frozen" / "sets.jsonl.xz")
    monkeypatch.setattr(frozen, "ROWS", tmp_path / "frozen" / "rows.jsonl")
    (tmp_path / "rows").mkdir()
    for kind, seed in (("single", 3), ("none", 4)):
        candidates = [
            {"name": "a + b", "chi2": 10.0}, {"name": "a", "chi2": 12.0},
            {"name": "none", "chi2": 40.0},
        ]  # fmt: skip
        row = {
            "kind": kind, "seed": seed, "truth": ["a"] if kind == "single" else [], "hook": None,
            "verdict": "pair", "cause": ["a", "b"], "p_value": 0.1, "cpu_seconds": 8.0,
            "candidates": candidates,
        }  # fmt: skip
        text = json.dumps({"row": row, "set": {"kind": kind, "seed": seed, "files": {"f": "x"}}})
        (tmp_path / "rows" / f"{kind}.json").write_text(text)
    assert rerun.pack(tmp_path / "rows") == 2
    # In the order of the kinds, not of the files.
    assert [each["kind"] for each in frozen.sets()] == ["none", "single"]
    before = frozen.rows()

    def found(kind, causes):
        """Of the models none and a; their chi-square has the prior's part, 2 * 0.5^2."""
        fits = {
            names: SimpleNamespace(
                x=np.array([0.5, 9.0]), free=np.array([0]), precision=np.array([[8.0]]), chi2=chi2
            )
            for names, chi2 in ((frozenset(), 38.0), (frozenset("a"), 11.5))
        }
        models = SimpleNamespace(get=lambda names: fits.get(frozenset(names)))
        verdict = SimpleNamespace(kind=kind, causes=causes, share=0.9)
        test = SimpleNamespace(p_value=0.2)
        return SimpleNamespace(verdict=verdict, findings=SimpleNamespace(models=models, test=test))

    said = rerun.beside(found("named", ("a",)), before["single", 3])
    # 12 was found before and is 13.5 now; the pair that led was not fitted.
    assert said["chi2"] == {"none": [40.0, 40.0], "leader": [10.0, None], "truth": [12.0, 13.5]}
    again = rerun.beside(found("pair", ("b", "a")), before["none", 4])
    assert again["chi2"]["truth"] == [40.0, 40.0]
    # Without a search there is nothing to compare.
    assert rerun.beside(found("none", ()), before["none", 4])["chi2"] == {}
    rows = [{**said, "cpu_seconds": [8.0, 2.0]}, {**again, "cpu_seconds": [4.0, 4.0]}]
    text = rerun.summary(rows)
    assert "1 of 2 verdicts are those of before" in text
    assert "single 3 | a | pair a, b -> named a" in text
    assert "chi-square of the truth at most 1 higher: 1 of 2, 0 not fitted" in text
    assert "chi-square of the old leader at most 1 higher: 0 of 2, 2 not fitted" in text
    assert "median 6.0 before, 3.0 now, median ratio 0.62" in text


def test_kinds_of_a_family_are_counted_together():
    rows = [_row("none", [], None, "none"), _row("none, film", [], None, "unexplained")]
    assert [each["total"] for each in judged(rows)] == [1, 1]
    (pooled,) = judged(rows, pooled=True)
    assert (pooled["kind"], pooled["count"], pooled["total"]) == ("none", 1, 2)


def test_a_state_says_what_decides():
    assert len(set(state().values())) == len(state()) == 4


def test_data_sets_are_written_with_their_answers_apart(tmp_path, monkeypatch):
    arguments = ["blind", "--first", "2", "--seeds", "2", "--kinds", "none, fields"]
    monkeypatch.setattr(sys, "argv", [*arguments, "--write", str(tmp_path)])
    command.main()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0000", "0001", "answers"]
    answer = json.loads((tmp_path / "answers" / "0001.json").read_text())
    assert (answer["kind"], answer["seed"]) == ("none, fields", 3)


def test_the_study_is_made_in_parts_and_its_answers_are_apart(tmp_path, monkeypatch):
    monkeypatch.setattr(frozen, "STUDY_SETS", tmp_path / "study" / "sets.jsonl.xz")
    monkeypatch.setattr(frozen, "ANSWERS", tmp_path / "study" / "answers.jsonl.xz")
    frozen.freeze(0.0, ["none, fields"])
    assert not frozen.STUDY_SETS.exists()
    wanted = [frozen.name_of("none, fields", STUDY + k) for k in range(3)]
    (tmp_path / "study" / "sets.jsonl.part").write_text(
        json.dumps({"name": "a", "files": {}}) + '\n{"n'
    )
    frozen.freeze(10.0, ["none, fields"])
    stored = list(frozen.sets(frozen.STUDY_SETS))
    # What a stopped call had made is kept, but for a line that was cut off.
    assert [each["name"] for each in stored] == sorted(["a", *wanted])
    assert all(set(each) == {"name", "files"} for each in stored)
    answers = frozen.answers()
    assert [answers[name]["seed"] for name in wanted] == [STUDY, STUDY + 1, STUDY + 2]
    (one,) = (each for each in stored if each["name"] == wanted[0])
    path = frozen.unpacked(one, tmp_path / "one")
    assert len(read_measurement(path).field) == 1
    made = frozen.STUDY_SETS.read_bytes()
    frozen.freeze(10.0, ["none, fields"])
    assert frozen.STUDY_SETS.read_bytes() == made
    assert sorted(path.name for path in frozen.ANSWERS.parent.iterdir()) == [
        "answers.jsonl.xz", "sets.jsonl.xz",
    ]  # fmt: skip


def test_a_dominant_cause_is_a_claim_of_its_own():
    rows = [
        _row("single", ["restitution"], "restitution", "dominant"),
        _row("single", ["restitution"], "edge_time", "dominant"),
        _row("single", ["restitution"], "restitution"),
    ]
    found = {each["what"]: (each["count"], each["total"]) for each in judged(rows)}
    assert found["named"] == (1, 3)
    assert found["right when named"] == (1, 1)
    assert found["right when dominant"] == (1, 2)
    none = _row("none, correlated strong", [], "edge_time", "dominant")
    (_, claimed) = judged([none])
    assert (claimed["count"], claimed["met"]) == (1, False)


def test_beside_a_model_error_both_grades_of_a_claim_may_be_right():
    def counts(kind, said, verdict, hidden):
        row = _row(kind, ["restitution"], said, verdict, hidden={key: {} for key in hidden})
        rows = {each["what"]: each["count"] for each in judged([row])}
        kept = ("right as named or dominant", "wrongly named", "wrongly dominant")
        return tuple(rows[what] for what in kept)

    smooth = ("model error, smooth", ("restitution", "smooth_error"))
    physical = ("model error, physical", ("restitution", "edge_time"))
    both = ["restitution", "edge_time"]
    for (kind, hidden), said, verdict, expected in (
        (smooth, "restitution", "named", (1, 0, 0)),
        (smooth, "restitution", "dominant", (1, 0, 0)),
        (smooth, "restitution", "ambiguous", (0, 0, 0)),
        (smooth, "edge_time", "named", (0, 1, 0)),
        (smooth, both, "pair", (0, 1, 0)),
        (smooth, "edge_time", "dominant", (0, 0, 1)),
        (physical, both, "pair", (1, 0, 0)),
        (physical, "edge_time", "dominant", (0, 0, 1)),
    ):
        assert counts(kind, said, verdict, hidden) == expected


def test_what_no_cause_lists_is_judged_by_how_alike_it_is():
    rows = [
        _row("unlisted, unlike", [], "edge_time", "dominant", cosine=0.5, hook=None),
        _row("unlisted, unlike", [], "stribeck_friction", cosine=0.5, hook="friction_speed"),
        _row("unlisted, unlike", [], "edge_time", cosine=0.95, hook="friction_speed"),
        _row("unlisted, unlike", [], "edge_time", "dominant", cosine=0.95, hook="drag_speed"),
    ]
    for number, row in enumerate(rows):
        row["answer"]["seed"] = number
    found = {each["what"]: (each["count"], each["total"]) for each in judged(rows)}
    assert found["unlike all causes: wrongly named"] == (0, 2)
    assert found["unlike all causes: wrongly dominant"] == (1, 2)
    assert found["like a cause: wrongly named"] == (1, 2)
    assert found["like a cause: said to act like one"] == (1, 2)


def test_sets_count_by_their_size():
    members = ["restitution", "edge_time", "eddy_lag", "field_gain", "ambient_field", "angle_drag"]
    rows = [
        _row("weak", ["restitution"], members, "ambiguous"),
        _row("weak", ["restitution"], [*members, "sample_hold"], "ambiguous"),
        _row("weak", ["restitution"], "restitution"),
    ]
    found = {each["what"]: (each["count"], each["total"]) for each in judged(rows)}
    assert found["in the set when detected"] == (3, 3)
    assert found["the same, in at most six causes"] == (2, 3)
    assert found["sets of at most six causes"] == (1, 2)


def test_shares_come_with_the_interval_of_wilson():
    # Its ends are the shares p of which the count is 1.96 standard deviations away.
    for count, total in ((0, 20), (3, 20), (20, 20)):
        for end in interval(count, total):
            if 0.0 < end < 1.0:
                away = (count / total - end) / np.sqrt(end * (1.0 - end) / total)
                assert abs(away) == pytest.approx(1.959964)
    assert interval(0, 20)[0] == 0.0
    assert interval(20, 20)[1] == 1.0
    rows = [_row("none", [], None, verdict) for verdict in ("none", "none", "none", "unexplained")]
    (counted,) = judged(rows)
    assert (counted["count"], counted["total"], counted["met"]) == (1, 4, False)
    assert counted["missed"] == [7]


def test_a_law_is_judged_by_where_it_acts():
    law = {"hook": "friction_speed"}
    for said, right in (
        ("free_friction_speed", True),
        ("stribeck_friction", True),
        (["free_friction_speed", "viscous_friction"], True),
        (["free_friction_speed", "free_drag_speed"], False),
        ("surface_tilt", False),
        (None, False),
    ):
        assert hook_right(_row("law", [], said, **law)) is right
    unexplained = _row("law", [], None, "unexplained", **law)
    for effect, accepted in (("free_friction_speed", True), ("free_drag_speed", True),
                             ("free_friction_speed", False)):  # fmt: skip
        shape = {"accepted": accepted, "effect": effect, "formula": None, "gain": None}
        unexplained["said"]["open_set"] = shape
        assert hook_right(unexplained) is (accepted and effect == "free_friction_speed")
    # A law that is a cause itself has a name in words.
    name = "friction over slip speed"
    for effect, right in (("free_friction_speed", True), ("free_drag_speed", False)):
        said = _row("law", [], name, "dominant", **law)
        said["said"] |= {
            "laws": {name: effect}, "open_set": {"accepted": True, "effect": effect},
        }  # fmt: skip
        assert hook_right(said) is right_shape(said) is right
        said["said"]["cause"] = [name, "surface_tilt"]
        assert not hook_right(said)
        assert not right_shape(said)
    rows = [_row("law", [], "surface_tilt", **law), _row("law", [], "free_friction_speed", **law)]
    rows[1]["answer"]["seed"] = 8
    found = {each["what"]: each["count"] for each in judged(rows)}
    assert (found["hook right"], found["false terms"]) == (1, 1)
    (cause,) = by_cause(rows)
    assert (cause["cause"], cause["in_set"], cause["wrong"]) == ("friction_speed", 1, 1)
    assert "| law | 7 | friction_speed | 30.0 | named surface_tilt |" in misses(rows)


def test_a_curve_is_judged_by_its_band_and_its_form():
    words = {"target": "sliding", "argument": "slip_speed", "form": "hump"}
    law = {**words, "amplitude": 0.3, "scale": 0.01, "exponent": 0.5}
    constants = {"contact.kinetic_friction": 0.1}
    row = _row("law", [], None, "unexplained", hook="friction_speed", effects={"law": law},
               constants=constants)  # fmt: skip
    # mu (1 + 0.3 exp(-2 ln(u / 0.01)^2)), by hand at u of 0, 0.01 and 0.02 m/s.
    true = np.array([0.1, 0.13, 0.1 * (1.0 + 0.3 * np.exp(-2.0 * np.log(2.0) ** 2))])
    for holds, right in ((3, True), (2, False)):
        high = true + np.where(np.arange(3) < holds, 0.001, -0.0005)
        curve = {"argument": [0.0, 0.01, 0.02], "low": true - 0.001, "high": high}
        shape = {"accepted": True, "effect": "free_friction_speed", "curve": curve}
        row["said"]["open_set"] = {**shape, "gain": {"mae_before": 3.0, "mae_after": 1.0}}
        forms = ("a (u / b) exp(1 - |u| / b)", "a u")
        first, second = forms if right else forms[::-1]
        row["said"]["open_set"] |= {"formula": first, "others": [second]}
        assert band_holds(row) is right
        assert band_holds_all(row) is right
        assert form_right(row) is right
        assert form_said(row)
        row["said"]["open_set"]["others"] = []
        assert form_said(row) is right
        assert right_shape(row)
        assert halved(row)
        for error, reachable in ((1.5, True), (1.6, False)):
            assert halved_by_truth({**row, "truth_error": error}) is reachable
        for after in (1.5, 1.6):
            # By table, as there may be several.
            maes = {"mae_before": {"velocity": 3.0}, "mae_after": {"velocity": after}}
            row["said"]["open_set"]["gain"] = maes
            assert halved(row) is (after == 1.5)
    # The truth at 4 of 5 points.
    at = [0.0, 0.0, 0.01, 0.01, 0.02]
    low = np.array([0.1, 0.1, 0.13, 0.13, true[2] + 0.01]) - 0.001
    row["said"]["open_set"]["curve"] = {"argument": at, "low": low, "high": low + 0.002}
    assert (band_holds(row), band_holds_all(row)) == (True, False)
    row["said"]["open_set"]["accepted"] = False
    assert not any(question(row) for question in (band_holds, form_right, right_shape, halved))


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


def test_a_distortion_is_judged_by_what_is_blamed_for_it():
    scale = _row("instrument", ["length_scale"], "clock_scale")
    assert instrument_said(scale)
    assert not physical_claimed(scale)
    offset = _row("instrument", ["velocity_offset"], "surface_tilt")
    assert not instrument_said(offset)
    assert physical_claimed(offset)
    assert not physical_claimed(_row("instrument", ["velocity_offset"], ["a"], "ambiguous"))


def test_a_hidden_second_cause_may_be_said_in_three_ways():
    answer = ["misalignment", "ambient_field"]
    assert second_said(_row("hiding", answer, answer, "pair"))
    assert second_said(_row("hiding", answer, answer, "ambiguous"))
    alone = _row("hiding", answer, "misalignment")
    assert not second_said(alone)
    assert second_said({**alone, "reasons": ["second-cause-predicts-nothing"]})
    assert second_said(_row("hiding", answer, "misalignment", "dominant"))
    assert not second_said(_row("hiding", answer, "edge_time", "dominant"))


def test_causes_that_cannot_be_as_strong_as_asked_for_are_not_counted():
    weak = _row("single", ["restitution"], "restitution")
    weak["answer"]["strength"] = 2.0
    assert judged([weak]) == []
    assert "Not counted: 1 data sets" in report([weak])


def test_calibration_counts_answers_by_their_probability():
    def row(kind, answer, chance):
        return {"answer": {"kind": kind, "answer": answer}, "said": {"probabilities": chance}}

    rows = [
        row("none", [], {"none": 0.9, "a": 0.1}),
        row("single", ["a"], {"none": 0.1, "a": 0.85, "b": 0.05}),
        row("single", ["a"], {"none": 0.1, "b": 0.9}),
        row("unknown", [], {"unknown": 1.0}),
        row("unknown", [], {"none": 0.7, "a": 0.3}),
        row("pair", ["a", "b"], {"a": 0.9, "none": 0.1}),
    ]
    low, high, sure = calibration(rows)
    # What no cause explains is none of them.
    assert (low["count"], low["total"]) == (1, 1)
    assert (high["count"], high["total"]) == (2, 3)
    assert high["mean"] == pytest.approx((0.9 + 0.85 + 0.9) / 3)
    assert (sure["count"], sure["total"]) == (1, 1)


def test_the_documentation_has_the_numbers_of_the_record():
    rows = read(RECORD)
    assert table(rows) in (ROOT / "docs" / "theory" / "blind-study.md").read_text()
    counts = {(each["kind"], each["what"]): each for each in judged(rows, pooled=True)}
    said = " ".join((ROOT / "README.md").read_text().split())
    for kind, what, words in (
        ("none", "false alarm", "{count} false alarms in {total} sets without a cause"),
        (
            "single",
            "named",
            "Of {total} sets with one strong cause, it named {count}, all correctly",
        ),
    ):
        assert words.format(**counts[kind, what]) in said, (kind, what)
    right = counts["single", "right when named"]
    assert right["count"] == right["total"] == counts["single", "named"]["count"]
    assert f"on {len(rows)} synthetic data sets" in said


def test_what_was_missed_is_counted_as_in_the_record():
    rows = read(RECORD)
    counts = {(each["kind"], each["what"]): each for each in judged(rows, pooled=True)}
    page = " ".join((ROOT / "docs" / "theory" / "blind-study.md").read_text().split())
    for kind, what, words in (
        ("constant 5 sd", "that constant named", "of the {missed} are the rotational drag"),
        ("weak", "detected", "{missed} are not detected"),
        ("pair", "exact pair", "of the {missed} that are not claimed exactly"),
        ("law", "hook right", "Of the {missed} that are missed"),
        ("law", "its formula has the right form", "Of the {missed} formulas with another form"),
    ):
        each = counts[kind, what]
        missed = words.format(missed=each["total"] - each["count"])
        assert missed in page, missed
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
