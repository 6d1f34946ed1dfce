#!/usr/bin/env bash
# Expected: `savemat` refuses dates and durations, or stores them in one unit that MATLAB and `loadmat` can tell.
# What happens: they become doubles in whatever unit each array has: the same second is 1.8e9, 1.8e12, 1.8e15 or 1.8e18,
#   a duration of 1.5 s is 1500 in ms and 1.5e6 in pandas' us; NaT is -9.2e18. From ns a date loses 100 ns and more. The
#   file does not hold the unit. No warning.
# Packages: scipy 1.17.1, pandas 3.1.1. Source: found by trying; the docstring names no dates.
# Who is hurt: whoever hands a log to a colleague's MATLAB: pandas 3 changed ns to us under the same code.
# Instead: seconds since a start, as floats, with the start as a text of its own (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import pandas as pd
import scipy
from scipy.io import loadmat, savemat

warnings.simplefilter("error")
second = np.datetime64("2026-11-28T20:30:00")
stored = {}
for unit in ("s", "ms", "us", "ns"):
    savemat("log.mat", {"t": np.array([second], f"M8[{unit}]"), "d": np.array([1500], "m8[ms]").astype(f"m8[{unit}]"),
                        "gap": np.array(["NaT"], f"M8[{unit}]")})
    back = loadmat("log.mat")
    assert back["t"].dtype == float
    stored[unit] = float(back["t"][0, 0])
    print(f"in {unit}: a date is {stored[unit]:.6g}, 1.5 s are {float(back['d'][0, 0]):g}, NaT {back['gap'][0, 0]:.3g}")
    assert float(back["d"][0, 0]) == {"s": 1.0, "ms": 1500.0, "us": 1.5e6, "ns": 1.5e9}[unit]
    assert float(back["gap"][0, 0]) == -(2.0**63)
print("scipy", scipy.__version__, "pandas", pd.__version__, "numpy", np.__version__)
seconds = (second - np.datetime64("1970-01-01T00:00:00")).astype(float)
assert [stored[unit] / seconds for unit in ("s", "ms", "us", "ns")] == [1.0, 1e3, 1e6, 1e9]
times = pd.date_range(str(second), periods=2, freq="1s")
savemat("log.mat", {"t": times})
assert float(loadmat("log.mat")["t"][0, 0]) == stored[times.unit] and times.unit == "us"
fine = np.array(["2026-11-28T20:30:00.000000001"], "M8[ns]")
savemat("log.mat", {"t": fine})
assert int(loadmat("log.mat")["t"][0, 0]) != int(fine.astype(np.int64)[0])
# instead
savemat("log.mat", {"t": (times - times[0]) / pd.Timedelta("1s"), "start": str(times[0])})
back = loadmat("log.mat")
assert back["t"].ravel().tolist() == [0.0, 1.0] and pd.Timestamp(str(back["start"][0])) == times[0]
PROGRAM
