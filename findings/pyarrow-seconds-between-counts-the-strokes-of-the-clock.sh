#!/usr/bin/env bash
# Expected: `seconds_between` and its siblings give the time between two instants, cut or rounded to whole units.
# What happens: they count the strokes of the clock between them: from 0.999 to 1.001 s is 1 s, from 0.000 to 0.999 s is
#   0 s. Of 1000 lags of 0.4 s 400 are 1 s; a lag of 0.4 ms is 0 or 1 ms; a pulse of 20 ms at midnight lasts one day.
#   DuckDB's `date_diff` counts alike, and its `date_sub` whole units. The mean is right, so that nothing shows it.
#   No warning.
# Package: pyarrow 26.0.1, duckdb 2.0.1, numpy 2.4.6. Source: boundaries are named in both documentations.
# Who is hurt: whoever takes lags, latencies or durations of slips from two columns of instants.
# Instead: `pyarrow.compute.subtract`, and `epoch_us` of both in DuckDB (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pyarrow==26.0.1 duckdb==2.0.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import duckdb
import numpy as np
import pyarrow
import pyarrow.compute as compute

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("pyarrow", "duckdb", "numpy")))
midnight = np.datetime64("2026-01-01", "us").astype(int)


def pairs(starts, lag):
    """A table of instants in whole microseconds."""
    starts = midnight + np.asarray(starts)
    kind = pyarrow.timestamp("us")
    return pyarrow.table({"start": pyarrow.array(starts, kind), "stop": pyarrow.array(starts + lag, kind)})


for name, unit, starts, lag, shares in (
        ("seconds", "second", np.arange(1000) * 1000, 400_000, {0: 0.6, 1: 0.4}),
        ("milliseconds", "millisecond", np.arange(1000), 400, {0: 0.6, 1: 0.4}),
        ("seconds", "second", [999_000], 2000, {1: 1.0}), ("seconds", "second", [0], 999_000, {0: 1.0}),
        ("minutes", "minute", [59_990_000], 20_000, {1: 1.0}), ("days", "day", [-10_000], 20_000, {1: 1.0})):
    lags = pairs(starts, lag)
    found = getattr(compute, f"{name}_between")(lags["start"], lags["stop"]).to_numpy()
    query = duckdb.sql(f"select date_diff('{unit}', start, stop) as strokes, date_sub('{unit}', start, stop) as whole, "
                       "epoch_us(stop) - epoch_us(start) as lag from lags").to_arrow_table()
    exact = compute.cast(compute.subtract(lags["stop"], lags["start"]), pyarrow.int64()).to_numpy()
    values, counts = np.unique(found, return_counts=True)
    seen = {int(value): float(count) / len(found) for value, count in zip(values, counts)}
    print(f"{len(found)} lags of {lag} us in {name}: {seen}; date_sub {np.unique(query['whole'].to_numpy())}, subtract "
          f"{np.unique(exact)} us")
    assert seen == shares
    assert np.array_equal(query["strokes"].to_numpy(), found) and np.all(query["whole"].to_numpy() == 0)
    assert np.all(exact == lag) and np.all(query["lag"].to_numpy() == lag)
PROGRAM
