#!/usr/bin/env bash
# Expected: `valid` says where a field exists, and operations leave the other cells out, as `diff` does.
# What happens: `diff` does not reach across the border, but `mean`, `integrate` and `resample` count the numbers that
#   stand in invalid cells. A disk in a box, magnetised to 1 throughout, has a mean of 0.79; where its surroundings were
#   filled with 900 as a mark, the mean is 189. No warning.
# Package: discretisedfield 0.92.0, numpy 2.3.5. Source: found by trying; `valid` is documented for derivatives.
# Who is hurt: whoever averages a magnetisation, an energy or a measured map with gaps.
# Instead: field.array[field.valid].mean(axis=0) (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 discretisedfield==0.92.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import discretisedfield as df
warnings.simplefilter("error")
print("discretisedfield", version("discretisedfield"), "numpy", np.__version__)
mesh = df.Mesh(p1=(-50e-9, -50e-9, 0), p2=(50e-9, 50e-9, 2e-9), cell=(2e-9, 2e-9, 2e-9))


def inside(point):
    return point[0] ** 2 + point[1] ** 2 < 50e-9**2


area = np.pi / 4.0 * 100e-9**2 * 2e-9
for mark in (0.0, 900.0):
    field = df.Field(mesh, nvdim=1, value=lambda p: 1.0 if inside(p) else mark, valid=inside)
    slope = np.abs(field.diff("x").array).max() * 2e-9
    mean, whole = float(field.mean()[0]), float(field.integrate()[0]) / area
    coarse = field.resample((10, 10, 1))
    right = float(field.array[field.valid].mean())
    print(f"1 inside, {mark:g} outside: mean {mean:.2f}, integral over the disk's volume {whole:.2f}, largest step by "
          f"diff {slope:g}; mean of the valid cells {right:g}; valid after resample {coarse.valid.mean():.2f} of all")
    assert slope < 1e-12 and right == 1.0
    share = field.valid.mean()
    assert 0.77 < share < 0.80 and abs(mean - (share + (1.0 - share) * mark)) < 1e-9
    assert abs(whole * area / (mean * 100e-9**2 * 2e-9) - 1.0) < 1e-9
PROGRAM
