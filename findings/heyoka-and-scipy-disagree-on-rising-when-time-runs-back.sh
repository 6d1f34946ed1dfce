#!/usr/bin/env bash
# Expected: the direction of an event means one thing: "rising" finds the same crossings in every solver, forwards and
#   backwards.
# What happens: forwards all agree. Backwards scipy and CVODE (scikit-sundae) take the sign along the integration: their
#   "rising" is where the value falls with time. heyoka takes the sign over time. They have no crossing in common.
# Packages: scipy 1.17.1, scikit-sundae 1.2.0, heyoka 7.13.2, numpy 2.3.5. Source: found by trying.
# Who is hurt: whoever integrates back to a cause (the last landing before a frame, adjoints, shooting).
# Instead: backwards, turn the direction around in all but heyoka (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 heyoka==7.13.2 scikit-sundae==1.2.0
"$folder/venv/bin/python" - <<'PROGRAM'
import heyoka
import numpy as np
import scipy
import sksundae
from scipy.integrate import solve_ivp
from sksundae.cvode import CVODE

start = [np.sin(0.1), np.cos(0.1)]  # x(t) = sin(t + 0.1): forwards it falls first, at pi - 0.1


def of_scipy(end, sign):
    def event(t, y):
        return y[0]

    event.direction = sign
    run = solve_ivp(lambda t, y: [y[1], -y[0]], (0, end), start, events=event, rtol=1e-9, atol=1e-9)
    return run.t_events[0]


def of_cvode(end, sign):
    def rate(t, y, yp):
        yp[0], yp[1] = y[1], -y[0]

    def event(t, y, out):
        out[0] = y[0]

    event.terminal, event.direction = [False], [sign]
    solver = CVODE(rate, eventsfn=event, num_events=1, rtol=1e-9, atol=1e-9)
    return np.ravel(solver.solve(np.array([0.0, end]), np.array(start)).t_events)


def of_heyoka(end, sign):
    x, v = heyoka.make_vars("x", "v")
    found = []
    side = heyoka.event_direction.positive if sign > 0 else heyoka.event_direction.negative
    event = heyoka.nt_event(x, callback=lambda ta, t, s: found.append(t), direction=side)
    heyoka.taylor_adaptive([(x, v), (v, -x)], start, nt_events=[event]).propagate_until(end)
    return np.array(found)


falls, rises = np.pi - 0.1, 2 * np.pi - 0.1
for solver in (of_scipy, of_cvode, of_heyoka):
    assert abs(solver(10.0, 1)[0] - rises) < 1e-5
    assert abs(solver(10.0, -1)[0] - falls) < 1e-5
rose, fell = -0.1, -np.pi - 0.1
for solver in (of_scipy, of_cvode):
    assert abs(solver(-10.0, 1)[0] - fell) < 1e-5
    assert abs(solver(-10.0, -1)[0] - rose) < 1e-5
assert abs(of_heyoka(-10.0, 1)[0] - rose) < 1e-5
assert abs(of_heyoka(-10.0, -1)[0] - fell) < 1e-5
print("scipy", scipy.__version__, "scikit-sundae", sksundae.__version__)
print("heyoka", heyoka.__version__, "numpy", np.__version__)
print("back from 0, direction +1: scipy", of_scipy(-10.0, 1), "heyoka", of_heyoka(-10.0, 1))
PROGRAM
