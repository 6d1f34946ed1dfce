"""Experiments in rounds: what is proposed, how it is filled in and read, and when it ends."""

import dataclasses
import json
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from command_line import stickslip
from made_measurement import write
from stickslip import Measurement, Prior, Scenario, diagnose_in_rounds, read_measurement, simulate
from stickslip.cli.next_table import PREDICTIONS, TABLE, with_measured
from stickslip.diagnosis import Experiment, rounds
from stickslip.diagnosis.inference import next_step as step
from stickslip.diagnosis.inference.verdict import ALIKE_MARGIN, MARGIN
from stickslip.diagnosis.next_trials import trial_table
from stickslip.errors import ScenarioError
from stickslip.facts import Code, Fact
from toy_model import shared_diagnosis

NOMINAL = Scenario().replace({"drive.mode": "OPP", "drive.base": 0.5e-3, "drive.pulses": 5})
OLD = pd.DataFrame({"frequency": [20.0, 20.0, 40.0, 40.0], "velocity": [1e-3, 1.1e-3, 2e-3, 2e-3]})
UNSAFE = Fact(Code.NO_SAFE_NAME, {"causes": ["a", "b"]})
SAFE = Fact(Code.NAME_SAFE, {"name": "a", "margin": MARGIN, "alike_margin": ALIKE_MARGIN})


def _measurement(table=OLD):
    return Measurement.from_dataframe(table, NOMINAL)


def _experiments(count, separation=9.0):
    """Drives of other frequencies, and what two candidates predict of them."""
    conditions = _measurement().velocity[0].conditions
    drive = {key.removeprefix("drive."): value for key, value in conditions[0].items()}
    predictions = {name: {"velocity": 1e-3, "sd": 1e-5} for name in ("a", "b")}
    return [
        Experiment({**drive, "frequency": 50.0 + 10.0 * k}, UNSAFE, separation, predictions)
        for k in range(count)
    ]


def _asking(data, said=UNSAFE, count=3):
    """A result that proposes, as far as rounds look at one."""
    proposed = [] if said.code is Code.NOTHING_TO_SEPARATE else _experiments(count)
    verdict = SimpleNamespace(kind="named", causes=("a",))
    return SimpleNamespace(
        measurement=data,
        next_step=said,
        propose_experiments=lambda most: proposed[:most],
        posed=SimpleNamespace(conditions=[*data.velocity[0].conditions]),
        findings=SimpleNamespace(verdict=verdict),
    )


def test_a_set_is_no_safe_name_and_one_clear_cause_is():
    assert step.next_step(shared_diagnosis(0, split=0.4)).code is Code.NO_SAFE_NAME
    found = shared_diagnosis(3, wave=1.0)
    said = step.next_step(found)
    assert said.code is Code.NAME_SAFE
    assert (said.fields["margin"], said.fields["alike_margin"]) == (MARGIN, ALIKE_MARGIN)


def test_a_name_is_not_safe_beside_a_near_rival(monkeypatch):
    found = shared_diagnosis(3, wave=1.0)
    name, fit = found.verdict.causes[0], found.verdict.fit
    others = [*found.ranking.singles, *found.ranking.pairs]
    lacking = [each for each in others if name not in each.name]
    lead = min(fit.priced_evidence - each.priced_evidence for each in lacking)
    monkeypatch.setattr(step, "MARGIN", lead + 1.0)
    said = step.next_step(found)
    assert said.code is Code.NEAR_RIVAL
    assert said.fields["lead"] == pytest.approx(lead)
    assert said.fields["needed"] == lead + 1.0
    monkeypatch.setattr(step, "MARGIN", lead - 1.0)
    assert step.next_step(found).code is Code.NAME_SAFE


def test_a_rival_with_like_effects_has_to_be_farther_behind(monkeypatch):
    found = shared_diagnosis(3, wave=1.0)
    fit = found.verdict.fit
    singles = [each for each in found.ranking.singles if each is not fit]
    lead = min(fit.log_evidence - each.log_evidence for each in singles)
    monkeypatch.setattr(step, "ALIKE_MARGIN", lead + 1.0)
    assert step.next_step(found).code is Code.NAME_SAFE
    alike = dataclasses.replace(found, cosines=np.ones_like(found.cosines))
    assert step.next_step(alike).fields["needed"] == lead + 1.0


def test_a_verdict_without_a_candidate_asks_for_nothing():
    said = step.next_step(shared_diagnosis(1))
    assert said.code is Code.NOTHING_TO_SEPARATE
    assert said.fields["verdict"] == "none"
    assert step.worth_measuring(said, _experiments(2)) == []


