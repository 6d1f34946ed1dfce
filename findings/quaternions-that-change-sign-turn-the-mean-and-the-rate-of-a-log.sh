#!/usr/bin/env bash
# Expected: q and -q are one attitude, so the mean attitude and the rates of a log do not change where its sign does.
# What happens: with half of ten attitudes around 0.55 rad negated numpy-quaternion's mean is -2.59 rad, half a turn
#   off, and its rates run from 0 to 0.16 rad/s for a steady 0.1, a spline being laid through the jump; ahrs gives -0.1
#   at the change. scipy's Rotation is right. No warning.
# Package: numpy-quaternion 2024.0.13, ahrs 0.4.0. Source: the first documents `unflip_rotors`; the rest was tried.
# Who is hurt: whoever averages or differentiates the log of an inertial or optical tracker; many change sign.
# Instead: unflip_rotors first (tried), or scipy's Rotation (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 numpy-quaternion==2024.0.13 ahrs==0.4.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import ahrs
import numpy as np
import quaternion
from scipy.spatial.transform import Rotation

warnings.simplefilter("error", UserWarning)
print(*(f"{name} {version(name)}" for name in ("numpy-quaternion", "ahrs", "scipy", "numpy")))
time = np.arange(10.0)
angles = 0.1 + 0.1 * time  # rad about z, at 0.1 rad/s
log = np.array([np.cos(angles / 2.0), 0 * angles, 0 * angles, np.sin(angles / 2.0)]).T
flipped = log.copy()
flipped[5:] *= -1.0  # the same ten attitudes


def mean(rows):
    turn = quaternion.mean_rotor_in_chordal_metric(quaternion.as_quat_array(rows))
    return float(quaternion.as_rotation_vector(turn)[2])


def rates(rows):
    return quaternion.angular_velocity(quaternion.as_quat_array(rows), time)[:, 2]


def rates_of_ahrs(rows):
    return np.asarray(ahrs.QuaternionArray(rows).angular_velocities(1.0))[:, 2]


def turns(rows):
    return Rotation.from_quat(rows, scalar_first=True)


for name, rows in (("one sign", log), ("two signs", flipped)):
    print(f"{name}: mean by numpy-quaternion {mean(rows):.2f} rad, by scipy {turns(rows).mean().as_rotvec()[2]:.2f}; "
          f"rates by numpy-quaternion {rates(rows).min():.2f} to {rates(rows).max():.2f} rad/s, by ahrs "
          f"{rates_of_ahrs(rows).min():.2f} to {rates_of_ahrs(rows).max():.2f}")
assert np.isclose(mean(log), 0.55) and abs(mean(flipped) - 0.55) > 2.0
assert np.allclose(rates(log), 0.1, atol=1e-3) and rates(flipped).max() > 0.15 and rates(flipped).min() < 0.02
assert np.allclose(rates_of_ahrs(log), 0.1, atol=1e-3)
assert np.allclose(np.delete(rates_of_ahrs(flipped), 4), 0.1, atol=1e-3)
assert np.isclose(rates_of_ahrs(flipped)[4], -0.1, atol=1e-3)
# instead
mended = quaternion.as_float_array(quaternion.unflip_rotors(quaternion.as_quat_array(flipped)))
assert np.isclose(mean(mended), 0.55) and np.allclose(rates(mended), 0.1, atol=1e-3)
assert np.allclose(rates_of_ahrs(mended), 0.1, atol=1e-3)
steps = (turns(flipped)[:-1].inv() * turns(flipped)[1:]).as_rotvec()[:, 2]
assert np.isclose(turns(flipped).mean().as_rotvec()[2], 0.55) and np.allclose(steps, 0.1)
PROGRAM
