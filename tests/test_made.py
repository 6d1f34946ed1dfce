"""Logs of known truth: names, signs, sizes and strengths mean what they mean in the package.

Without errors of readings its models agree with the integrators that make the logs. They get inputs
at denser times here, since for lags they take lines between readings.
"""

import itertools

import numpy as np
import pytest
from score import made, unlisted
from score.problems import question

from stickslip import Series
from stickslip.diagnosis.model import bare_problem

DENSE = 8  # times for a reading
KEYS = [key for key in made.problems(300) if (key.strength, key.condition) == (25.0, "clean")]


def predictions(problem, changes):
    """Readings that the package predicts with the true values, of which some are changed."""
    t = np.arange((made.COUNT - 1) * DENSE + 1) * problem.t[1] / DENSE
    inputs = {name: u[np.arange(len(t)) // DENSE] for name, u in problem.inputs.items()}
    dense = problem._replace(t=t, y=np.interp(t, problem.t, problem.y), inputs=inputs)
    model, log = question(dense)
    log = log.whole or log  # whose rows between are lines
    posed = bare_problem(log, model, *model.terms(log))
    true = {each.name: each.middle for each in posed.parameters} | problem.constants
    values = [[(true | change)[name] for name in posed.names] for change in changes]
    return posed.model(np.array(values))[:, ::DENSE] / problem.sd


def strength(problem):
    """Norm of the cause's effect on the readings after a fit, with slopes by the package."""
    (cause, *_), of = problem.size, made.MACHINES[problem.name.split(",")[0]]
    none = {cause: np.inf if cause in made.FALLING else 0.0}
    parts = {name: of.part * of.constants[name][1] for name in problem.stated}
    rate = 1.0 if problem.reads == "speed" else 0.1 / problem.t[1]
    parts |= {of.begin: 3.0 * problem.sd, "start_speed": 3.0 * problem.sd * rate}
    moved = [none | {name: problem.constants[name] + way * part}
             for name, part in parts.items() for way in (1.0, -1.0)]  # fmt: skip
    seen, without, *others = predictions(problem, [{}, none, *moved])
    slopes, effect = (np.array(others[::2]) - others[1::2]).T, seen - without
    return np.linalg.norm(effect - slopes @ np.linalg.lstsq(slopes, effect, 1e-9)[0])


@pytest.mark.parametrize("key", KEYS, ids=[f"{key.machine}-{key.cause}" for key in KEYS])
@pytest.mark.daily("joint-", "pendulum-coulomb", "heater-late power")
def test_a_cause_means_the_same_in_the_package(key):
    problem = made.made(key)
    (seen,) = predictions(problem, [{}])
    assert np.sqrt(np.mean((seen - problem.plain / problem.sd) ** 2)) < 0.05
    assert not key.cause or problem.strength == pytest.approx(key.strength, rel=made.CLOSE)
    if problem.by == "readings":
        # Dry friction and play bend all changes, whose slopes depend on the steps then.
        rough = "servo" in key.machine or key.cause == "backlash"
        assert strength(problem) == pytest.approx(key.strength, rel=0.15 if rough else 0.04)


@pytest.mark.parametrize("generator", [made, unlisted])
def test_a_problem_is_what_its_key_makes(generator):
    keys = generator.problems(500)
    assert keys == generator.problems(500)
    key = next(each for each in keys if each.machine == "oscillator" and each.cause)
    first, again = generator.made(key), generator.made(key)
    assert np.array_equal(first.y, again.y)
    assert first.size == again.size != generator.made(key._replace(seed=key.seed + 1)).size


def test_a_log_is_as_its_condition_says():
    rough, late = (made.made(made.Key(7, "axis", "", 0.0, condition))
                   for condition in ("all three", "off the grid"))  # fmt: skip
    steps = np.diff(np.unique(rough.y))
    assert np.allclose(steps / steps.min(), np.round(steps / steps.min()), atol=1e-6)
    assert 0.8 * made.COUNT < len(rough.t) < 0.97 * made.COUNT
    at = np.flatnonzero(np.diff(late.inputs["command"]))[0]
    assert late.plain[at] == 0.0 != late.plain[at + 1]  # it moves before the log has the switch


@pytest.mark.nightly
@pytest.mark.parametrize("condition", ["clean", "rounded", "missing", "correlated", "all three"])
def test_sound_logs_have_no_note_on_what_counts_as_a_reading(condition):
    for seed, machine in itertools.product(range(5000, 5004), made.MACHINES):
        log = made.made(made.Key(seed, machine, "", 0.0, condition))
        series = Series(log.t, log.y, log.inputs, unit=log.unit)
        assert (series.own_notes, len(series.pieces())) == ((), 1), (seed, machine)
