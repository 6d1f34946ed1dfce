#!/usr/bin/env bash
# Expected: a solver that has run once runs again from another start as a new one does, as after each `solve` of SciPy.
# What happens: events are kept at the function that finds them, and forgotten only where a solver is made. `t_events`,
#   `i_events` and `y_events` of a second run begin with those of the first, so a body that stays at rest has a landing;
#   so it is with two solvers that were made before with one function. Where the third event is to stop a run, the count
#   goes on too: each later run stops at its first event. CVODE and IDA alike, without a word; `success` is True.
# Package: scikit-sundae 1.2.0, numpy 2.4.6, scipy 1.17.1. Source: found by trying; its page of events does not say it.
# Who is hurt: whoever sweeps starts or parameters with one solver, or one solver each, and reads when a body lands or stops.
# Instead: make `CVODE` or `IDA` just before each run, which takes a tenth of a millisecond, or a function each (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-sundae==1.2.0
cd "$folder"
"$folder/venv/bin/python" -W error - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
from sksundae.cvode import CVODE
from sksundae.ida import IDA

print(*(f"{name} {version(name)}" for name in ("scikit-sundae", "numpy", "scipy")))
TIMES, HEIGHTS = np.linspace(0.0, 1.0, 101), (0.04, 0.09, 0.16)


def falls(t, y, yp):
    yp[:] = y[1], -9.81


def lands(t, y, events):
    events[0] = y[0]


def solver(function=lands):
    return CVODE(falls, eventsfn=function, num_events=1, rtol=1e-8, atol=1e-10)


def landings(solvers):
    runs = [each.solve(TIMES, np.array([height, 0.0])) for each, height in zip(solvers, HEIGHTS)]
    assert all(run.success for run in runs)
    return [run.t_events for run in runs]


right = np.sqrt(2.0 * np.array(HEIGHTS) / 9.81)
for kept, how, make in (
    (True, "one solver", lambda: [solver()] * 3),
    (True, "three solvers that were made before", lambda: [solver() for _ in HEIGHTS]),
    (False, "one made for each run", lambda: (solver() for _ in HEIGHTS)),
    (False, "three with a function each", lambda: [solver(lambda t, y, e: lands(t, y, e)) for _ in HEIGHTS]),
):
    times = landings(make())
    print(f"landings by {how}:", *(each.round(4) for each in times))
    assert all(np.allclose(each, right[0 if kept else k : k + 1], rtol=1e-4) for k, each in enumerate(times))


def moves(t, y, yp):
    yp[:] = y[1], 0.0


def passes(t, y, events):
    events[0] = y[0] - 0.5


passes.terminal = [False]
body = CVODE(moves, eventsfn=passes, num_events=1)
body.solve(TIMES, np.array([0.0, 1.0]))
resting = body.solve(TIMES, np.zeros(2))
print("a body at rest passes half a metre at", resting.t_events)
assert np.allclose(resting.t_events, 0.5) and not resting.y.any()


def swings(t, y, yp):
    yp[:] = y[1], -y[0]


def residual(t, y, yp, left):
    left[:] = yp[0] - y[1], yp[1] + y[0]


def turns(t, y, events):
    events[0] = y[1]


def turns_of_both(t, y, yp, events):
    events[0] = y[1]


turns.terminal = turns_of_both.terminal = [3]
start, speed = np.array([-1.0, 0.0]), np.array([0.0, 1.0])
swing, same = CVODE(swings, eventsfn=turns, num_events=1), IDA(residual, eventsfn=turns_of_both, num_events=1)
for name, run in (("CVODE", lambda: swing.solve([0.0, 20.0], start)), ("IDA", lambda: same.solve([0.0, 20.0], start, speed))):
    ends = [run().t[-1] / np.pi for _ in range(3)]
    print(f"{name} stops at the third turn, in half periods:", *np.round(ends, 3))
    assert np.allclose(ends, [3.0, 1.0, 1.0], atol=1e-3)
PROGRAM
