#!/usr/bin/env bash
# Expected: a trajectory from rest to rest, asked before its start, is at its start, as it is at its end after it.
# What happens: `at_time` goes on backwards with the jerk of the first piece: 0.5 s before a move of 1 m with limits of
#   1 m/s, 5 m/s^2 and 50 m/s^3 the axis is at -1.04 m with 6.25 m/s and -25 m/s^2, five and six times its limits; 0.1 s
#   before it is 8 mm back. After the end it rests. The extrema of the position, 0 and 1, do not show it. No warning.
# Package: ruckig 0.19.4. Source: found by trying.
# Who is hurt: whoever starts axes one after the other, or compares a plan with a log whose clock begins earlier.
# Instead: at_time(max(t, 0.0)) (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    ruckig==0.19.4
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import math
import warnings
from importlib.metadata import version

from ruckig import InputParameter, Result, Ruckig, Trajectory

warnings.simplefilter("error")
print("ruckig", version("ruckig"))
move = InputParameter(1)
move.current_position, move.current_velocity, move.current_acceleration = [0.0], [0.0], [0.0]
move.target_position, move.target_velocity, move.target_acceleration = [1.0], [0.0], [0.0]
move.max_velocity, move.max_acceleration, move.max_jerk = [1.0], [5.0], [50.0]
plan = Trajectory(1)
assert Ruckig(1).calculate(move, plan) == Result.Working
extrema = plan.position_extrema[0]
print(f"a move of {plan.duration:.2f} s, positions {extrema.min:.2f} to {extrema.max:.2f} m")


def at(t):
    return [each[0] for each in plan.at_time(t)]


for t in (-0.5, -0.1, 0.0, plan.duration, plan.duration + 0.5):
    print("at {:.2f} s: {:.4f} m, {:.3f} m/s, {:.2f} m/s^2".format(t, *at(t)))
for t, state in ((-0.5, (-50 / 48, 6.25, -25.0)), (-0.1, (-50 / 6000, 0.25, -5.0)),
                 (plan.duration + 0.5, (1.0, 0.0, 0.0))):
    assert all(math.isclose(a, b, abs_tol=1e-9) for a, b in zip(at(t), state)), (t, at(t), state)
assert at(max(-0.5, 0.0)) == [0.0, 0.0, 0.0]
assert abs(extrema.min) < 1e-9 and abs(extrema.max - 1.0) < 1e-9
PROGRAM
