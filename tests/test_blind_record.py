"""The record of the blind study: its flow, and how its rows are counted."""

import json
from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest
from blind import own, study
from blind.kinds import KINDS, STUDY, plan
from blind.scoring import WORDS, Case, calibration, facts, read, report
from blind.writing import KEYS

from stickslip.walker import read_measurement
from stickslip.walker.velocity import VelocityTable


def _row(kind, answer, said, verdict="named", seed=7, **more):
    hidden = {"strength": 30.0, "answer": answer, "effects": {}, **more}
    told = {"verdict": verdict, "cause": said, "probabilities": {"none": 1.0}, "gain": None}
    return {
        "answer": {"kind": kind, "seed": seed, **hidden},
        "said": {**told, "open_set": None, "parameters": {}},
        "gain": None, "reasons": [], "cpu_seconds": 1.0,
    }  # fmt: skip


def test_the_study_is_made_diagnosed_and_judged_in_parts(tmp_path, monkeypatch):
    asked = list(plan(STUDY, 1000, ["none, fields"], study=True))
    names = [study.name_of(*each) for each in asked]
    study.make(tmp_path, asked, 0.0)
    assert not (tmp_path / study.SETS).exists()
    # What a stopped call had made is kept, but for a line that was cut off.
    none = {**_row("none", [], None)["answer"], "hook": None}
    for file, one in ((study.SETS, {"files": {}}), (study.ANSWERS, {"answer": none})):
        (tmp_path / f"{file}.part").write_text(json.dumps({"name": "a", **one}) + '\n{"n')
    study.make(tmp_path, asked, 10.0)
    stored = {each["name"]: each for each in study.sets(tmp_path / study.SETS)}
    assert list(stored) == sorted(["a", *names])
    assert all(set(each) == {"name", "files"} for each in stored.values())
    path = study.unpacked(stored[names[0]], tmp_path / "one")
    assert len(read_measurement(path).field) == 1
    made = (tmp_path / study.SETS).read_bytes()
    study.make(tmp_path, asked, 10.0)
    assert (tmp_path / study.SETS).read_bytes() == made

    now, opened = {"golden": "a", "data": "b"}, []
    said = {**_row("none", [], None, "none"), "next_experiments": []}
    del said["answer"]
    monkeypatch.setattr(study, "state", lambda: now)
    monkeypatch.setattr(study, "diagnosed", lambda path: opened.append(path) or said)
    (tmp_path / study.ANSWERS).rename(tmp_path / "hidden")
    # A row of another engine says nothing; one that was cut off ends no study.
    others = [{"name": names[0], "state": {**now, "golden": "e"}}, {"name": names[1], "state": {}}]
    text = "".join(json.dumps(each) + "\n" for each in others) + '{"name"'
    (tmp_path / study.SAID).write_text(text)
    for part in (1, 2, 1):
        study.diagnose_sets(tmp_path, 1.0, part, 2)
    assert len(opened) == len(stored) == 4
    assert set(study.said(tmp_path, now)) == set(stored)
    (tmp_path / "hidden").rename(tmp_path / study.ANSWERS)
    kinds = [row["answer"]["kind"] for row in study.judge(tmp_path)]
    assert sorted(kinds) == ["none", *3 * ["none, fields"]]
    assert [row["answer"]["kind"] for row in read(tmp_path / study.RECORD)] == kinds
    # A later engine, which has judged nothing, leaves the record.
    now["golden"] = "c"
    with pytest.raises(SystemExit, match="no row of this engine"):
        study.judge(tmp_path)
    assert len(read(tmp_path / study.RECORD)) == 4


