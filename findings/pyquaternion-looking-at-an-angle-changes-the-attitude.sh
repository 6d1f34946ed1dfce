#!/usr/bin/env bash
# Expected: asking a quaternion for its angle, its axis or its matrix, or interpolating between two, changes neither.
# What happens: `degrees`, `axis`, `rotation_matrix` and `rotate` make the quaternion itself of length 1: the sum of 100
#   scattered attitudes, whose length tells their scatter, goes from 80 to 1 when its angle is printed. `slerp` turns
#   the sign of its first argument where the signs of the two differ: a log that was smooth jumps from q to -q after
#   one attitude between its rows was asked for. Quaternion(q) is no copy: both have one array. No warning.
# Package: pyquaternion 0.9.9, numpy 2.4.6. Source: slerp's normalising is documented, the rest was tried.
# Who is hurt: whoever adds, weighs or differentiates attitudes after a look at them.
# Instead: Quaternion(q.elements.copy()) for what is looked at (tried), or scipy's Rotation.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pyquaternion==0.9.9
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from pyquaternion import Quaternion

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("pyquaternion", "numpy")))
angles = np.random.default_rng(1).normal(0.5, 1.6, 100)


def total():
    return sum((Quaternion(axis=[0, 0, 1], angle=angle) for angle in angles), Quaternion(0, 0, 0, 0))


length = total().norm
for name, look in (
        ("degrees", lambda q: q.degrees), ("axis", lambda q: q.axis), ("rotate", lambda q: q.rotate([1, 0, 0])),
        ("rotation_matrix", lambda q: q.rotation_matrix), ("inverse", lambda q: q.inverse)):
    added = total()
    look(added)
    print(f"length of the sum {length:.1f}, after {name} {added.norm:.1f}")
    assert abs(added.norm - (length if name == "inverse" else 1.0)) < 1e-9
added = total()
Quaternion(added.elements.copy()).degrees
assert added.norm == length and abs(length - 100) > 20

log = [Quaternion(axis=[0, 0, 1], angle=angle) for angle in np.arange(0.0, 7.0, 0.1)]  # runs through q and -q smoothly
turned = -log[40]
steps = [np.linalg.norm((log[place + 1] - log[place]).elements) for place in range(len(log) - 1)]
middle = Quaternion.slerp(log[30], turned, 0.5)
after = [np.linalg.norm((log[place + 1] - log[place]).elements) for place in range(len(log) - 1)]
right = abs(middle.elements @ Quaternion(axis=[0, 0, 1], angle=3.5).elements)
print(f"largest step of the log {max(steps):.2f}, after one slerp {max(after):.2f}; its own result: {right:.6f}")
assert max(steps) < 0.051 and max(after) > 1.99 and abs(right - 1.0) < 1e-9

first = Quaternion(1.0, 0.0, 0.0, 0.0)
second = Quaternion(first)
second.q[:] = [0.0, 0.0, 0.0, 1.0]
print(f"Quaternion(first), set to a half turn: first is {first.elements}")
assert np.array_equal(first.elements, [0.0, 0.0, 0.0, 1.0])
PROGRAM
