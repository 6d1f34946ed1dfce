#!/usr/bin/env bash
# Expected: a sum of small integers is made in 64 bits, as NumPy, pandas and pyarrow do, or in none.
# What happens: polars widens the sum of 8 and 16 bits, but leaves 32 bits as they are: `sum`, `rolling_sum` and the sum
#   of a group wrap to negative numbers without a word; `mean` is right. `dot` wraps for 8 bits too.
# Packages: polars 2.1.0 beside numpy 2.4.6, pandas 3.1.1, pyarrow 26.0.1.
# Who is hurt: whoever adds up the counts of an encoder or ADC that its driver gives as int32 (a day at 24 bits).
# Instead: cast to Int64 or Float64 before the sum (tried below). Source: polars' issue 13782, open since 2024.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 polars==2.1.0 pyarrow==26.0.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.compute as pc

counts = np.full(4, 2_000_000_000, dtype=np.int32)
right = 8_000_000_000
assert counts.sum() == right
assert pd.Series(counts).sum() == right
assert pc.sum(pa.array(counts)).as_py() == right
column = pl.Series("n", counts)
assert column.sum() == right - 2 * 2**32
assert column.rolling_sum(2).to_list()[1] == 4_000_000_000 - 2**32
group = pl.DataFrame({"g": [1, 1, 1, 1], "n": column}).group_by("g").agg(pl.col("n").sum())
assert group["n"].to_list() == [right - 2 * 2**32]
assert group["n"].dtype == pl.Int32
assert column.mean() == 2e9
small = pl.Series([30_000] * 4, dtype=pl.Int16)
assert small.sum() == 120_000
assert pl.Series([200, 200], dtype=pl.UInt8).sum() == 400
byte = pl.Series([200, 200], dtype=pl.UInt8)
assert byte.dot(byte) == 80_000 % 256
# instead
assert column.cast(pl.Int64).sum() == right
print("polars", pl.__version__, "numpy", np.__version__, "pandas", pd.__version__, "pyarrow", pa.__version__)
print("sum of four int32 of 2e9:", column.sum(), "mean:", column.mean(), "sum of int16:", small.sum())
PROGRAM
