"""The benchmark of named causes: its sets, tools and counts."""

import json

import numpy as np
import pytest
from causes import make, walkers
from causes.__main__ import ANSWERS
from causes.tools import TOOLS, asked

from stickslip import Series, diagnose_model, models


def test_every_set_is_asked_and_told_apart_from_its_truth():
    truths = json.loads(make.TRUTH.read_text())
    assert {name for name, _ in asked()} == set(truths)
    for group in ("", "walker"):
        own = [each for name, each in truths.items() if name.startswith("walker") is bool(group)]
        listed = [each for each in own if each["listed"]]
        assert sum(not each["cause"] for each in listed) == len(listed) / 4
        assert sum(each["model_error"] for each in listed) == len(listed) / 4
    for path in ANSWERS.glob("*.json"):
        answers = json.loads(path.read_text())
        assert set(answers) <= set(truths)


@pytest.mark.parametrize("tool", ["best BIC", "stepwise F"])
@pytest.mark.parametrize("name", ["thermal-01", "pendulum-02"])
@pytest.mark.daily("thermal")
def test_a_stored_answer_is_that_of_its_tool(tool, name):
    stored = json.loads((ANSWERS / f"{tool.replace(' ', '-')}.json").read_text())[name]
    answer = TOOLS[tool](dict(asked())[name]())
    assert answer == {key: stored[key] for key in ("said", "causes")}


def test_a_set_is_what_its_seed_makes():
    log, told, truth = make.made("pendulum", 2)
    assert (make.FOLDER / "pendulum-02" / "log.csv").read_text() == log
    stored = json.loads(make.TRUTH.read_text())["pendulum-02"]
    assert (told["kind"], stored) == ("pendulum", {**truth, "listed": True})


@pytest.mark.nightly
def test_a_walker_is_what_its_seed_makes():
    files, _ = walkers.made(2)
    for name, text in files.items():
        assert (make.FOLDER / "walker-02" / name).read_text() == text


@pytest.mark.parametrize(
    ("armature", "inertia", "said"),
    [
        (0.005, 0.02, ("named", ["armature"])),
        (0.005, (0.02, 0.001), ("ambiguous", ["armature", "inertia"])),
        (0.0, 0.02, ("none", [])),
    ],
)
@pytest.mark.daily("said0", "said2")
def test_an_armature_is_told_as_far_as_the_inertia_of_the_load_is_known(armature, inertia, said):
    own, random = make.KINDS["servo"], np.random.default_rng([81, 3])
    t = own["step"] * np.arange(120)
    goal = 0.8 * np.repeat(random.uniform(-1.0, 1.0, 12), 10)
    stated = {name: value for name, (value, _) in own["constants"].items()}
    hidden = {**stated, **own["known"], "start": 0.0, "armature": armature}
    y = make.simulated("servo", hidden, t, goal) + 0.004 * random.standard_normal(len(t))
    known = {**own["known"], "inertia": inertia}
    priors = {name: (value, part * value) for name, (value, part) in own["constants"].items()}
    log = Series(t, y, {"goal": goal}, unit="rad")
    every = models.servo(**known, **priors).terms(log)[1]
    less = {one.name for one in every} - {"armature", "load_friction"}
    found = diagnose_model(models.servo(**known, **priors, without=[*less]), log).verdict
    assert (found.kind, sorted(found.causes)) == said


def test_a_cause_that_is_not_listed_is_none_of_a_walker():
    listed, without = (
        dict(asked())[name]().problem for name in ("walker-02", "walker-02 unlisted")
    )
    gone = {each.name for each in listed.causes} - {each.name for each in without.causes}
    assert gone == {"friction_anisotropy"}
    stated = [each.model(each.physical(np.zeros((1, each.size)))) for each in (listed, without)]
    assert np.allclose(*stated, rtol=1e-3, atol=1e-6)
