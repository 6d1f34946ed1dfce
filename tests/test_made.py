"""Logs of known truth: names, signs, sizes and strengths mean what they mean in the package.

Without errors of readings its models agree with the integrators that make the logs. They get inputs
at denser times here, since for lags they take lines between readings.
"""

import numpy as np
import pytest
from score import made, question, unlisted

from stickslip.diagnosis.model import bare_problem

DENSE = 8  # times for a reading
ABSENT = {"saturation": np.inf, "duty_limit": np.inf}


def predictions(problem, changes):
    """Readings that the package predicts with the true values, of which some are changed."""
    t = np.arange((made.COUNT - 1) * DENSE + 1) * np.diff(problem.t)[0] / DENSE
    rows = np.arange(len(t)) // DENSE
    inputs = {name: values[rows] for name, values in problem.inputs.items()}
    dense = problem._replace(t=t, y=np.interp(t, problem.t, problem.y), inputs=inputs)
    model, log = question(dense)
    posed = bare_problem(log, model, *model.terms(log))
    assert {*problem.size} <= {*posed.names}
    true = {each.name: each.middle for each in posed.parameters} | problem.constants
    start = {name: problem.constants["start"] for name in ("start_position", "start_temperature")}
    values = [[(true | start | change)[name] for name in posed.names] for change in changes]
    return posed.model(np.array(values))[:, ::DENSE]


def strength(problem):
    """Of the cause, with slopes by the package; the readings with the cause."""
    (cause, *_), told = problem.size, problem.by == "stated"
    none = {cause: problem.stated.get(cause, (ABSENT.get(cause, 0.0),))[0]}
    sd, ten = 3.0 * problem.sd, 10.0 * np.diff(problem.t)[0]
    place = sd * (ten if problem.reads == "speed" else 1.0)
    usual = made.MACHINES[problem.name.split(",")[0]].constants
    parts = {name: 0.3 * usual[name][1] for name in problem.stated}
    parts |= {"start_position": place, "start_temperature": place, "start_speed": place / ten}
    base = problem.constants | {name: problem.constants["start"] for name in [*parts][-3:-1]} | none
    moved = [none | {name: base[name] + way * part}
             for name, part in parts.items() for way in (1.0, -1.0)]  # fmt: skip
    seen, without, *others = predictions(problem, [{}, none, *moved]) / problem.sd
    errors = np.array([error for _, error in problem.stated.values()] + [1.0] * 3)
    slopes = np.array(others[::2]) - np.array(others[1::2])
    slopes = slopes * (0.5 * errors / [*parts.values()])[:, None]
    stated = np.diag(np.arange(len(errors)) < len(problem.stated) * told) * 1.0
    effect = np.append(seen - without, np.zeros(len(errors)))
    slopes = np.hstack([slopes, stated]).T
    left = effect - slopes @ np.linalg.lstsq(slopes, effect, rcond=1e-9)[0]
    return np.linalg.norm(left), seen


KEYS = [key for key in made.problems(300) if (key.strength, key.condition) == (25.0, "clean")]


@pytest.mark.parametrize("key", KEYS, ids=[f"{key.machine}-{key.cause}" for key in KEYS])
@pytest.mark.daily("joint-", "pendulum-coulomb", "heater-late power")
def test_a_cause_means_the_same_in_the_package(key):
    problem = made.made(key)
    if key.cause:
        found, seen = strength(problem)
        # Dry friction and play bend all changes, whose slopes depend on the steps then.
        rough = "servo" in key.machine or key.cause == "backlash"
        assert found == pytest.approx(problem.strength, rel=0.15 if rough else 0.03)
        assert problem.strength == pytest.approx(key.strength, rel=made.CLOSE)
    else:
        seen = predictions(problem, [{}])[0] / problem.sd
    assert np.sqrt(np.mean((seen - problem.plain / problem.sd) ** 2)) < 0.05


@pytest.mark.parametrize("generator", [made, unlisted])
def test_a_problem_is_what_its_key_makes(generator):
    keys = generator.problems(500)
    assert keys == generator.problems(500)
    assert len({key.seed for key in keys}) == len(keys)
    key = next(each for each in keys if each.machine == "oscillator" and each.cause)
    first, again = generator.made(key), generator.made(key)
    assert all(np.array_equal(*each) for each in zip(first, again, strict=True))
    assert not np.array_equal(first.y, generator.made(key._replace(seed=key.seed + 1)).y)
    assert first.truth == ("unlisted" if generator is unlisted else key.cause)


@pytest.mark.parametrize("condition", ["off the grid", "all three"])
def test_a_log_is_as_its_condition_says(condition):
    problem = made.made(made.Key(7, "axis", "", 0.0, condition))
    steps, rows = np.diff(np.unique(problem.y)), len(problem.t)
    if condition == "all three":
        whole = steps / steps.min()
        assert np.allclose(whole, np.round(whole), atol=1e-6)
        assert 0.8 < steps.min() / problem.sd < 1.25
        assert 0.8 * made.COUNT < rows < 0.97 * made.COUNT
    else:
        # A switch moves the axis before the log has it.
        at = np.flatnonzero(np.diff(problem.inputs["command"]))[0] + 1
        assert rows == made.COUNT
        assert problem.plain[at - 1] == 0.0
        assert abs(problem.plain[at]) > 0.0
