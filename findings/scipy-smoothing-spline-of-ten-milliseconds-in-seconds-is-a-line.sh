#!/usr/bin/env bash
# Expected: `make_smoothing_spline` without `lam` chooses its smoothing from the readings (generalised
#   cross-validation), so that the curve is the same whatever the unit of time.
# What happens: lam, whose unit is that of time cubed, is looked for between 0 and the number of readings. Of 200
#   readings the curve is right while their spacing is about 0.005 to 1; for 10 ms in seconds it is a straight line
#   through three periods of a sine, for 10 s in milliseconds it runs through the noise. No warning.
# Package: scipy 1.17.1. Source: found by trying; the range stands in the code.
# Who is hurt: whoever smooths fast records in seconds, or positions over places in metres or micrometres.
# Instead: divide the times by their mean step first (tried), or give lam.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import scipy
from scipy.interpolate import make_smoothing_spline

warnings.simplefilter("error")
print("numpy", np.__version__, "scipy", scipy.__version__)
random = np.random.default_rng(0)
time = np.linspace(0.0, 10e-3, 200)
true = np.sin(2e3 * time)
readings = true + 0.1 * random.normal(size=200)
off = {}
for unit, per_second in (("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)):
    t = per_second * time
    curve = make_smoothing_spline(t, readings)(t)
    line = np.polyval(np.polyfit(t, readings, 1), t)
    off[unit] = np.sqrt(np.mean((curve - true) ** 2))
    print(f"10 ms in {unit:2}: spacing {t[1]:.1e}, curve off by {off[unit]:.3f}, from the readings "
          f"{np.sqrt(np.mean((curve - readings) ** 2)):.1e}, from a straight line "
          f"{np.sqrt(np.mean((curve - line) ** 2)):.1e}")
    if unit == "s":
        assert np.abs(curve - line).max() < 0.1
    if unit in ("us", "ns"):
        assert np.sqrt(np.mean((curve - readings) ** 2)) < 0.01
assert off["s"] > 0.6 and off["ms"] < 0.04 and off["us"] > 0.09 and off["ns"] > 0.09
# instead
t = time / np.diff(time).mean()
assert np.sqrt(np.mean((make_smoothing_spline(t, readings)(t) - true) ** 2)) < 0.04
PROGRAM
