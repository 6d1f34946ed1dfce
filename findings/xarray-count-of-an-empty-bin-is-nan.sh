#!/usr/bin/env bash
# Expected: a bin without readings has the count 0 and, as in pandas, the sum 0.
# What happens: `resample(...).count()` and `groupby_bins(...).count()` give NaN for an empty bin, and so make the
#   counts floats; a sum is NaN too, although xarray's own sum of nothing, or of only NaN, is 0.
# Package: xarray 2026.9.0, with and without flox; pandas 3.1.1 gives 0.
# Who is hurt: whoever finds the gaps of a log by `count() == 0` or `count() < 5`: there are none.
# Instead: `.fillna(0).astype(int)` after the count (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 xarray==2026.9.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import pandas as pd
import xarray as xr

times = pd.to_datetime([0, 300, 2500], unit="ms")
series = pd.Series([1.0, 2.0, 3.0], index=times)
array = xr.DataArray(series.to_numpy(), dims="t", coords={"t": times})
assert series.resample("1s").count().tolist() == [2, 0, 1]
assert series.resample("1s").sum().tolist() == [3.0, 0.0, 3.0]
counts = array.resample(t="1s").count()
assert counts.dtype == np.float64 and np.isnan(counts.values[1])
assert np.isnan(array.resample(t="1s").sum().values[1])
edges = pd.to_datetime([-1, 1000, 2000, 3000], unit="ms")
assert np.isnan(array.groupby_bins("t", bins=edges).count().values[1])
assert not (counts == 0).any() and not (counts < 1).any()
assert float(array.isel(t=slice(0, 0)).sum()) == 0.0
assert int(array.isel(t=slice(0, 0)).count()) == 0
# instead
assert counts.fillna(0).astype(int).values.tolist() == [2, 0, 1]
print("xarray", xr.__version__, "pandas", pd.__version__)
print("count per second: xarray", counts.values, "pandas", series.resample("1s").count().tolist())
PROGRAM
