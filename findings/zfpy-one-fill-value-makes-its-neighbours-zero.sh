#!/usr/bin/env bash
# Expected: `compress_numpy(readings, tolerance=1e-3)` keeps each reading within 1e-3, whatever stands beside it.
# What happens: four neighbours share one exponent. One fill value of 9.97e36 (that of netCDF for a gap), or one 1e20,
#   makes the others of its four exactly 0, in an image the other fifteen of its 4 x 4. The tolerance is not held and
#   nothing is said; the array before and after is right, so a look at a few places finds nothing.
# Package: zfpy 1.0.1.post0, numpy 2.4.6. Source: the shared exponent is documented, as a limit for wide ranges.
# Who is hurt: whoever packs records with fill values: around each gap readings become 0, which are plausible.
# Instead: put a number of the record's own size at the gaps, and keep their places beside it; or fpzip, or zfp without
#   a tolerance, which is lossless (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 zfpy==1.0.1.post0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
import zfpy

TOLERANCE = 1e-3


def back(readings, **options):
    return zfpy.decompress_numpy(zfpy.compress_numpy(readings, **options))


record = 1.0 + np.sin(np.arange(64) / 5.0)
row, column = np.mgrid[:16, :16]
image = 1.0 + np.sin(row / 5.0) * np.cos(column / 7.0)
print("zfpy", version("zfpy"), "numpy", np.__version__)
for name, readings, at, lost in (("record", record, (17,), 3), ("image", image, (5, 6), 15)):
    assert np.abs(back(readings, tolerance=TOLERANCE) - readings).max() < TOLERANCE
    for fill in (9.969209968386869e36, 1e20):
        gap = readings.copy()
        gap[at] = fill
        rest = np.ones(readings.shape, bool)
        rest[at] = False
        seen = back(gap, tolerance=TOLERANCE)
        off = np.abs(seen - gap)[rest]
        zeros = np.count_nonzero(seen[rest] == 0.0)
        print(f"{name} with one {fill:.3g}: {zeros} readings became 0, off by {off.max():.2f} (asked: {TOLERANCE})")
        assert zeros == lost == np.count_nonzero(off > TOLERANCE)
        assert off.max() > 0.5
        # instead
        assert np.array_equal(back(gap), gap)
        gap[at] = readings[rest].mean()
        assert np.abs(back(gap, tolerance=TOLERANCE) - gap).max() < TOLERANCE
PROGRAM
