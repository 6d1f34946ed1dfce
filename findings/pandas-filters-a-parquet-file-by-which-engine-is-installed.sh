#!/usr/bin/env bash
# Expected: `pandas.read_parquet(file, filters=...)` gives the rows that fulfil the filter, with either engine.
# What happens: with fastparquet, which pandas takes where pyarrow is missing, a filter leaves out whole groups of rows
#   alone: of readings 3, 1, 5, 2 with x > 2.5 all four remain. Durations are stored in whole microseconds, 100 and
#   999 ns as 0, though instants keep nanoseconds; in pyarrow's file it reads durations and times of day as bare
#   integers and float16 as two bytes each. No warning but that the engine will go.
# Package: fastparquet 2026.9.0, pyarrow 26.0.1, pandas 3.1.1, numpy 2.4.6. Source: groups of rows alone are documented.
# Who is hurt: whoever selects runs by a filter on one machine, and takes the mean of all on another.
# Instead: engine="pyarrow" named in the call (tried), or the condition applied again to the frame (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 pyarrow==26.0.1 fastparquet==2026.9.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import datetime
import subprocess
import sys
import warnings
from importlib.metadata import version

import numpy as np
import pandas

warnings.simplefilter("error")
warnings.filterwarnings("ignore", "The 'fastparquet' engine is deprecated")
print(*(f"{name} {version(name)}" for name in ("fastparquet", "pyarrow", "pandas", "numpy")))
lags = [100, 999, 1500, 2000100]
frame = pandas.DataFrame({
    "x": [3.0, 1.0, 5.0, 2.0], "lag": pandas.to_timedelta(lags, unit="ns"), "at": pandas.to_datetime(lags, unit="ns")})
frame.to_parquet("arrow.parquet", engine="pyarrow")
frame.to_parquet("fast.parquet", engine="fastparquet")
condition = [("x", ">", 2.5)]
for name in ("arrow.parquet", "fast.parquet"):
    found = pandas.read_parquet(name, engine="fastparquet", columns=["x"], filters=condition)
    print(f"{name}, x > 2.5 by fastparquet: {found.x.tolist()}, applied again {found[found.x > 2.5].x.tolist()}")
    assert found.x.tolist() == [3.0, 1.0, 5.0, 2.0] and found[found.x > 2.5].x.tolist() == [3.0, 5.0]
by_arrow = pandas.read_parquet("arrow.parquet", engine="pyarrow", filters=condition)
print(f"by pyarrow: {by_arrow.x.tolist()}")
assert by_arrow.x.tolist() == [3.0, 5.0]

own = pandas.read_parquet("fast.parquet", engine="fastparquet")
durations = (own.lag / pandas.Timedelta(1, "ns")).tolist()
instants = own["at"].astype("datetime64[ns]").astype("int64").tolist()
print(f"durations of {lags} ns through fastparquet: {durations}, instants {instants}")
assert durations == [0.0, 0.0, 1000.0, 2000000.0] and instants == lags

other = pandas.DataFrame({
    "lag": pandas.to_timedelta([100, 999], unit="ns"), "half": np.array([1.0, 2.0], np.float16),
    "clock": [datetime.time(12, 0, 0, 500000)] * 2})
other.to_parquet("other.parquet", engine="pyarrow")
read = pandas.read_parquet("other.parquet", engine="fastparquet")
same = pandas.read_parquet("other.parquet", engine="pyarrow")
print("pyarrow's file by fastparquet:", {name: read[name].tolist() for name in read})
assert read.lag.tolist() == [100, 999] and read.half.tolist() == [b"\x00<", b"\x00@"]
assert read.clock.tolist() == [43200500000] * 2 and same.equals(other)

program = """
import sys
sys.modules["pyarrow"] = None  # as where it is not installed
import pandas
print(pandas.read_parquet("fast.parquet", columns=["x"], filters=[("x", ">", 2.5)]).x.tolist())
"""
chosen = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout.strip()
print(f"with no engine named and no pyarrow: {chosen}")
assert chosen == "[3.0, 1.0, 5.0, 2.0]"
PROGRAM