def test_only_experiments_that_can_decide_are_worth_measuring():
    useful, useless = _experiments(1), _experiments(1, 0.9 * step.LEAST_WORTH)
    assert step.worth_measuring(UNSAFE, [*useful, *useless]) == useful
    assert step.worth_measuring(SAFE, useful) == []


def test_a_table_of_trials_has_the_settings_that_differ_from_the_scenario():
    assert list(trial_table(_experiments(2), _measurement())) == [
        "mode", "direction", "frequency", "peak", "hold", "edge", "trial", "velocity",
    ]  # fmt: skip
    data = _measurement(OLD.assign(pulses=[5, 5, 5, 7], block=["a", "a", "b", "b"], order=range(4)))
    table = trial_table(_experiments(2), data)
    assert list(table)[6:] == ["pulses", "trial", "block", "order", "velocity"]
    assert table["trial"].tolist() == [1, 2, 3] * 2
    (block,) = set(table["block"])
    table["velocity"] = np.linspace(1e-3, 2e-3, len(table))
    (later,) = set(trial_table(_experiments(1), data.with_velocities(table))["block"])
    assert later != block
    assert table["order"].isna().all()


def test_new_trials_are_one_more_table_without_those_that_were_not_measured(tmp_path):
    data = _measurement()
    table = trial_table(_experiments(2), data)
    table.loc[[0, 2], "velocity"] = 1.5e-3, 1.6e-3
    table.to_csv(tmp_path / "more.csv", index=False)
    for given in (table, tmp_path / "more.csv"):
        more = data.with_velocities(given)
        assert more.velocity[0] is data.velocity[0]
        new = more.velocity[1]
        assert new.velocity.tolist() == [1.5e-3, 1.6e-3]
        assert [each["drive.frequency"] for each in new.conditions] == [50.0]
        assert np.isnan(new.relative_sd)


NEW = pd.DataFrame({"frequency": 50.0, "trial": [1, 2, 3], "velocity": [1e-3, 1.1e-3, 1.2e-3]})


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (NEW.assign(velocity=["1e-3", "0,9", "1e-3"]), 'row 1: velocity "0,9" is not .* in m/s'),
        (NEW.assign(frequency=[50.0, -1.0, 50.0]), r"row 1: drive.frequency = -1.0: allowed is"),
        (NEW.assign(frequency="fast"), 'rows 0, 1, 2: frequency "fast" is not a number'),
        (NEW.assign(velocity=[1e-3, 1e-3, 4.0]), "row 2: .* 1 m/s"),
        (NEW.assign(velocity=np.nan), "no row has a velocity; allowed is one or more"),
        (NEW.rename(columns={"velocity": "v"}), 'column "velocity" is missing'),
        (OLD.iloc[2:], "all its trials are in the measurement already"),
    ],
)
def test_a_row_that_is_not_sound_is_refused_in_one_line(table, said):
    with pytest.raises(ScenarioError, match=f"^DataFrame.*{said}") as error:
        _measurement().with_velocities(table)
    assert "\n" not in str(error.value)


@pytest.fixture
def folder(tmp_path):
    """A folder ``--out``, and a measurement."""
    return tmp_path, _measurement()


def test_what_was_filled_in_stays_as_it_is_and_new_drives_come_below(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 2, 3)
    begun.write(_asking(data))
    lines = (folder / TABLE).read_text().splitlines()
    assert len(lines) == 1 + 2 * 3
    predictions = pd.read_csv(folder / PREDICTIONS)
    assert predictions["candidate"].tolist() == ["a", "b"] * 2
    assert predictions["experiment"].tolist() == [1, 1, 2, 2]
    assert {"frequency", "velocity", "sd"} <= set(predictions)
    # A person fills in two trials of the first drive, as a person writes.
    noted = [lines[0], "# the second try", f"{lines[1]} 1.50e-3", *lines[2:3], f"{lines[3]}1.6e-3"]
    (folder / TABLE).write_text("\r\n".join([*noted, *lines[4:]]) + "\r\n", newline="")
    more, going = with_measured(data, folder, 2, 3)
    assert more.velocity[1].velocity.tolist() == [1.5e-3, 1.6e-3]
    assert (going.measured, going.trials) == (1, 2)
    going.write(_asking(more))
    written = (folder / TABLE).read_text().splitlines()
    assert written[:4] == [*noted[:3], noted[4]]
    assert len(written) == 4 + 2 * 3


