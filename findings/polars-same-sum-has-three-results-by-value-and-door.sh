#!/usr/bin/env bash
# Expected: `column + 300` of 8 bits does the same for a series and in an expression, and its type does not hang on the
#   number.
# What happens: the expression gives 16 bits for 300 (500) and stays in 8 bits for 100 (200 + 100 is 44); the series
#   raises for 300. A Python float keeps float32, a NumPy float of the same value makes float64.
# Package: polars 2.1.0 (numpy 2.4.6 raises for 300 and wraps for 100, in one way).
# Who is hurt: whoever subtracts a dark level or adds an offset to 8-bit grey values: below 256 it wraps, above it does
#   not.
# Instead: cast to a signed or float type before the arithmetic (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 polars==2.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import polars as pl

grey = pl.DataFrame({"v": pl.Series([200], dtype=pl.UInt8)})
out = grey.select(
    small=pl.col("v") + 100, large=pl.col("v") + 300, dark=pl.col("v") - 201, deep=pl.col("v") - 300
)
assert out.schema["small"] == pl.UInt8 and out["small"][0] == 44
assert out.schema["large"] == pl.UInt16 and out["large"][0] == 500
assert out["dark"][0] == 255
assert out.schema["deep"] == pl.UInt16 and out["deep"][0] == 65536 - 100
try:
    grey["v"] + 300
except OverflowError as error:
    refused = str(error)
else:
    raise SystemExit("the series takes 300 now")
assert (grey["v"] + 100)[0] == 44
single = pl.DataFrame({"v": pl.Series([1.5], dtype=pl.Float32)})
types = single.select(python=pl.col("v") * 2.0, numpy=pl.col("v") * np.float64(2.0)).schema
assert types["python"] == pl.Float32 and types["numpy"] == pl.Float64
# instead
safe = grey.select((pl.col("v").cast(pl.Int32) - 201).alias("v"))
assert safe["v"][0] == -1
print("polars", pl.__version__, "numpy", np.__version__)
print("200 in 8 bits: +100 is", out["small"][0], ", +300 is", out["large"][0], ", -201 is", out["dark"][0])
print("the series with +300:", refused)
PROGRAM
