#!/usr/bin/env bash
# Expected: half of a duration of 1 s is 0.5 s, and the mean of steps of 1 s and 2 s is 1.5 s.
# What happens: dates and durations stay in their unit and are cut: half is 0 s, the mean step 1 s, its sd 0 s. So in
#   pandas, whose dates are no longer always in ns, in xarray, and in polars in ms; `Timedelta("1us") / 2` is 0.
# Packages: pandas 3.1.1, polars 2.1.0, pyarrow 26.0.1, xarray 2026.9.0, numpy 2.4.6.
# Who is hurt: whoever takes a logger's mean interval or mid-times from stamps in whole seconds or ms, for example from
#   a column of Arrow: a rate 1.5 times too high.
# Instead: go to float seconds before dividing or taking means (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 polars==2.1.0 pyarrow==26.0.1 xarray==2026.9.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import datetime

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import xarray as xr

table = pa.table({"t": pa.array([0, 1, 3], pa.timestamp("s"))})
stamps = table.to_pandas()["t"]
assert stamps.dtype == "datetime64[s]"
steps = stamps.diff().dropna()
assert steps.mean() == pd.Timedelta("1s")
assert steps.median() == pd.Timedelta("1s")
assert steps.std() == pd.Timedelta(0)
assert (steps / 2).tolist() == [pd.Timedelta(0), pd.Timedelta("1s")]
assert stamps.mean() == pd.Timestamp(1, unit="s")
assert pd.Timedelta("1us") / 2 == pd.Timedelta(0)
array = xr.DataArray(steps.to_numpy(), dims="n")
assert array.mean().values == np.timedelta64(1, "s")
assert (array / 2).values[0] == np.timedelta64(0, "s")
thirds = pl.Series([1, 2]).cast(pl.Duration("ms"))
assert thirds.mean() == datetime.timedelta(milliseconds=1)
assert (thirds / 2).to_list()[0] == datetime.timedelta(0)
# instead
seconds = steps / pd.Timedelta("1s")
assert seconds.mean() == 1.5
assert np.isclose(seconds.std(), np.sqrt(0.5))
assert steps.dt.as_unit("ns").mean() == pd.Timedelta("1.5s")
print("pandas", pd.__version__, "polars", pl.__version__, "pyarrow", pa.__version__, "xarray", xr.__version__)
print("steps of 1 s and 2 s: mean", steps.mean(), "sd", steps.std(), "halves", (steps / 2).tolist())
PROGRAM
