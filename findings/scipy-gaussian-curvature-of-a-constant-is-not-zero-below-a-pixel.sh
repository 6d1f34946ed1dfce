#!/usr/bin/env bash
# Expected: `gaussian_filter1d(order=1)` of a ramp gives its slope, order=2 and `gaussian_laplace` of a constant give
#   0, for any sigma: a small one only smooths less.
# What happens: the derivative of the bell is taken at whole pixels. With a sigma of 0.5 a slope of 1 is 0.86, with 0.3
#   it is 0.085; the curvature of a constant 100 is -56 and -1016, its Laplacian -112: the brightness leaks in. From a
#   sigma of 1 on all is right, and order=0 is right for each. No warning.
# Package: scipy 1.17.1. Source: found by trying.
# Who is hurt: whoever takes speeds or accelerations with little smoothing, or finds blobs from half a pixel on.
# Instead: smooth with order=0, then differences (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import scipy
from scipy import ndimage

warnings.simplefilter("error")
print("scipy", scipy.__version__, "numpy", np.__version__)
ramp, flat = np.arange(100.0), np.full(100, 100.0)
spread = {}
for sigma in (0.3, 0.4, 0.5, 0.7, 1.0):
    slope = ndimage.gaussian_filter1d(ramp, sigma, order=1)[50]
    curved = ndimage.gaussian_filter1d(flat, sigma, order=2)[50]
    blob = ndimage.gaussian_laplace(np.full((60, 60), 100.0), sigma)[30, 30]
    smooth = ndimage.gaussian_filter1d(ramp, sigma)[50]
    spread[sigma] = slope, curved, blob
    print(f"sigma {sigma}: slope of a ramp of 1 {slope:.3f}, curvature of a constant 100 {curved:.2f}, "
          f"gaussian_laplace of it {blob:.2f}; smoothed ramp off by {abs(smooth - 50.0):.0e}")
    assert abs(smooth - 50.0) < 1e-9
assert np.isclose(spread[0.3][0], 0.0853, atol=1e-3) and np.isclose(spread[0.5][0], 0.860, atol=1e-3)
assert abs(spread[1.0][0] - 1.0) < 1e-3 and abs(spread[1.0][1]) < 0.01
assert abs(spread[0.5][1]) > 50.0 and abs(spread[0.5][2]) > 100.0 and abs(spread[0.3][1]) > 900.0
# instead
steps = np.gradient(ndimage.gaussian_filter1d(ramp, 0.3))[50], np.diff(ndimage.gaussian_filter1d(flat, 0.3), 2)[50]
print("differences of the smoothed ramp and constant:", steps)
assert np.allclose(steps, (1.0, 0.0), atol=1e-9)
PROGRAM
