#!/usr/bin/env bash
# Expected: `MatrixExp3` of a small rotation is I + [w]; ten thousand steps of 0.5 microradians turn by 5 milliradians.
# What happens: below 1e-6 rad it is the identity: the same steps do not turn at all, steps of 1.01e-6 rad are right. In
#   `FKinSpace` a joint at 0.9 microradians is one at 0: the tip of an arm of 2 m is 1.8 um off. No warning.
# Package: modern-robotics 1.1.1; pytransform3d 3.17.0 and pyquaternion 0.9.9 are right. Source: found by trying; that
#   `NearZero` is 1e-6 stands in its own docstring alone.
# Who is hurt: whoever integrates a slow turn (0.5 mrad/s in steps of 1 ms), or models fine stages.
# Instead: rotations by the other two (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 modern-robotics==1.1.1 pytransform3d==3.17.0 pyquaternion==0.9.9
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import modern_robotics as mr
import numpy as np
from pyquaternion import Quaternion

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from pytransform3d.rotations import matrix_from_compact_axis_angle
warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("modern-robotics", "pytransform3d", "pyquaternion", "numpy")))


def turned(step, by):
    """The angle after 10 000 steps."""
    attitude = np.eye(3)
    for _ in range(10_000):
        attitude = attitude @ by(np.array([0.0, 0.0, step]))
    return float(np.arctan2(attitude[1, 0], attitude[0, 0]))


for step in (0.5e-6, 0.99e-6, 1.01e-6):
    mine = turned(step, lambda w: mr.MatrixExp3(mr.VecToso3(w)))
    other = turned(step, matrix_from_compact_axis_angle)
    print(f"10000 steps of {step:g} rad: {mine:.6f} rad, by pytransform3d {other:.6f}")
    assert abs(other - 1e4 * step) < 1e-9
    assert mine == 0.0 if step < 1e-6 else abs(mine - 1e4 * step) < 1e-9
q = Quaternion()
for _ in range(10_000):
    q.integrate([0.0, 0.0, 0.5e-3], 1e-3)
print(f"0.5 mrad/s for 10 s in steps of 1 ms by pyquaternion: {q.angle:.6f} rad")
assert abs(q.angle - 5e-3) < 1e-9

home = np.array([[1.0, 0.0, 0.0, 2.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
joint = np.array([[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]]).T
tip = [float(mr.FKinSpace(home, joint, np.array([angle]))[1, 3]) for angle in (0.9e-6, 1.1e-6)]
print(f"tip of an arm of 2 m at 0.9 and 1.1 urad: {1e6 * tip[0]:.3f} and {1e6 * tip[1]:.3f} um")
assert tip[0] == 0.0 and abs(tip[1] - 2.2e-6) < 1e-12
PROGRAM
