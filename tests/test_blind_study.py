"""A few data sets of the blind study: an independent simulator made them, the diagnosis reads them.

The walkers of `python -m bench score` are others. These seeds are fixed and the verdicts were
sound when they were chosen, so this guards against falling back and gives no rate.
"""

import itertools
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from blind.generator import make
from blind.kinds import KINDS
from blind.noise import trials
from blind.readings import velocities
from blind.settings import FLOOR, PULSES, SCATTER, TRIALS, priors
from blind.truth import Truth
from blind.writing import KEYS, _rows

from stickslip import Drive, Scenario, diagnose, read_measurement, simulate_batch
from stickslip.walker import problem as measured

DATA = Path(__file__).with_name("data") / "blind"
TWINS = 20002  # seed of near twins
PRIORS = priors(("velocity",))


def _answer(name):
    return json.loads((DATA / "answers" / f"{name}.json").read_text())


def _said(kind, seed):
    """The answer of a stored data set, what is said of the set, and which causes that names."""
    name = f"{kind.replace(' ', '-')}-{seed}"
    found = diagnose(read_measurement(DATA / name / "measurement.toml"))
    return _answer(name), found.as_dict(), set(found.verdict.causes)


@pytest.mark.nightly
def test_the_generator_agrees_with_the_core_where_nothing_is_hidden():
    made = make("none", 31)
    level, truth = made.level.velocity, made.truth
    constants = {name: truth.constants[name] for name in PRIORS}
    core = simulate_batch(
        [Scenario(drive=Drive(**drive, pulses=PULSES)).replace(constants) for drive in made.drives]
    )
    gap = level - [run.mean_velocity for run in core]
    sd = np.hypot(SCATTER * level, FLOOR) / np.sqrt(TRIALS)
    assert np.max(np.abs(gap) / sd) < 0.2


CLAIMED = ("named", "dominant", "ambiguous")
SETS = [
    ("none", 20001, ("none",)),
    ("single", 20018, CLAIMED),
    ("single", 20009, CLAIMED),
    ("exact twins", 9051, ("ambiguous",)),
    ("hiding", 20001, ("pair", *CLAIMED)),
    ("unknown", 20001, ("unexplained",)),
]


@pytest.mark.nightly
@pytest.mark.parametrize(("kind", "seed", "verdicts"), SETS)
def test_what_is_hidden_is_in_what_is_said(kind, seed, verdicts, monkeypatch):
    if kind == "unknown":  # a law of a free shape may take what no cause does
        monkeypatch.setattr(measured, "_laws", lambda *given: ())
    answer, said, names = _said(kind, seed)
    assert said["verdict"] in verdicts
    assert names >= set(answer["answer"])
    assert not names or answer["answer"]
    if kind == "single":
        chance = {name: p for name, p in said["probabilities"].items() if name != "unknown"}
        assert [max(chance, key=chance.get)] == answer["answer"]
    elif kind == "exact twins":
        assert names >= {"length_scale", "clock_scale"}


def write_more(folder, more, answer, drives):
    """Write `more`: the data of `folder`, and a table of the same robot at further settings."""
    truth, keys = Truth.of(answer), (*KEYS, "edge")
    chosen = [{key: each[key] for key in keys} for each in drives]
    random = np.random.default_rng([answer["seed"], len(drives), 1])
    noise = KINDS[truth.kind].noise
    values, _ = trials(velocities(truth, chosen), chosen, noise, truth.correlation, random)
    shutil.copytree(folder, more, dirs_exist_ok=True)
    lines = [",".join(["velocity", "trial", *keys]), *_rows(chosen, values, None, keys)]
    (more / "proposed.csv").write_text("\n".join(lines) + "\n")
    with (more / "measurement.toml").open("a") as file:
        file.write('\n[[velocity]]\nfile = "proposed.csv"\n')


@pytest.mark.nightly
def test_near_twins_are_told_apart_by_the_proposed_experiments(tmp_path):
    before, after = DATA / f"near-twins-{TWINS}", tmp_path / "after"
    answer, said, names = _said("near twins", TWINS)
    assert said["verdict"] == "ambiguous"
    assert {"surface_tilt", "friction_anisotropy"} <= names
    # A condition and its mirror image say the same.
    proposed = said["next_experiments"]
    foreseen = [[abs(p["velocity"]) for p in each["predictions"].values()] for each in proposed]
    assert not any(np.allclose(a, b) for a, b in itertools.combinations(foreseen, 2))
    write_more(before, after, answer, [each["drive"] for each in proposed])
    assert (after / "velocity.csv").read_bytes() == (before / "velocity.csv").read_bytes()
    assert len((after / "proposed.csv").read_text().splitlines()) == 1 + 3 * TRIALS
    followed = diagnose(read_measurement(after / "measurement.toml")).as_dict()
    assert (followed["verdict"], [followed["cause"]]) == ("named", list(answer["answer"]))
    ((effect, parameters),) = answer["effects"].items()
    ((parameter, truth),) = parameters.items()
    found = followed["parameters"][f"{effect}.{parameter}"]
    assert abs(found["value"] - truth) < 3.0 * found["sd"]
