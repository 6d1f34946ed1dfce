#!/usr/bin/env bash
# Expected: `nan`, `Inf` and `+1.25` are numbers in a CSV file, as for C, Python, NumPy and pandas.
# What happens: `read_csv` knows `NaN`, `+inf` and `+1.25E-03`, but one cell `nan` (as NumPy's `savetxt` and C's
#   `printf` write), `Inf`, or a whole number with its sign, `+3`, makes the whole column text, without a word.
# Packages: polars 2.1.0 beside pandas 3.1.1.
# Who is hurt: whoever reads an instrument's file and finds text far behind, where a comparison fails.
# Instead: a stated type (`schema_overrides`), which takes them all, or a cast afterwards (tried below). Source: found
#   by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 polars==2.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import io
import math

import numpy as np
import pandas as pd
import polars as pl

file = io.BytesIO()
np.savetxt(file, [[0.0, 1.5], [1.0, np.nan]], delimiter=",", header="t,v", comments="")
written = pl.read_csv(file.getvalue())
assert written.schema == {"t": pl.Float64, "v": pl.String}
numbers = {"NaN": True, "inf": True, "+inf": True, "-inf": True, "1E+03": True, "+1.25E-03": True}
text = {"nan": False, "Inf": False, "+3": False}
for cell, expected in {**numbers, **text}.items():
    content = f"t,v\n0,0.5\n1,{cell}\n"
    assert pd.read_csv(io.StringIO(content))["v"].dtype == "float64"
    column = pl.read_csv(content.encode())["v"]
    assert (column.dtype == pl.Float64) is expected, cell
    # instead
    stated = pl.read_csv(content.encode(), schema_overrides={"v": pl.Float64})["v"][1]
    for value in (stated, column.cast(pl.Float64)[1]):
        assert value == float(cell) or math.isnan(value) and math.isnan(float(cell))
print("polars", pl.__version__, "numpy", np.__version__, "pandas", pd.__version__)
print("a column stays numbers with", ", ".join(numbers), "and becomes text with", ", ".join(text))
PROGRAM
