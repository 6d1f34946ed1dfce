#!/usr/bin/env bash
# Expected: `dxdt(x, t, kind="finite_difference", k=1)` is given all times and uses them: a late reading spoils its
#   neighbours.
# What happens: only t[1] - t[0] is looked at. If the second of 300 readings comes a quarter of a step late, the whole
#   derivative is 0.8 times the right one; after each lost reading it is too large by a half. No warning; numpy.gradient
#   and this package's own savitzky_golay are right to 1e-3.
# Package: derivative 0.6.3 (also a part of pysindy). Source: the docstring says equally-spaced data; found by trying.
# Who is hurt: whoever makes velocities of a film or of a log with a jittering clock. Instead: the other two (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-learn==1.9.1 derivative==0.6.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
from derivative import dxdt

even = np.arange(300) * 0.02
late = even.copy()
late[1] += 0.005  # the second reading alone, by a quarter of a step
lost = np.delete(even, np.r_[50:53, 100:300:10])
SMOOTH = {"kind": "savitzky_golay", "left": 0.5, "right": 0.5, "order": 3}
PLAIN = {"kind": "finite_difference", "k": 1}


def error(t, **options):
    """Of the derivative of sin t, without the ends."""
    return (dxdt(np.sin(t), t, **options) - np.cos(t))[5:-5]


def scale(t, **options):
    """What the derivative of sin t is multiplied by."""
    right = np.cos(t)[5:-5]
    return float(1.0 + error(t, **options) @ right / (right @ right))


print("derivative", version("derivative"), "numpy", np.__version__)
for name, t in {"even": even, "second reading late": late, "23 of 300 lost": lost}.items():
    plain, smooth = np.abs(error(t, **PLAIN)).max(), np.abs(error(t, **SMOOTH)).max()
    by_numpy = np.abs(np.gradient(np.sin(t), t) - np.cos(t))[5:-5].max()
    print(f"{name}: finite_difference times {scale(t, **PLAIN):.4f}, off by {plain:.4f} at most; "
          f"savitzky_golay {smooth:.4f}, numpy.gradient {by_numpy:.4f}")
    assert smooth < 1e-3 and by_numpy < 1e-3  # instead
    assert plain < 1e-3 if t is even else plain > 0.19
assert abs(scale(late, **PLAIN) - 0.8) < 1e-3
PROGRAM