NAME = "friction over slip speed"
HOOK = {"hook": "friction_speed"}
FOUR = ["restitution", "edge_time", "eddy_lag", "field_gain"]
ANSWERS = [
    ("single", FOUR[:1], "restitution", "dominant", {}, "right name", 1.0),
    ("single", FOUR[:1], "edge_time", "named", {}, "wrong name", 0.0),
    ("weak", FOUR[:1], FOUR[:3], "ambiguous", {}, "right set", 1 / 3),
    ("shuffled", FOUR[:1], None, "none", {}, "rightly silent", 0.0),
    # No velocity tells a scale of the length from one of the clock.
    ("exact twins", ["length_scale"], ["length_scale", "clock_scale"], "ambiguous", {},
     "right set", 1.0),
    ("unlisted, unlike", [], "edge_time", "dominant", {"hook": None}, "wrong name", 0.0),
    # A law counts by where it acts.
    ("law", [], "free_friction_speed", "dominant", HOOK, "right name", 1.0),
    ("unlisted, alike", [], "stribeck_friction", "named", HOOK, "right name", 1.0),
    ("law", [], ["free_friction_speed", "viscous_friction"], "pair", HOOK, "right name", 1.0),
    ("law", [], ["free_friction_speed", "free_drag_speed"], "pair", HOOK, "wrong name", 0.5),
    ("law", [], "surface_tilt", "named", HOOK, "wrong name", 0.0),
    ("law", [], None, "unexplained", HOOK, "silent", 0.0),
    # One that is a cause itself has a name in words.
    ("law", [], NAME, "named", HOOK, "right name", 1.0),
    ("law", [], NAME, "named", {"hook": "drag_speed"}, "wrong name", 0.0),
    ("law", [], [NAME, "surface_tilt"], "pair", HOOK, "wrong name", 0.5),
]  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "hidden", "causes", "verdict", "more", "outcome", "credit"), ANSWERS
)
def test_an_answer_is_judged(kind, hidden, causes, verdict, more, outcome, credit):
    row = _row(kind, hidden, causes, verdict, **more)
    row["said"]["laws"] = {NAME: "free_friction_speed"}
    case = Case(row)
    assert (case.told.outcome, case.told.credit) == (outcome, pytest.approx(credit))
    assert case.any_claim == (verdict in ("named", "pair", "dominant"))
    assert case.place_right == (outcome == "right name" and "hook" in more)
    assert case.group == {"shuffled": "nothing"}.get(kind, "listed" if hidden else "unlisted")


def test_what_is_too_weak_is_not_counted_and_every_family_has_words():
    assert set(WORDS) == {each.family for each in KINDS.values()}
    rows = [
        _row("single", FOUR[:1], "edge_time", seed=k, strength=s) for k, s in ((1, 5.5), (2, 5))
    ]
    assert [Case(row).counted for row in rows] == [True, False]
    said = report([*rows, _row("none, film", [], None, "unexplained")])
    assert "| one cause, S of 6 or more | 1 | 1 (21 to 100 %) | 0 | 0.00 (0 to 79 %) |" in said
    assert "| nothing | 1 | 0 | 1 (21 to 100 %) | - |" in said
    assert "3 data sets of up to 30 conditions, 1 of them too weak to count" in said
    assert [line for line in said.splitlines() if line.startswith("| single |")] == [
        "| single | 1 | restitution | 5.5 | named edge_time |"
    ]
    beside = Case(_row("model error, smooth", FOUR[:1], None, hidden={"smooth_error": {}}))
    assert beside.all_hidden == {"restitution", "smooth_error"}


def test_facts_are_counted_of_the_cases_that_they_are_about():
    sized = {"effects": {"surface_tilt": {"angle": 0.01}}}
    near, off, wrong = (_row("near twins", [name], "surface_tilt", **sized)
                        for name in ("surface_tilt", "surface_tilt", "edge_time"))  # fmt: skip
    for row, value in ((near, 0.0119), (off, 0.0121), (wrong, 0.0)):
        row["said"]["parameters"] = {"surface_tilt.angle": {"value": value, "sd": 1e-3}}
        row["followed"] = {**row["said"], "cause": "surface_tilt"}
    found = facts([Case(row) for row in (near, off, wrong)])
    assert found == {
        "parameters within 2 sd, of rightly named causes": (1, 2),
        "near twins rightly named after three proposed drives": (2, 3),
    }


