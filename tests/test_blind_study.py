"""A few data sets of the blind study: an independent simulator makes them, the command reads them.

The study itself, `make blind`, has hundreds. These seeds are fixed and the verdicts were sound when
they were chosen, so this guards against falling back and gives no rate.
"""

import fcntl
import itertools
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from stickslip import Scenario
from stickslip.diagnosis.api import diagnose
from stickslip.diagnosis.model.simulator import Simulator
from stickslip.diagnosis.report.json_keys import summary
from stickslip.measurement import read_measurement

sys.path.append(str(Path(__file__).resolve().parents[1] / "bench"))

from blind import apparatus, case
from blind.__main__ import main
from blind.case import study
from blind.generator import make, write_case
from blind.scoring import calibration, interval, judged, read, table
from blind.strength import PRIORS

ROOT = Path(__file__).resolve().parents[1]


def _said(folder, kind, seed):
    answer = write_case(folder, kind, seed)
    measurement = read_measurement(folder / "measurement.toml")
    found = diagnose(measurement)
    said = summary(found.findings, found.posed, measurement, [])
    cause = said["cause"]
    names = set() if cause is None else {cause} if isinstance(cause, str) else set(cause)
    return answer, said, names


def test_the_generator_agrees_with_the_core_where_nothing_is_hidden():
    for seed in (31, 32):
        truth, drives, level, _, _ = make("none", seed)
        settings = [
            {**{f"drive.{key}": value for key, value in drive.items()},
             "drive.pulses": apparatus.PULSES}
            for drive in drives
        ]  # fmt: skip
        values = [[truth.constants[name.split(".")[1]] for name in PRIORS]]
        core = Simulator(Scenario().replace({"solver.rtol": 1e-8}), list(PRIORS))
        gap = level - core(settings, np.array(values))[0]
        sd = np.hypot(apparatus.SCATTER * level, apparatus.FLOOR) / np.sqrt(apparatus.TRIALS)
        assert np.max(np.abs(gap) / sd) < 0.2


@pytest.mark.slow
def test_files_of_a_data_set_do_not_contain_the_answer(tmp_path):
    answer = write_case(tmp_path / "a", "single", 2006)
    text = "".join(path.read_text() for path in (tmp_path / "a").iterdir())
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == [
        "measurement.toml", "nominal.toml", "velocity.csv",
    ]  # fmt: skip
    assert answer["answer"]
    assert all(name not in text for name in answer["answer"])


@pytest.mark.slow
def test_a_data_set_without_a_cause_gives_none(tmp_path):
    _, said, _ = _said(tmp_path, "none", 2003)
    assert said["verdict"] == "none"
    assert said["bounds"]


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "group"), [(2006, "surface"), (2001, "contact"), (2012, "fluid")])
def test_a_single_cause_is_ranked_first(tmp_path, seed, group):
    answer, said, names = _said(tmp_path, "single", seed)
    assert set(answer["answer"]) <= names
    assert said["verdict"] in ("named", "ambiguous")
    chance = {name: p for name, p in said["probabilities"].items() if name != "unknown"}
    assert max(chance, key=chance.get) == answer["answer"][0]


@pytest.mark.slow
def test_exact_twins_are_never_told_apart(tmp_path):
    _, said, names = _said(tmp_path, "exact twins", 2003)
    assert said["verdict"] == "ambiguous"
    assert {"length_scale", "clock_scale"} <= names


@pytest.mark.slow
def test_near_twins_are_told_apart_by_the_proposed_experiments(tmp_path):
    row = study(tmp_path / "data" / "before", "near twins", 2011)
    assert row["said"]["verdict"] == "ambiguous"
    assert {"surface_tilt", "friction_anisotropy"} <= set(row["said"]["cause"])
    # A condition and its mirror image say the same.
    foreseen = [[abs(p["velocity"]) for p in each["predictions"].values()]
                for each in row["said"]["next_experiments"]]  # fmt: skip
    assert not any(np.allclose(a, b) for a, b in itertools.combinations(foreseen, 2))
    before, after = (tmp_path / "data" / name for name in ("before", "before-more"))
    assert (after / "velocity.csv").read_bytes() == (before / "velocity.csv").read_bytes()
    assert len((after / "proposed.csv").read_text().splitlines()) == 1 + 3 * apparatus.TRIALS
    assert row["followed"]["verdict"] == "named"
    assert row["followed"]["cause"] == "surface_tilt"
    angle = row["followed"]["parameters"]["surface_tilt.angle"]
    truth = row["answer"]["effects"]["surface_tilt"]["angle"]
    assert abs(angle["value"] - truth) < 3.0 * angle["sd"]


