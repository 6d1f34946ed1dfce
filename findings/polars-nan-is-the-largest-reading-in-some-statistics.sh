#!/usr/bin/env bash
# Expected: NaN is either left out, or carried through: by `max`, `median`, a filter and a join alike.
# What happens: `mean` carries NaN, `max` leaves it out, `top_k(1)`, `sort` and `rolling_max` give it, `median` and
#   `rank` count it as the largest reading (median of 1, 2, NaN is 2, of 1, 2, 3, NaN is 2.5), `filter(v > 0)` keeps it,
#   and `join_asof` forward finds a row whose time is NaN.
# Package: polars 2.1.0 (numpy 2.4.6 has NaN as median, pandas 3.1.1 has 1.5).
# Who is hurt: whoever brings readings with NaN from NumPy: a robust mean is shifted upwards without a word.
# Instead: `fill_nan(None)` first: null is left out everywhere (tried below).
# Source: found by trying; the order of NaN stands in polars' documentation, that `median` follows it does not.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 polars==2.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import math

import numpy as np
import pandas as pd
import polars as pl

nan = float("nan")
readings = [1.0, 2.0, nan]
column = pl.Series("v", readings)
assert math.isnan(np.median(readings))
assert pd.Series(readings).median() == 1.5
assert math.isnan(column.mean())
assert column.max() == 2.0
assert math.isnan(column.top_k(1)[0])
assert column.median() == 2.0
assert pl.Series([1.0, 2.0, 3.0, nan]).median() == 2.5
assert column.rank().to_list() == [1.0, 2.0, 3.0]
assert math.isnan(column.rolling_max(2)[2])
kept = pl.DataFrame({"v": column}).filter(pl.col("v") > 1.5)["v"].to_list()
assert len(kept) == 2 and math.isnan(kept[1])
left = pl.DataFrame({"t": [2.0]})
right = pl.DataFrame({"t": [0.0, 1.5, nan], "v": [1, 2, 3]})
assert left.join_asof(right, on="t", strategy="forward")["v"].to_list() == [3]
# instead
clean = column.fill_nan(None)
assert clean.median() == 1.5 and clean.max() == 2.0 and clean.mean() == 1.5
assert pl.DataFrame({"v": clean}).filter(pl.col("v") > 1.5)["v"].to_list() == [2.0]
print("polars", pl.__version__, "numpy", np.__version__, "pandas", pd.__version__)
print("of 1, 2, NaN: median", column.median(), "max", column.max(), "top", column.top_k(1)[0], "mean", column.mean())
print("rows above 1.5:", kept)
PROGRAM