def test_a_curve_is_judged_by_its_band_and_its_form():
    law = {"target": "sliding", "argument": "slip_speed", "form": "hump", "amplitude": 0.3}
    law |= {"scale": 0.01, "exponent": 0.5}
    row = _row("law", [], NAME, "dominant", hook="friction_speed", effects={"law": law},
               constants={"contact.kinetic_friction": 0.1})  # fmt: skip
    shape = {"effect": "free_friction_speed"}
    row["said"] |= {"open_set": shape, "laws": {NAME: "free_friction_speed"}}
    # mu (1 + 0.3 exp(-2 ln(u / 0.01)^2)), by hand at u of 0, 0.01 and 0.02 m/s.
    true = np.array([0.1, 0.13, 0.1 * (1.0 + 0.3 * np.exp(-2.0 * np.log(2.0) ** 2))])
    for holds, right in ((3, True), (2, False)):
        high = true + np.where(np.arange(3) < holds, 0.001, -0.0005)
        shape |= {"curve": {"argument": [0.0, 0.01, 0.02], "low": true - 0.001, "high": high}}
        # No form peaks as the truth does.
        for share in (0.9, 0.96):
            forms = {"curve": share, "line": 1.0 - share}
            shape["forms"] = forms if right else {"line": share, "curve": 1.0 - share}
            case = Case(row)
            assert (case.inside == 1.0) is case.form_among(others=False) is right
            assert case.form_among(others=True) is (right or share < 0.95)
    for after, is_half in ((1.5, True), (1.6, False)):
        before, left = {"velocity": 3.0}, {"velocity": after}
        row["said"]["gain"] = {"mae_before": before, "mae_after": left}
        assert Case(row).halved is is_half
        assert Case({**row, "truth_error": after}).halved_by_truth is is_half
    # The truth at 4 of 5 points.
    low = np.array([0.1, 0.1, 0.13, 0.13, true[2] + 0.01]) - 0.001
    shape["curve"] = {"argument": [0.0, 0.0, 0.01, 0.01, 0.02], "low": low, "high": low + 0.002}
    assert Case(row).inside == 0.8
    assert Case(row).right_shape
    # A law beside another cause is none of its own.
    row["said"]["cause"] = ["surface_tilt"]
    case = Case(row)
    assert not any((case.inside, case.form_among(others=True), case.right_shape))


def test_the_error_of_the_truth_is_over_what_was_measured(monkeypatch):
    answer = _row("law", [], None, hook="friction_speed")["answer"]
    table = object.__new__(VelocityTable)
    table.conditions = [{f"drive.{key}": float(k) for key in KEYS} for k in (1, 3)]
    table.mean = np.array([1.5, 2.0])
    monkeypatch.setattr(study, "Truth", SimpleNamespace(of=lambda each: each))
    # The truth is at 1 and 3, where 1.5 and 2 were measured.
    monkeypatch.setattr(
        study, "velocities", lambda truth, drives: np.array([each["frequency"] for each in drives])
    )
    assert study.truth_error(table, answer) == pytest.approx(0.75)


def test_a_distortion_and_a_second_cause_are_said_or_not():
    for said, right in (("clock_scale", True), ("length_scale", True), ("surface_tilt", False)):
        assert Case(_row("instrument", ["length_scale"], said)).instrument_said is right
    answer = ["misalignment", "ambient_field"]
    for said, verdict, reasons, right in (
        (answer, "pair", [], True),
        (answer, "ambiguous", [], True),
        ("misalignment", "named", [], False),
        ("misalignment", "named", ["second-cause-predicts-nothing"], True),
        ("misalignment", "dominant", [], True),
        ("edge_time", "dominant", [], False),
    ):
        row = {**_row("hiding", answer, said, verdict), "reasons": reasons}
        assert Case(row).second_said is right


