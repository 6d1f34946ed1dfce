#!/usr/bin/env bash
# Expected: a function that returns a float, or whose result fits its type, makes its sums of integers in floats.
# What happens: inside they are made in the readings' own type and wrap, without a warning: `ttest_rel` of uint8 has t =
#   678 (right: -5.9); `trapezoid` of NumPy and SciPy of nine grey values 851 (1875), `simpson` is right; `euclidean` of
#   uint16 places 65506 (50), `cdist` and `sqeuclidean` are right; `gaussian_gradient_magnitude` 15 on an edge of 89.
# Packages: numpy 2.4.6, scipy 1.17.1. Source: found by trying; which neighbours are right is not documented.
# Who is hurt: whoever takes statistics, integrals, distances or edges of camera frames and ADC counts as they were stored.
# Instead: .astype(float) first (tried for each).
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
from scipy import integrate, ndimage, stats
from scipy.spatial import distance

warnings.simplefilter("error")
print("numpy", np.__version__, "scipy", scipy.__version__)

# a paired test
before = np.array([100, 120, 130, 90, 110], dtype=np.uint8)
after = np.array([102, 121, 133, 92, 113], dtype=np.uint8)
wrapped = stats.ttest_rel(before, after)
assert wrapped.statistic > 600.0 and wrapped.pvalue < 1e-9
# instead
right = stats.ttest_rel(before.astype(float), after.astype(float))
assert np.isclose(right.statistic, -5.8797, atol=1e-3) and right.pvalue > 0.004
for test in (stats.ttest_ind, stats.wilcoxon, stats.f_oneway):
    assert np.isclose(test(before, after).statistic, test(before.astype(float), after.astype(float)).statistic)
assert stats.gmean(before).dtype == np.float16
assert abs(stats.gmean(before.astype(float)) - float(stats.gmean(before))) > 0.05
print(f"uint8: t = {wrapped.statistic:.1f}, p = {wrapped.pvalue:.2g}; floats: t = {right.statistic:.2f}, p = {right.pvalue:.2g}")

# integrals
rows = {
    "uint8": np.array([200, 210, 220, 230, 240, 250, 255, 250, 240], np.uint8),
    "int16": np.array([30000, 31000, 32000, 31000, 30000], np.int16),
}
wraps = {
    "numpy.trapezoid": lambda y: np.trapezoid(y, dx=1.0),
    "scipy trapezoid": integrate.trapezoid,
    "scipy cumulative_trapezoid": lambda y: integrate.cumulative_trapezoid(y)[-1],
}
right = {"scipy simpson": integrate.simpson, "scipy cumulative_simpson": lambda y: integrate.cumulative_simpson(y)[-1]}
for kind, row in rows.items():
    for name, integral in {**wraps, **right}.items():
        seen, should = float(integral(row)), float(integral(row.astype(float)))
        print(f"{name} of {kind}: {seen:.0f}, of the same as floats {should:.0f}")
        if name in right:
            assert abs(seen - should) < 1e-6
        else:
            assert abs(seen - should) > 0.5 * should
            half = np.diff(row.astype(float)) / 2.0 + row[:-1]
            # instead
            assert abs(should - half.sum()) < 1e-9
    dark = (row // 3).astype(row.dtype)
    assert float(np.trapezoid(dark)) == float(np.trapezoid(dark.astype(float)))

# distances
here, there = np.array([100, 900], np.uint16), np.array([130, 860], np.uint16)
right = {"euclidean": 50.0, "minkowski": 50.0, "cityblock": 70.0, "chebyshev": 40.0, "sqeuclidean": 2500.0}
for name, should in right.items():
    by_pair = float(getattr(distance, name)(here, there))
    by_cdist = float(distance.cdist(here[None], there[None], name)[0, 0])
    print(f"{name}: {by_pair:.1f} by the pair, {by_cdist:.1f} by cdist, right {should}")
    assert abs(by_cdist - should) < 1e-9
    assert abs(by_pair - should) < 1e-9 if name == "sqeuclidean" else by_pair > 60000.0
    # instead
    assert abs(getattr(distance, name)(here.astype(float), there.astype(float)) - should) < 1e-9
track = np.array([[100, 100], [103, 104], [100, 100], [103, 104]], np.uint16)
steps = [float(distance.euclidean(a, b)) for a, b in zip(track[1:], track[:-1], strict=True)]
print("steps of 5 px there and back:", [round(step, 1) for step in steps])
assert steps[0] == 5.0 == steps[2] and steps[1] > 60000.0

# edges
row, column = np.mgrid[:40, :40]
frame = np.where((abs(row - 20) < 6) & (abs(column - 20) < 6), 250, 5).astype(np.uint8)
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
