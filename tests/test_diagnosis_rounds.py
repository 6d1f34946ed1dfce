"""Experiments in rounds: what is proposed, how it is filled in and read, and when it ends."""

import numpy as np
import pandas as pd
import pytest

from asking_results import NOMINAL, OLD, SAFE, UNSAFE, asking, experiments, measurement
from stickslip import Measurement, Prior, diagnose_in_rounds, simulate
from stickslip.diagnosis import rounds
from stickslip.diagnosis.inference import next_step as step
from stickslip.diagnosis.inference.verdict import MARGIN
from stickslip.diagnosis.next_trials import trial_table
from stickslip.errors import ScenarioError
from stickslip.facts import Code
from toy_model import shared_diagnosis


def test_a_set_is_no_safe_name_and_one_clear_cause_is():
    assert step.next_step(shared_diagnosis(0, split=0.4)).code is Code.NO_SAFE_NAME
    found = shared_diagnosis(3, wave=1.0)
    said = step.next_step(found)
    assert said.code is Code.NAME_SAFE
    assert said.fields["margin"] == MARGIN


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


def test_a_verdict_without_a_candidate_asks_for_nothing():
    said = step.next_step(shared_diagnosis(1))
    assert said.code is Code.NOTHING_TO_SEPARATE
    assert said.fields["verdict"] == "none"
    assert step.worth_measuring(said, experiments(2)) == []


def test_only_experiments_that_can_decide_are_worth_measuring():
    useful, useless = experiments(1), experiments(1, 0.9 * step.LEAST_WORTH)
    assert step.worth_measuring(UNSAFE, [*useful, *useless]) == useful
    assert step.worth_measuring(SAFE, useful) == []


def test_a_table_of_trials_has_the_settings_that_differ_from_the_scenario():
    assert list(trial_table(experiments(2), measurement())) == [
        "mode", "direction", "frequency", "peak", "hold", "edge", "trial", "velocity",
    ]  # fmt: skip
    data = measurement(OLD.assign(pulses=[5, 5, 5, 7], block=["a", "a", "b", "b"], order=range(4)))
    table = trial_table(experiments(2), data)
    assert list(table)[6:] == ["pulses", "trial", "block", "order", "velocity"]
    assert table["trial"].tolist() == [1, 2, 3] * 2
    (block,) = set(table["block"])
    table["velocity"] = np.linspace(1e-3, 2e-3, len(table))
    (later,) = set(trial_table(experiments(1), data.with_velocities(table))["block"])
    assert later != block
    assert table["order"].isna().all()


def test_new_trials_are_one_more_table_without_those_that_were_not_measured(tmp_path):
    data = measurement()
    table = trial_table(experiments(2), data)
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
        measurement().with_velocities(table)
    assert "\n" not in str(error.value)


@pytest.fixture
def diagnosed(monkeypatch):
    """Measurements that were diagnosed; the verdict is ambiguous up to this many tables."""
    seen = []
    until = {"tables": 3}

    def diagnose(given, **_):
        seen.append(given)
        done = len(given.velocity) > until["tables"]
        return asking(given, SAFE if done else UNSAFE)

    monkeypatch.setattr(rounds, "diagnose", diagnose)
    return seen, until


def test_rounds_end_when_a_name_is_safe(diagnosed):
    asked = []

    def measure(drive):
        asked.append(drive["frequency"])
        return [1e-3, float("nan"), (1.1 + 0.1 * len(asked)) * 1e-3]

    result, done = diagnose_in_rounds(measurement(), measure, budget=5)
    assert result.next_step is SAFE
    assert asked == [50.0] * 3
    assert [len(each.trials) for each in done] == [2, 2, 2]
    assert [each.result.next_step for each in done] == [UNSAFE] * 3
    assert len(result.measurement.velocity) == 4


@pytest.mark.parametrize(("budget", "at_once", "asked"), [(0, 1, 0), (2, 1, 2), (2, 3, 2)])
def test_rounds_end_when_the_budget_is_used_up(diagnosed, budget, at_once, asked):
    speeds = iter(np.linspace(1e-3, 2e-3, 9))
    result, done = diagnose_in_rounds(
        measurement(), lambda _: next(speeds), budget=budget, at_once=at_once
    )
    assert result.next_step is UNSAFE
    assert sum(len(each.trials) for each in done) == asked
    assert len(diagnosed[0]) == len(done) + 1


def test_rounds_end_when_nothing_can_be_measured(diagnosed):
    result, done = diagnose_in_rounds(measurement(), lambda _: [], budget=3, at_once=2)
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
        diagnose_in_rounds(measurement(), measure, **more)


@pytest.mark.nightly
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
