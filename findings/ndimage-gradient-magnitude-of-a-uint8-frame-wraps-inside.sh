#!/usr/bin/env bash
# Expected: `gaussian_gradient_magnitude` of a uint8 frame is that of the same frame as floats, cut to whole numbers, as
#   its values of 0 to 89 fit into 8 bits; so are `shift` and `gaussian_filter`.
# What happens: derivatives and their squares are made in uint8 and wrap: nothing is above 15, the edge of a bright
#   square is 15 in place of 89. `sobel` and `laplace` of uint8 wrap as well. No warning.
# Package: scipy 1.17.1. Source: the type of the output is documented, the wrap inside is not; found by trying.
# Who is hurt: whoever looks for the edge or the focus of a robot in camera frames.
# Instead: frame.astype(float) first, or output=float (both tried).
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
from scipy import ndimage

warnings.simplefilter("error")
row, column = np.mgrid[:40, :40]
frame = np.where((abs(row - 20) < 6) & (abs(column - 20) < 6), 250, 5).astype(np.uint8)
print("scipy", scipy.__version__, "numpy", np.__version__)
edges = ndimage.gaussian_gradient_magnitude
seen, right = edges(frame, 1.0), edges(frame.astype(float), 1.0)
off = np.abs(seen - right)
print(f"right values {right.min():.0f} to {right.max():.0f}; off by up to {off.max():.0f}, at "
      f"{np.count_nonzero(off > 20.0)} pixels by more than 20; on the edge {seen[20, 15]}, right {right[20, 15]:.1f}")
assert seen.dtype == np.uint8 and right.max() < 128.0
assert seen.max() < 16 and off.max() > 70.0 and np.count_nonzero(off > 20.0) > 100
# instead
assert np.allclose(edges(frame, 1.0, output=float), right, atol=1e-9)
for name, smooth in {"gaussian_filter": lambda a: ndimage.gaussian_filter(a, 1.0),
                     "shift": lambda a: ndimage.shift(a, (0.3, 0.3), order=1)}.items():
    off = np.abs(smooth(frame) - smooth(frame.astype(float)))
    print(f"{name}: off by {off.max():.1f} at most")
    assert off.max() < 3.0
for name in ("sobel", "laplace"):
    seen = getattr(ndimage, name)(frame)
    right = getattr(ndimage, name)(frame.astype(float))
    assert right.min() < 0 and np.array_equal(seen, (right.astype(int) % 256).astype(np.uint8))
PROGRAM
