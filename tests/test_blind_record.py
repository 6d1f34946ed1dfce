"""The record of the blind study: its flow, and how its rows are counted."""

import json
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from blind import own, study
from blind.kinds import KINDS, STUDY, plan
from blind.scoring import (
    FAMILIES,
    Case,
    by_cause,
    calibration,
    judged,
    misses,
    read,
    report,
)
from blind.writing import KEYS

from stickslip.walker import read_measurement
from stickslip.walker.velocity import VelocityTable

ROOT = Path(__file__).resolve().parents[1]


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

    now, opened = {"engine": "a", "data": "b"}, []
    said = {**_row("none", [], None, "none"), "next_experiments": []}
    del said["answer"]
    monkeypatch.setattr(study, "state", lambda: now)
    monkeypatch.setattr(study, "diagnosed", lambda path: opened.append(path) or said)
    (tmp_path / study.ANSWERS).rename(tmp_path / "hidden")
    # A row of another engine says nothing; one that was cut off ends no study.
    others = [{"name": names[0], "state": {**now, "engine": "e"}}, {"name": names[1], "state": {}}]
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
    now["engine"] = "c"
    with pytest.raises(SystemExit, match="no row of this engine"):
        study.judge(tmp_path)
    assert len(read(tmp_path / study.RECORD)) == 4


def test_kinds_of_a_family_are_counted_together():
    assert set(FAMILIES) == {each.family for each in KINDS.values()}
    rows = [_row("none", [], None, "none"), _row("none, film", [], None, "unexplained")]
    assert [each["total"] for each in judged(rows)] == [1, 1]
    assert _counts(rows, pooled=True) == {"false alarm": (1, 2)}


FOUR = ["restitution", "edge_time", "eddy_lag", "field_gain"]
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
     [(FOUR[:3], "ambiguous", {}), (FOUR, "ambiguous", {}), ("restitution", "named", {})],
     {"in the set when detected": (2, 3), "a right set of at most three causes": (1, 3),
      "score of groups": (pytest.approx(1.0 + 1 / 3 + 1 / 4), 3)}),
    # No velocity tells a scale of the length from one of the clock.
    ("exact twins", ["length_scale"],
     [(["length_scale", "clock_scale"], "ambiguous", {}), ("length_scale", "named", {})],
     {"score of groups": (2.0, 2)}),
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


@pytest.mark.parametrize(
    ("alarms", "total", "met", "passing"),
    [(1, 59, None, None), (6, 60, True, 6), (7, 60, False, 6)],
)
def test_a_demand_is_missed_if_the_interval_excludes_it(alarms, total, met, passing):
    # 5 % is asked for. Wilson's interval of 6 of 60 begins at 4.7 %, that of 7 at 5.8 %.
    said = ["unexplained"] * alarms + ["none"] * (total - alarms)
    (counted,) = judged([_row("none", [], None, each, seed=k) for k, each in enumerate(said)])
    found = [counted[key] for key in ("count", "total", "met", "passing", "missed")]
    assert found == [alarms, total, met, passing, list(range(alarms))]


NAME = "friction over slip speed"


@pytest.mark.parametrize(
    ("said", "effect", "right"),
    [
        ("free_friction_speed", None, True), ("stribeck_friction", None, True),
        ("surface_tilt", None, False),
        (["free_friction_speed", "viscous_friction"], None, True),
        (["free_friction_speed", "free_drag_speed"], None, False),
        (None, None, False),
        # A law that is a cause itself has a name in words.
        (NAME, "free_friction_speed", True), (NAME, "free_drag_speed", False),
        ([NAME, "surface_tilt"], "free_friction_speed", False),
    ],
)  # fmt: skip
def test_a_law_is_judged_by_where_it_acts(said, effect, right):
    row = _row("law", [], said, "dominant" if said else "unexplained", hook="friction_speed")
    shape = {"effect": effect, "forms": {"curve": 1.0}} if effect else None
    row["said"] |= {"laws": {NAME: effect}, "open_set": shape}
    assert Case(row).hook_right is right
    assert Case(row).right_shape is (right and effect is not None)


def test_laws_are_counted_beside_causes():
    said = ("surface_tilt", "free_friction_speed")
    rows = [_row("law", [], each, seed=7 + k, hook="friction_speed") for k, each in enumerate(said)]
    found = _counts(rows)
    assert (found["hook right"], found["false terms"]) == ((1, 2), (1, 2))
    assert by_cause(rows) == [("friction_speed", "law", 2, 1, 2, 1)]
    assert misses(rows)[0][:5] == ("law", 7, "friction_speed", "30.0", "named surface_tilt")


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


def test_what_is_blamed_and_what_is_said_beside_it():
    def instrument(hidden, said, verdict="named"):
        row = _row("instrument", [hidden], said, verdict)
        return Case(row).instrument_said, Case(row).physical_claimed

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
