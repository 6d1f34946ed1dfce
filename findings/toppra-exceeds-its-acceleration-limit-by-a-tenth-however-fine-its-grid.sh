#!/usr/bin/env bash
# Expected: a trajectory of `compute_trajectory` keeps the limits that it was given, the closer the finer the grid.
# What happens: by default the times of the grid are joined by a spline, which overshoots where the acceleration jumps,
#   as it does in each time-optimal motion: with a limit of 2 it is 2.03 to 2.3 along a zigzag, a square and a path with
#   a turn back with 20 points, 2.1 to 2.2 with the automatic grid and with 1000. Velocity is right with 1000, and the
#   duration is the same as without the fault. No warning.
# Package: toppra 0.6.10, scipy 1.17.1, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever drives a body at its friction limit, or a motor at its current's limit: it slips.
# Instead: parametrizer="ParametrizeConstAccel" and a fine grid (tried: 2.00).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 toppra==0.6.10
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import toppra
from toppra.algorithm import TOPPRA
from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint

warnings.simplefilter("error")
toppra.setup_logging("ERROR")
print(*(f"{name} {version(name)}" for name in ("toppra", "scipy", "numpy")))
one = np.array([[-1.0, 1.0]] * 2)
limits = [JointVelocityConstraint(one), JointAccelerationConstraint(2.0 * one)]
ways = {
    "zigzag": [[0, 0], [1, 0.5], [2, 0], [3, 1]],
    "square": [[0, 0], [1, 0], [1, 1], [0, 1]],
    "turn back": [[0, 0], [1, 0], [0, 0], [1, 0]]}
for name, way in ways.items():
    path = toppra.SplineInterpolator(np.linspace(0.0, 1.0, len(way)), np.array(way, float))
    for points in (20, None, 1000):
        grid = None if points is None else np.linspace(0.0, 1.0, points)
        seen = []
        for options in ({}, {"parametrizer": "ParametrizeConstAccel"}):
            motion = TOPPRA(limits, path, gridpoints=grid, **options).compute_trajectory(0.0, 0.0)
            times = np.linspace(0.0, motion.duration, 20001)
            seen.append([motion.duration, np.abs(motion(times, 1)).max(), np.abs(motion(times, 2)).max()])
        default, mended = seen
        print(f"{name}, {points or 'automatic'} points: by default {default[0]:.2f} s, velocity {default[1]:.2f} of 1, "
              f"acceleration {default[2]:.2f} of 2; ParametrizeConstAccel {mended[2]:.2f}")
        assert default[2] > (2.02 if points == 20 else 2.09) and abs(default[0] / mended[0] - 1.0) < 1e-6
        if points == 1000:
            assert mended[2] < 2.001 and default[1] < 1.001
PROGRAM
