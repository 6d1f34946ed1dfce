#!/usr/bin/env bash
# Expected: an integrator whose DAE names an event ("zero") and gives no transition goes on with the state that it has,
#   or refuses; with a transition, it handles every event between two outputs.
# What happens: without a transition the whole state, unrelated parts too, is set to 0 at the event, without an error.
#   With one, and one output at 1.5 s, a bouncing ball is 0.93 m under the floor; with two outputs it is right to 2 %.
# Package: casadi 3.8.2 (events are marked as experimental there). Source: found by trying.
# Who is hurt: whoever counts zero crossings, or asks only for the state at the end.
# Instead: a transition always, post_x = x if nothing is to change; several outputs, and event_tol=1e-12 with
#   max_event_iter=100 (tried: right to 1e-12 from two outputs on, still wrong with one).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 casadi==3.8.2
"$folder/venv/bin/python" - <<'PROGRAM'
import casadi
import numpy as np

x, v, clock = casadi.SX.sym("x"), casadi.SX.sym("v"), casadi.SX.sym("clock")
DAE = {
    "x": casadi.vertcat(x, v, clock), "ode": casadi.vertcat(v, -9.81, 1.0), "zero": x,
}
index, time, before = casadi.SX.sym("index"), casadi.SX.sym("t"), casadi.SX.sym("x", 3)


def transition(after):
    parts = {"index": index, "t": time, "x": before, "post_x": after}
    return casadi.Function("transition", parts, casadi.event_in(), casadi.event_out())


def end(options, outputs, until, plugin="rk"):
    grid = np.linspace(0.0, until, outputs + 1)[1:].tolist()
    solver = casadi.integrator("solver", plugin, DAE, 0.0, grid, options)
    return np.array(solver(x0=[1.0, 0.0, 7.0])["xf"])[:, -1]


landing = np.sqrt(2 / 9.81)
for plugin in ("rk", "collocation", "cvodes", "idas"):
    lost = end({}, 20, 0.5, plugin)
    assert abs(lost[2] - (0.5 - landing)) < 1e-5, lost
    assert abs(lost[1] + 9.81 * (0.5 - landing)) < 1e-4
same = end({"transition": transition(before)}, 20, 0.5)
assert abs(same[2] - 7.5) < 1e-8 and abs(same[1] + 9.81 * 0.5) < 1e-6
print("casadi", casadi.__version__, "numpy", np.__version__)
print("at 0.5 s without a transition:", lost.round(4), "; with post_x = x:", same.round(4))

# Height at 1.5 s of a ball that keeps 0.8 of its speed, in closed form.
at, speed = landing, 9.81 * landing * 0.8
while at + 2 * speed / 9.81 < 1.5:
    at, speed = at + 2 * speed / 9.81, 0.8 * speed
true = speed * (1.5 - at) - 9.81 * (1.5 - at) ** 2 / 2
bounce = transition(casadi.vertcat(before[0], -0.8 * before[1], before[2]))
for plugin in ("rk", "collocation"):
    error = [end({"transition": bounce}, n, 1.5, plugin)[0] - true for n in (1, 2, 5, 20)]
    print(f"{plugin}: height at 1.5 s {true:.4f} m, off with 1, 2, 5, 20 outputs by",
          *(f"{value:.1e}" for value in error))
    assert error[0] < -1.3 and 0.005 < abs(error[1]) < 0.01 and abs(error[3]) < 1e-7
tight = {"transition": bounce, "event_tol": 1e-12, "max_event_iter": 100}
assert abs(end(tight, 2, 1.5)[0] - true) < 1e-12 and abs(end(tight, 1, 1.5)[0] - true) > 1
PROGRAM
