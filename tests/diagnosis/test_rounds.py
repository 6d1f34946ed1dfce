"""A diagnosis and its experiments in turns."""

import numpy as np
import pandas as pd
import pytest

from asking_results import NOMINAL, OLD, SAFE, UNSAFE, asking, experiments, measurement
from stickslip import Measurement, Prior, ScenarioError, diagnose_in_rounds, simulate
from stickslip.walker import rounds
from stickslip.walker.experiments import PROPOSED
from stickslip.walker.rounds import BUDGET


@pytest.fixture
def diagnosed(monkeypatch):
    """Measurements that were diagnosed; the name is safe when there are more tables than this."""
    seen, until = [], {"tables": 3}

    def diagnose(given, *, seed, threads, progress):
        seen.append(given)
        if progress is not None:
            progress(0.5, "testing")
        return asking(given, SAFE if len(given.velocity) > until["tables"] else UNSAFE)

    monkeypatch.setattr(rounds, "diagnose", diagnose)
    return seen, until


def test_rounds_end_when_a_name_is_safe(diagnosed):
    asked = []

    def measure(drive):
        asked.append(drive["frequency"])
        return [1e-3, float("nan"), (1.1 + 0.1 * len(asked)) * 1e-3]

    result, done = diagnose_in_rounds(measurement(), measure, budget=5)
    assert result.next_step == SAFE
    assert asked == [50.0] * 3
    # Gaps are no trials.
    assert [len(each.trials) for each in done] == [2, 2, 2]
    assert done[0].trials["velocity"].tolist() == pytest.approx([1e-3, 1.2e-3])
    assert done[0].trials["frequency"].tolist() == [50.0, 50.0]
    assert [each.result.next_step for each in done] == [UNSAFE] * 3
    assert [len(each.velocity) for each in diagnosed[0]] == [1, 2, 3, 4]


@pytest.mark.parametrize(
    ("budget", "at_once", "asked"), [(0, 1, 0), (2, 1, 2), (2, 3, 2), (3, 2, 3)]
)
def test_rounds_end_when_the_budget_is_used_up(diagnosed, budget, at_once, asked):
    diagnosed[1]["tables"] = 99
    given, speeds = measurement(), iter(np.linspace(1e-3, 2e-3, 9))
    result, done = diagnose_in_rounds(given, lambda _: next(speeds), budget=budget, at_once=at_once)
    assert result.next_step == UNSAFE
    assert sum(len(each.trials) for each in done) == asked
    assert len(diagnosed[0]) == len(done) + 1
    assert all(len(each.trials) <= at_once for each in done)


@pytest.mark.parametrize("nothing", [[], float("nan"), None])
def test_rounds_end_when_nothing_can_be_measured(diagnosed, nothing):
    result, done = diagnose_in_rounds(measurement(), lambda _: nothing, budget=3)
    assert (result.next_step, done, len(diagnosed[0])) == (UNSAFE, [], 1)


@pytest.mark.parametrize("known", [{}, {"block": "a"}, {"order": range(4)}])
def test_new_trials_have_a_set_up_and_an_order_where_others_have(known):
    table = asking(measurement(OLD.assign(**known))).trial_table(experiments(1), 2)
    assert set(table) & {"block", "order"} == set(known)
    # Of another block than all before, at a place in time that is to be filled in.
    if "block" in known:
        assert table["block"].tolist() == ["after-2"] * 2
    if "order" in known:
        assert table["order"].isna().all()


def test_the_progress_is_that_of_all_diagnoses(diagnosed):
    diagnosed[1]["tables"] = 2
    told, speeds = [], iter(np.linspace(1e-3, 2e-3, 9))
    diagnose_in_rounds(
        measurement(), lambda _: next(speeds), progress=lambda *each: told.append(each)
    )
    assert BUDGET == PROPOSED == 3
    assert told == [
        (0.125, "diagnosis 1: testing"), (0.375, "diagnosis 2: testing"),
        (0.625, "diagnosis 3: testing"), (1.0, "done"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("returned", "said"),
    [
        ("fast", "measure.*: allowed is numbers in m/s, one for each trial"),
        ([[1e-3]], "one for each trial"),
    ],
)
def test_what_measure_returns_is_checked(diagnosed, returned, said):
    with pytest.raises(ScenarioError, match=said):
        diagnose_in_rounds(measurement(), lambda _: returned)


@pytest.mark.nightly
def test_near_twins_are_told_apart_in_rounds():
    truth = NOMINAL.replace({"contact.kinetic_friction": 0.151, "effects.surface_tilt.angle": 0.04})
    random = np.random.default_rng(1)

    def measure(drive):
        settings = {f"drive.{name}": value for name, value in drive.items()}
        level = simulate(truth.replace(settings)).mean_velocity
        return level * (1 + 0.03 * random.standard_normal(3))

    paces = (20.0, 30.0, 40.0, 55.0, 75.0)
    rows = [{"frequency": f, "velocity": each} for f in paces for each in measure({"frequency": f})]
    uncertain = {
        "contact.kinetic_friction": Prior("normal", 0.145, 0.01),
        "drag.linear": Prior("log-uniform", 3e-6, 3e-5),
    }
    data = Measurement.from_dataframe(pd.DataFrame(rows), NOMINAL, uncertain)
    result, done = diagnose_in_rounds(data, measure)
    assert done[0].result.verdict.kind != "named"
    assert 1 <= len(done) <= 3
    assert len(result.measurement.velocity) == 1 + len(done)
    # What is claimed, at the end, has the truth in it.
    assert result.verdict.kind in ("named", "dominant", "ambiguous", "pair")
    assert "surface_tilt" in result.verdict.causes
