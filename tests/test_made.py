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


@pytest.mark.parametrize("machine", made.MACHINES)
@pytest.mark.daily("heater")
def test_a_cause_means_the_same_in_the_package(machine):
    keys = [key for key in made.problems(300) if key.machine == machine and not key.size]
    for key in (key for key in keys if key.condition == "clean" and key.strength == 25.0):
        problem = made.made(key)
        if not key.cause:
            difference = predictions(problem, [{}])[0] - problem.plain
            assert np.sqrt(np.mean(difference**2)) < 0.05 * problem.sd
            continue
        found, seen = strength(problem)
        r=np.sqrt(np.mean((seen - problem.plain / problem.sd) ** 2))
        print(key.machine,key.cause,round(r,4),round(found,2),round(problem.strength,2), "***" if r>.05 or abs(found/25-1)>.03 else "")
