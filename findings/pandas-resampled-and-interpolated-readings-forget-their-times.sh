#!/usr/bin/env bash
# Expected: `series.resample("500ms").interpolate()` of readings at uneven times is their line at each half second.
# What happens: the grid's instants are put among the readings, and all of them are taken as evenly spaced: of readings
#   that equal their time, 2.0 s is 1.70 and 3.5 s is 3.485. A grid that begins before the first reading begins with
#   NaN. No warning. `interpolate("time")` and numpy are right.
# Package: pandas 3.1.1. Source: the method documents that its default ignores the index; since 3.0 readings off the
#   grid take part (pull request 61183).
# Who is hurt: whoever brings two logs to one clock.
# Instead: resample(...).interpolate("time") (tried), or numpy.interp (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import pandas as pd

warnings.simplefilter("error")
seconds = np.array([0.0, 1.0, 2.05, 2.95, 4.02, 5.0])
start = pd.Timestamp("2026-01-01")


def series(offset=0.0):
    return pd.Series(seconds + offset, index=start + pd.to_timedelta(seconds + offset, unit="s"))


seen = series().resample("500ms").interpolate()
by_time = series().resample("500ms").interpolate("time")
grid = ((seen.index - start) / pd.Timedelta("1s")).to_numpy()
print("pandas", pd.__version__, "numpy", np.__version__)
for at, default, right in zip(grid, seen, by_time, strict=True):
    print(f"at {at:.1f} s: {default:.4f} by default, {right:.4f} by time")
off = np.abs(seen.to_numpy() - grid)
assert np.array_equal(grid, np.arange(0.0, 5.1, 0.5))
assert abs(off.max() - 0.3) < 0.01 and abs(off[4] - 0.3) < 0.01
late = series(0.013).resample("500ms").interpolate()
print("a record that begins at 0.013 s:", late.to_numpy()[:3].round(3).tolist())
assert np.isnan(late.iloc[0]) and abs(late.iloc[1] - 0.5) > 0.1
# instead
assert np.abs(by_time.to_numpy() - grid).max() < 1e-6
assert np.abs(np.interp(grid, seconds, seconds) - grid).max() < 1e-12
PROGRAM