def test_the_budget_is_counted_over_the_rounds_and_its_end_is_said(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 5, 2)
    assert len(begun.proposed(_asking(data))) == 2
    begun.write(_asking(data))
    table = pd.read_csv(folder / TABLE).assign(velocity=1e-3)
    table.to_csv(folder / TABLE, index=False)
    more, ended = with_measured(data, folder, 1, 2)
    assert ended.measured == 2
    assert ended.proposed(_asking(more)) == []
    text = "\n".join(ended.lines(_asking(more)))
    assert "the budget of 2 experiments is used up; --budget 3 allows more" in text
    before = (folder / TABLE).read_bytes()
    ended.write(_asking(more))
    assert (folder / TABLE).read_bytes() == before
    _, going = with_measured(data, folder, 1, 3)
    assert going.as_dict(_asking(more))["proposed"] == 1


def test_a_safe_name_is_said_to_be_safe_and_nothing_is_proposed(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 3, 3)
    begun.write(_asking(data, SAFE))
    assert not (folder / TABLE).exists()
    assert begun.lines(_asking(data, SAFE)) == [f"  {SAFE}"]
    said = begun.as_dict(_asking(data, SAFE))
    assert (said["safe"], said["proposed"], said["table"]) == (True, 0, None)


def test_what_to_measure_is_said_with_what_each_candidate_predicts(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 1, 3)
    text = "\n".join(begun.lines(_asking(data)))
    assert f"1 experiment, in {folder / TABLE}; 0 of at most 3 measured" in text
    assert "1. frequency 50 Hz" in text
    assert "1.000 +- 0.010 mm/s with a; 1.000 +- 0.010 mm/s with b" in text


def test_a_table_of_another_measurement_is_refused(folder):
    folder, data = folder
    _, begun = with_measured(data, folder, 1, 3)
    begun.write(_asking(data))
    (folder / "report.json").write_text(json.dumps({"name": "glass"}))
    with pytest.raises(ScenarioError, match='is of another measurement, "glass"'):
        with_measured(data, folder, 1, 3)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("IPP,-x,50,2.5e-3,1e-3,rise,1,1.1 mm/s", 'next.csv line 2: velocity "1.1 mm/s" is not'),
        ("IPP,-x,fast,2.5e-3,1e-3,rise,1,1e-3", 'next.csv line 2: frequency "fast" is not'),
        ("IPP,x,50,2.5e-3,1e-3,rise,1,1e-3", r"next.csv line 2: drive.direction = \"x\": allowed"),
    ],
)
def test_bad_rows_of_the_table_are_one_line_and_exit_code_two(tmp_path, rows, said):
    path = write(tmp_path, {})
    (tmp_path / "found").mkdir()
    header = "mode,direction,frequency,peak,hold,edge,trial,velocity"
    (tmp_path / "found" / TABLE).write_text(f"{header}\n{rows}\n")
    done = stickslip("diagnose", path, "--out", tmp_path / "found", "--next", 1)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert said.replace("\\", "") in line


def test_a_column_that_was_taken_away_is_missed(tmp_path):
    data = read_measurement(write(tmp_path, {}))
    (tmp_path / TABLE).write_text("frequency,velocity\n50,1e-3\n")
    with pytest.raises(ScenarioError, match='column "mode" is missing'):
        with_measured(data, tmp_path, 1, 3)


def test_a_budget_without_next_is_refused():
    done = stickslip("diagnose", "m.toml", "--budget", 2)
    assert done.returncode == 2
    assert "--budget" in done.stderr


def test_without_a_finding_nothing_is_proposed(tmp_path):
    path, found = write(tmp_path, {}), tmp_path / "found"
    done = stickslip("diagnose", path, "--out", found, "--next", 2, "--seed", 3, "--json")
    said = json.loads(done.stdout)
    assert said["verdict"] == "none"
    assert said["next"] == {
        "safe": False, "why": str(Fact(Code.NOTHING_TO_SEPARATE, {"verdict": "none"})),
        "proposed": 0, "measured": 0, "budget": 3, "table": None,
    }  # fmt: skip
    assert not (found / TABLE).exists()


def test_a_table_that_is_not_read_is_mentioned(tmp_path):
    path, found = write(tmp_path, {}), tmp_path / "found"
    head, *rows = (tmp_path / "velocity.csv").read_text().splitlines()
    (tmp_path / "velocity.csv").write_text("\n".join([head, *rows[:3]]) + "\n")
    found.mkdir()
    (found / TABLE).write_text("never read")
    done = stickslip("diagnose", path, "--out", found)
    assert done.stdout.startswith("data-problem")
    assert f"{found / TABLE} is not read, as --next is not given" in done.stderr


