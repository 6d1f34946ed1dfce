"""Plans of what to measure first: what they promise holds by brute force, and they can be used."""

import numpy as np
import pandas as pd
import pytest

from command_line import stickslip
from made_measurement import few_causes
from stickslip import (
    Drive,
    Measurement,
    Robot,
    Scenario,
    diagnose,
    read_measurement,
    simulate_batch,
)
from stickslip.walker.planning import FILES, _chosen, _distances, plan

PRIORS = {
    "contact.kinetic_friction": {"mean": 0.145, "sd": 0.01},
    "drag.linear": {"low": 3e-6, "high": 3e-5},
}
NOMINAL = Scenario(drive=Drive(base=0.5e-3, pulses=8), uncertain=PRIORS)
ANISOTROPY = {"effects.friction_anisotropy.fraction": 0.2}


@pytest.fixture(scope="module", autouse=True)
def _few():
    with pytest.MonkeyPatch.context() as patch:
        few_causes(patch, ("friction_anisotropy", "surface_tilt", "stribeck_friction"))
        yield


@pytest.fixture(scope="module")
def planned():
    return plan(NOMINAL, 8, noise=0.02)


def test_told_apart_is_the_least_distance_over_sizes_and_constants():
    random = np.random.default_rng(1)
    slopes, gaps = random.standard_normal((2, 6)), random.standard_normal((3, 6))
    variance = random.uniform(0.1, 1.0, 6)
    apart, seen = _distances(slopes, gaps, variance)
    weights = np.sqrt(np.concatenate([1.0 / variance, np.ones(2)]))

    def least(target, *free):
        """Misfit and prior after the constants, and the sizes of other causes, are fitted."""
        padded = [np.append(each, np.zeros(2)) for each in (target, *free)]
        constants = np.vstack([slopes.T, np.eye(2)])
        design = np.column_stack([constants, *padded[1:]]) * weights[:, None]
        return np.linalg.lstsq(design, padded[0] * weights, rcond=None)[1][0]

    for i in range(3):
        assert seen[i] == pytest.approx(least(gaps[i]))
        for j in set(range(3)) - {i}:
            both = least(gaps[i], gaps[j]), least(gaps[j], gaps[i])
            assert apart[i, j] == pytest.approx(min(both))


def test_chosen_drives_are_hardly_worse_than_the_best_of_all():
    random = np.random.default_rng(2)
    slopes, gaps = random.standard_normal((1, 9)), 2.0 * random.standard_normal((6, 9))
    variance = np.ones(9)

    def told(rows):
        apart, seen = _distances(slopes[:, rows], gaps[:, rows], variance[rows])
        return np.sum(seen > 4.0) + np.sum(np.triu(apart, 1) > 4.0)

    every = [[i, j, k] for i in range(9) for j in range(i) for k in range(j)]
    best = max(told(rows) for rows in every)
    assert told(_chosen(slopes, gaps, variance, range(9), 3)) >= 0.9 * best


def test_a_plan_has_each_drive_once_in_each_block(planned):
    table = planned.table()
    settings = ["mode", "direction", "frequency", "peak", "hold", "edge"]
    assert len(table) == 24
    assert table["order"].tolist() == list(range(1, 25))
    for _, block in table.groupby("block"):
        assert len(block[settings].drop_duplicates()) == 8
    orders = [block[settings].to_numpy().tolist() for _, block in table.groupby("block")]
    assert orders[0] != orders[1]
    assert table["velocity"].isna().all()


def test_what_a_plan_cannot_do_it_says(planned):
    # A scale and a clock of a camera both multiply every velocity.
    assert ("length_scale", "clock_scale") in planned.alike
    page = planned.protocol()
    assert "Film a clock" in page
    assert len(page.split()) < 700  # a page
    rough = plan(NOMINAL, 4, noise=0.5)
    assert rough.seen.sum() < planned.seen.sum()