def test_calibration_counts_answers_by_their_probability():
    rows = [
        {"answer": {"kind": kind, "answer": answer}, "said": {"probabilities": chance}}
        for kind, answer, chance in (
            ("none", [], {"none": 0.9, "a": 0.1}),
            ("single", ["a"], {"none": 0.1, "a": 0.85, "b": 0.05}),
            ("single", ["a"], {"none": 0.1, "b": 0.9}),
            ("unknown", [], {"none": 1.0}),
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


def test_sets_of_models_of_ones_own_have_all_kinds_alike():
    logs = Counter(own.plan(place) for place in range(1, 2 * 3 * 80, 2))
    assert len(logs) == 4 * 5 * 3
    assert all(logs[kind, "listed", errors] == 2 * logs[kind, "none", errors] == 6
               for kind in own.MACHINES for errors in own.ERRORS)  # fmt: skip


@pytest.mark.nightly
@pytest.mark.parametrize("errors", own.MODEL_ERRORS)
def test_model_errors_have_the_share_that_is_asked_for(errors):
    """By the fit of the library's own model to readings without noise, beside one without error."""
    left = []
    for part in (0.0, 0.3):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(own, "ERROR_SHARE", (part, part))
            patch.setattr(own, "NOISE", 1e-9)
            patch.setattr(own, "STRENGTH", (1e7, 1e7))
            draw = np.random.default_rng(3)
            cause, effect, _, found = own.log("thermal", "listed", errors, draw)
        left.append(found.problem.y)
    null = found.findings.models.null
    basis = np.linalg.qr(null.slopes)[0]
    error, effect = (each - basis @ (basis.T @ each) for each in (left[1] - left[0], effect))
    # The slopes are those where this fit ends: of an effect of a hundredth of the readings, near
    # the truth. Constants undo half of it, and less of the errors, which would be 0.45 and more of
    # it if they were counted before a refit.
    assert cause == "heater_capacity"
    assert np.linalg.norm(error) == pytest.approx(0.3 * np.linalg.norm(effect), rel=0.05)


def test_how_alike_an_effect_and_listed_causes_are():
    cause, effect, _, found = own.line("listed", np.random.default_rng(2))
    assert found.verdict.causes == (cause,)
    # The model is linear in its causes.
    assert own.likeness(found, effect) == pytest.approx(1.0, abs=1e-9)
    x = own.PLACES[::2]
    other = np.linalg.svd([x, *own._shapes(x).values()])[2][-1]
    assert own.likeness(found, other) < 0.1


def test_how_far_an_effect_stands_out():
    # A slope of known error takes of an effect along it all but error / prior of it.
    x = own.PLACES
    found = own._stands_out(3.0 * x, x[:, None], 0.1, 0.2)
    assert found == pytest.approx(3.0 / np.hypot(0.1, 0.2 / np.linalg.norm(x)), rel=1e-9)
    bend = (x - 3.5) ** 2
    bend -= x * (x @ bend) / (x @ x)
    assert own._stands_out(bend, x[:, None], np.inf, 0.2) == pytest.approx(
        np.linalg.norm(bend) / 0.2, rel=1e-9
    )


def test_counts_of_models_of_ones_own():
    def row(hidden, cause, verdict, causes, errors="white", alike=None, strength=6.0):
        return {"errors": errors, "kind": "joint", "hidden": hidden, "cause": cause, "alike": alike,
                "strength": strength, "verdict": verdict, "causes": causes,
                "cpu_seconds": 1.0}  # fmt: skip

    text = own.tables(
        [row("none", "", "none", [])] * 59
        + [row("none", "", "dominant", ["load"])]
        + [row("listed", "load", "named", ["load"])] * 37
        + [row("listed", "load", "ambiguous", ["load", "coulomb"])] * 2
        + [row("listed", "load", "named", ["coulomb"])]
        + [row("listed", "load", "none", [], strength=5.9)] * 12
        + [row("unlisted", "load", "named", ["coulomb"], alike=0.89)] * 20
        + [row("unlisted", "load", "named", ["coulomb"], alike=0.91)] * 10
        + [row("listed", "load", "dominant", ["load"], "drift")] * 12
    )
    for line in (
        "| logs | none | false alarm | 1 of 60 | 0% to 9% | at most 5% | yes |",
        "| logs: listed | 40 | 37 (80 to 97 %) | 2 (1 to 17 %) | 0 | 1 (0 to 13 %) | 0 | 0.95 (",
        "| logs | listed | right or in the set | 39 of 40 | 87% to 100% | at least 95% | yes |",
        "| logs | listed | wrongly named | 1 of 40 | 0% to 13% | at most 1% | yes |",
        "| logs: listed, weak | 12 | 0 | 0 | 12 (76 to 100 %) | 0 | 0 | 0.00 (0 to 24 %) |",
        "| logs | unlisted, unlike | wrongly named | 20 of 20 | 84% to 100% | at most 3% | not ",
        "| logs: unlisted, alike | 10 | 0 | 0 | 0 | 10 (72 to 100 %) | 0 | - |",
        "| logs, model error | listed | right | 12 of 12 | 76% to 100% | at least 75% | yes |",
    ):
        assert line in text