@pytest.fixture
def diagnosed(monkeypatch):
    """Measurements that were diagnosed; the verdict is ambiguous up to this many tables."""
    seen = []
    until = {"tables": 3}

    def diagnose(measurement, **_):
        seen.append(measurement)
        done = len(measurement.velocity) > until["tables"]
        return _asking(measurement, SAFE if done else UNSAFE)

    monkeypatch.setattr(rounds, "diagnose", diagnose)
    return seen, until


def test_rounds_end_when_a_name_is_safe(diagnosed):
    asked = []

    def measure(drive):
        asked.append(drive["frequency"])
        return [1e-3, float("nan"), (1.1 + 0.1 * len(asked)) * 1e-3]

    result, done = diagnose_in_rounds(_measurement(), measure, budget=5)
    assert result.next_step is SAFE
    assert asked == [50.0] * 3
    assert [len(each.trials) for each in done] == [2, 2, 2]
    assert [each.result.next_step for each in done] == [UNSAFE] * 3
    assert len(result.measurement.velocity) == 4


@pytest.mark.parametrize(("budget", "at_once", "asked"), [(0, 1, 0), (2, 1, 2), (2, 3, 2)])
def test_rounds_end_when_the_budget_is_used_up(diagnosed, budget, at_once, asked):
    speeds = iter(np.linspace(1e-3, 2e-3, 9))
    result, done = diagnose_in_rounds(
        _measurement(), lambda _: next(speeds), budget=budget, at_once=at_once
    )
    assert result.next_step is UNSAFE
    assert sum(len(each.trials) for each in done) == asked
    assert len(diagnosed[0]) == len(done) + 1


def test_rounds_end_when_nothing_can_be_measured(diagnosed):
    result, done = diagnose_in_rounds(_measurement(), lambda _: [], budget=3, at_once=2)
    assert (result.next_step, done, len(diagnosed[0])) == (UNSAFE, [], 1)


@pytest.mark.parametrize(
    ("measure", "more", "said"),
    [
        (lambda _: "fast", {}, 'measure.*: allowed are numbers in m/s, one for each trial'),
        (lambda _: [[1e-3]], {}, "one for each trial"),
        (3.0, {}, "measure = 3.0: allowed is a function of a drive"),
        (lambda _: 1e-3, {"budget": -1}, "budget = -1: allowed is a whole number from 0"),
        (lambda _: 1e-3, {"at_once": 0}, "at_once = 0: allowed is a whole number from 1"),
    ],
)  # fmt: skip
def test_what_measure_returns_and_numbers_are_checked(diagnosed, measure, more, said):
    with pytest.raises(ScenarioError, match=said):
        diagnose_in_rounds(_measurement(), measure, **more)


@pytest.mark.slow
def test_near_twins_are_told_apart_in_rounds():
    truth = NOMINAL.replace({"contact.kinetic_friction": 0.151, "effects.surface_tilt.angle": 0.04})
    random = np.random.default_rng(1)

    def measure(drive):
        settings = {f"drive.{name}": value for name, value in drive.items()}
        level = simulate(truth.replace(settings)).mean_velocity
        return level * (1 + 0.03 * random.standard_normal(3))

    rows = [
        {"frequency": f, "velocity": velocity}
        for f in (20.0, 30.0, 40.0, 55.0, 75.0)
        for velocity in measure({"frequency": f})
    ]
    uncertain = {
        "contact.kinetic_friction": Prior("normal", 0.145, 0.01),
        "drag.linear": Prior("log-uniform", 3e-6, 3e-5),
    }
    data = Measurement.from_dataframe(pd.DataFrame(rows), NOMINAL, uncertain)
    told = []
    result, done = diagnose_in_rounds(
        data, measure, progress=lambda fraction, stage: told.append((fraction, stage))
    )
    first = done[0].result.verdict
    assert first.kind == "ambiguous"
    assert {"surface_tilt", "friction_anisotropy"} <= set(first.causes)
    assert (result.verdict.kind, result.verdict.causes) == ("named", ("surface_tilt",))
    assert result.next_step.code is Code.NAME_SAFE
    assert len(result.next_trials()) == 0
    assert 1 <= len(done) <= 3
    assert len(result.measurement.velocity) == 1 + len(done)
    assert [fraction for fraction, _ in told] == sorted(fraction for fraction, _ in told)
    assert told[-1][0] == 1.0
