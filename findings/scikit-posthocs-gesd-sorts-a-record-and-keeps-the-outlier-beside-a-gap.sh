#!/usr/bin/env bash
# Expected: a filter of outliers returns the record without them, in its order; a lost reading is left out, or makes all
#   of it NaN, or is refused.
# What happens: `outliers_gesd` returns the readings in order of size, so that a drift or a swing is a ramp and no index
#   or time fits any more; `outliers_iqr`, `outliers_grubbs` and `outliers_tietjen` keep the order, and so does the mask
#   that gesd returns with hypo=True. With one NaN among 60 readings no filter takes the outlier of 15 beside a swing of 1
#   alone: iqr returns nothing at all, the others everything; gesd, if the NaN is the fourth reading, leaves out the
#   outlier, the NaN and the three good readings before it. The package does not warn.
# Package: scikit-posthocs 0.17.1, numpy 2.4.6, scipy 1.17.1, pandas 3.1.1. Source: found by trying; the page says
#   "filtered array", and the readings of its example are in order of size.
# Who is hurt: whoever cleans a record in time before a fit or a spectrum.
# Instead: the mask of hypo=True on the record without its NaN (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 statsmodels==0.15.0 scikit-posthocs==0.17.1
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
import scikit_posthocs as sp

print(*(f"{name} {version(name)}" for name in ("scikit-posthocs", "numpy", "scipy", "pandas")))
record = 20.0 + np.sin(np.arange(60) * 0.4)
record[30] = 35.0
right = np.delete(record, 30)
filters = {
    "iqr": sp.outliers_iqr,
    "grubbs": sp.outliers_grubbs,
    "tietjen": lambda readings: sp.outliers_tietjen(readings, 1),
    "gesd": sp.outliers_gesd,
}
for name, clean in filters.items():
    left = np.asarray(clean(record))
    print(f"{name}: {len(left)} left, from one to the next {abs(np.diff(left)).mean():.3f}, right {abs(np.diff(right)).mean():.3f}")
    assert np.array_equal(left, np.sort(right) if name == "gesd" else right)
mask = sp.outliers_gesd(record, hypo=True)
assert np.flatnonzero(mask).tolist() == [30]
for place in (10, 3):
    gap = record.copy()
    gap[place] = np.nan
    for name, clean in filters.items():
        left = np.asarray(clean(gap))
        good = len(left) - np.isnan(left).sum() - (left == 35.0).sum()
        print(f"{name} with reading {place} lost: {good} of 58 good readings left, NaN {np.isnan(left).sum()}, outlier {(left == 35.0).sum()}")
        if name == "iqr":
            assert len(left) == 0
        elif name == "gesd" and place == 3:
            mask = sp.outliers_gesd(gap, hypo=True)
            print("its mask:", np.flatnonzero(mask))
            assert mask[:3].all() and good < 58
        else:
            assert len(left) == 60 and good == 58
kept = gap[~np.isnan(gap)]
mended = kept[~sp.outliers_gesd(kept, hypo=True)]
assert np.array_equal(mended, np.delete(record, [3, 30]))
print("mask of the record without NaN:", len(mended), "readings in order")
PROGRAM