@pytest.mark.parametrize(
    ("friction", "left_out"),
    [
        ({"mean": 0.17, "sd": 0.03}, []),  # three errors more are above the static one
        ({"mean": 0.198, "sd": 0.01}, []),  # and so is half of one
        ({"mean": 0.15, "sd": 1.0}, ["contact.kinetic_friction"]),
    ],
)
@pytest.mark.daily("friction2")
def test_a_change_that_cannot_be_is_smaller_or_reversed_or_left_out(friction, left_out):
    made = plan(NOMINAL.with_uncertain({"contact.kinetic_friction": friction}), 2)
    assert made.left_out == left_out
    assert ("contact.kinetic_friction" in made.causes) is not bool(left_out)
    assert ("Left out" in made.protocol()) is bool(left_out)


@pytest.fixture
def filled_in(planned, tmp_path):
    """The measurement that a plan's files make once velocities are in them."""
    planned.save(tmp_path)
    table = pd.read_csv(tmp_path / "velocity.csv")
    truth = NOMINAL.with_uncertain(None).replace(ANISOTROPY)
    names = ["mode", "direction", "frequency", "peak", "hold", "edge"]
    drives = [{f"drive.{name}": row[name] for name in names} for _, row in table.iterrows()]
    random = np.random.default_rng(3)
    found = np.array([run.mean_velocity for run in simulate_batch(map(truth.replace, drives))])
    table["velocity"] = found * (1.0 + 0.02 * random.standard_normal(len(found)))
    table.loc[5, "velocity"] = np.nan  # that trial was lost
    table.to_csv(tmp_path / "velocity.csv", index=False)
    return read_measurement(tmp_path / "measurement.toml")


def test_a_plan_that_is_filled_in_is_a_measurement(filled_in, tmp_path):
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted(FILES)
    assert isinstance(filled_in, Measurement)
    assert dict(filled_in.uncertain) == dict(NOMINAL.uncertain.priors)
    (data,) = filled_in.velocity
    assert len(data.velocity) == 23


@pytest.mark.nightly
def test_a_plan_that_is_filled_in_is_diagnosed(filled_in):
    verdict = diagnose(filled_in, threads=1).verdict
    assert (verdict.kind, verdict.causes) == ("named", ("friction_anisotropy",))


@pytest.mark.parametrize(
    ("scenario", "more", "words"),
    [("s.toml", {}, "a Scenario"),
     (NOMINAL, {"count": 1}, "count = 1"),
     (NOMINAL, {"count": 10_000}, "allowed are at most"),
     (NOMINAL, {"noise": 0.0}, "noise = 0.0"),
     (NOMINAL, {"noise": 5}, "noise = 5: allowed is a number above 0 and below 1"),
     (NOMINAL, {"trials": 0}, "trials = 0"),
     (Scenario(robot=Robot(magnetization=0.0)), {}, "does not move"),
     (NOMINAL.with_uncertain({"contact.kinetic_friction": {"mean": 0.15, "sd": 9.0}}), {},
      "contact.kinetic_friction: an eighth of its stated error")],
)  # fmt: skip
def test_what_cannot_be_planned_is_refused(scenario, more, words):
    with pytest.raises(ValueError, match=words):
        plan(scenario, **more)


def test_the_command_writes_a_plan_once(tmp_path):
    NOMINAL.with_uncertain(None).to_toml(tmp_path / "s.toml")
    arguments = ["diagnose", "--plan", "3", "s.toml", "--out", "first"]
    done = stickslip(*arguments, cwd=tmp_path)
    assert done.returncode == 0
    assert "causes would be seen" in done.stdout
    assert "nothing is uncertain" in done.stderr
    assert {each.name for each in (tmp_path / "first").iterdir()} == {*FILES}
    again = stickslip(*arguments, cwd=tmp_path)
    assert again.returncode == 2
    assert "choose another folder" in again.stderr
    for more in (["--json"], ["--next", "1"], ["--noise", "0"], ["--noise", "5"]):
        assert stickslip(*arguments[:-1], "second", *more, cwd=tmp_path).returncode == 2
    assert stickslip("diagnose", "s.toml", "--noise", "0.1", cwd=tmp_path).returncode == 2
