#!/usr/bin/env bash
# Expected: times are times: `interp` onto the same instants in another unit (s, ms, us, ns) gives the same values.
# What happens: a target in a finer unit than the coordinate gives NaN, even at the record's own instants; with
#   extrapolation it gives values 1000 or 10^9 times off; a string gives NaN too. Coarser targets and `sel` are right.
# Packages: xarray 2026.9.0, pandas 3.1.1 (whose times are in us, but whose `timedelta_range` is in ns), scipy 1.17.1.
# Who is hurt: whoever resamples a log onto another instrument's times since pandas 3: rows vanish as gaps.
# Instead: bring the target to the unit of the coordinate, `.astype(record.t.dtype)` (tried below). Source: found by
#   trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 scipy==1.17.1 xarray==2026.9.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import pandas as pd
import scipy
import xarray as xr

seconds = np.datetime64("2026-01-01T00:00:00", "us") + np.arange(4) * np.timedelta64(1_000_000, "us")
record = xr.DataArray([0.0, 1.0, 2.0, 3.0], dims="t", coords={"t": seconds})
own = record.t.values[1:3]
for unit in ("s", "ms", "us"):
    assert record.interp(t=own.astype(f"M8[{unit}]")).values.tolist() == [1.0, 2.0]
finer = own.astype("M8[ns]")
assert (finer == own).all()
assert np.isnan(record.interp(t=finer).values).all()
assert record.sel(t=finer).values.tolist() == [1.0, 2.0]
beyond = record.interp(t=finer, kwargs={"fill_value": "extrapolate"}).values
assert beyond.tolist() == [1000.0, 2000.0]
assert np.isnan(record.interp(t="2026-01-01T00:00:01").item())
# durations from zero, as pandas makes them
since = record.assign_coords(t=record.t - record.t[0])
steps = pd.timedelta_range(0, periods=3, freq="500ms")
assert steps.dtype == "timedelta64[ns]"
lost = since.interp(t=steps).values
assert np.isnan(lost[1:]).all()
# instead
assert since.interp(t=steps.astype(since.t.dtype)).values.tolist() == [0.0, 0.5, 1.0]
assert record.interp(t=finer.astype(record.t.dtype)).values.tolist() == [1.0, 2.0]
print("xarray", xr.__version__, "pandas", pd.__version__, "scipy", scipy.__version__)
print("coordinate in us, target in ns, the record's own times:", record.interp(t=finer).values, "extrapolated:", beyond)
PROGRAM
