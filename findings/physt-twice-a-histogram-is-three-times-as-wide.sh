#!/usr/bin/env bash
# Expected: counts times a number leave mean and standard deviation of a histogram as they are.
# What happens: a product squares the number for the sum of squares alone: `statistics.std` of 2 h is 5.75 for 2.00, of
#   1000 h 171, of h / 2 and of the normalised histogram nan. The mean stays right, so do `h + h` and weights of 2. No
#   warning for factors above 1, numpy's of a root below. (The bins' own errors are scaled rightly.)
# Package: physt 0.11.0, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever scales counts to a rate or a share and reads the scatter afterwards.
# Instead: weights at filling, or the statistics before the product (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check numpy==2.4.6 physt==0.11.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from physt import h1

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("physt", "numpy")))
readings = np.random.default_rng(0).normal(5.0, 2.0, 10000)


def counted(weight=None):
    weights = None if weight is None else np.full(len(readings), weight)
    return h1(readings, "fixed_width", bin_width=0.5, weights=weights)


once = counted()
mean, right = readings.mean(), readings.std()
scaled = {"twice": 2 * once, "a thousand times": 1000 * once, "half": once / 2, "normalised": once.normalize()}
fair = {"as filled": once, "h + h": once + once, "weights of 2": counted(2.0), "weights of 1/2": counted(0.5)}
for name, histogram in (fair | scaled).items():
    with warnings.catch_warnings():
        if histogram.total < once.total:
            warnings.simplefilter("ignore")
        seen = histogram.statistics.mean, histogram.statistics.std
    print(f"{name}: mean {seen[0]:.3f}, standard deviation {seen[1]:.4g}")
    assert abs(seen[0] / mean - 1) < 1e-9
    if name in fair:
        assert abs(seen[1] / right - 1) < 1e-9
    elif histogram.total < once.total:
        assert np.isnan(seen[1])
    else:
        assert seen[1] > 2.8 * right
PROGRAM