@pytest.mark.slow
def test_two_causes_are_given_as_a_pair_or_a_set(tmp_path):
    answer, _, names = _said(tmp_path, "pair", 2011)
    assert set(answer["answer"]) <= names


@pytest.mark.slow
def test_an_effect_outside_the_library_is_not_named(tmp_path):
    _, said, _ = _said(tmp_path, "unknown", 2003)
    assert said["verdict"] == "unexplained"
    assert said["parameters"] == {}


def test_a_data_set_is_made_once_and_has_its_own_answer(tmp_path, monkeypatch):
    made = []

    def write(folder, kind, seed):
        made.append(seed)
        if seed == 3:
            raise OSError("no space left")
        return {"kind": kind, "seed": seed}

    monkeypatch.setattr(case, "write_case", write)
    folder = tmp_path / "data" / "00000"
    assert case.make(folder, "none", 1) == case.make(folder, "none", 1)
    assert made == [1]
    with pytest.raises(RuntimeError, match="is the answer of none 1"):
        case.make(folder, "single", 2)
    other = tmp_path / "data" / "00001"
    with pytest.raises(OSError, match="space"):
        case.make(other, "none", 3)
    assert not case.sealed(other).exists()


def test_an_interrupted_study_is_continued(tmp_path, monkeypatch, capsys):
    record = tmp_path / "answers.jsonl"
    row = json.dumps(read(ROOT / "bench" / "blind" / "measured.jsonl")[0])
    record.write_text(row + "\n" + row[:100])
    seed = json.loads(row)["answer"]["seed"]
    arguments = ["blind", "--first", str(seed), "--seeds", "1", "--kinds", "none"]
    monkeypatch.setattr(sys, "argv", [*arguments, "--out", str(tmp_path)])
    main()
    # The row that was cut off is gone, the other one was not made again.
    assert record.read_text() == row + "\n"
    assert "false alarm" in capsys.readouterr().out
    assert not (tmp_path / "data").exists()
    with (tmp_path / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(SystemExit):
            main()
    assert "another study is at work there" in capsys.readouterr().err


def test_shares_come_with_exact_intervals():
    # Of n without any, the upper end p solves (1 - p)^n = 0.025.
    low, high = interval(0, 20)
    assert low == 0.0
    assert (1.0 - high) ** 20 == pytest.approx(0.025)
    row = {
        "answer": {"kind": "none", "answer": []},
        "said": {"verdict": "none", "cause": None, "probabilities": {}},
    }
    alarm = json.loads(json.dumps(row))
    alarm["said"]["verdict"] = "unexplained"
    (counted,) = judged([row, row, row, alarm])
    assert (counted["count"], counted["total"]) == (1, 4)


def test_calibration_counts_answers_by_their_probability():
    def row(kind, answer, chance):
        return {"answer": {"kind": kind, "answer": answer}, "said": {"probabilities": chance}}

    rows = [
        row("none", [], {"none": 0.9, "a": 0.1}),
        row("single", ["a"], {"none": 0.1, "a": 0.85, "b": 0.05}),
        row("single", ["a"], {"none": 0.1, "b": 0.9}),
        row("unknown", [], {"unknown": 1.0}),
        row("pair", ["a", "b"], {"a": 0.9, "none": 0.1}),
    ]
    high, sure = calibration(rows)
    assert (high["count"], high["total"]) == (2, 3)
    assert high["mean"] == pytest.approx((0.9 + 0.85 + 0.9) / 3)
    assert (sure["count"], sure["total"]) == (1, 1)


def test_the_documentation_has_the_numbers_of_the_record():
    rows = read(ROOT / "bench" / "blind" / "measured.jsonl")
    assert table(rows) in (ROOT / "docs" / "theory" / "diagnosis.md").read_text()
    counts = {(each["kind"], each["what"]): each for each in judged(rows)}
    said = " ".join((ROOT / "README.md").read_text().split())
    for kind, what, words in (
        ("single", "first in rank", "first in rank in {count} of {total}"),
        ("single", "named", "named in {count}"),
        ("single", "right when named", "rightly in {count}"),
        ("none", "false alarm", "a false alarm came in {count} of {total}"),
        ("pair", "exact pair", "pairs were found in {count} of {total}"),
        ("weak", "detected", "were detected in {count} of {total}"),
    ):
        assert words.format(**counts[kind, what]) in said, (kind, what)
    assert f"{len(rows)} data sets" in said
