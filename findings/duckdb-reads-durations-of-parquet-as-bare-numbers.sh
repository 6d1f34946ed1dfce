#!/usr/bin/env bash
# Expected: a column of durations in a Parquet file is a duration for DuckDB, an INTERVAL, as it is when DuckDB reads
#   the same data frame itself.
# What happens: Parquet has no type for it: it is a plain BIGINT in the unit of whoever wrote it. Half a second is
#   500000000 of a pandas frame in ns, 500000 of one in us and 500 of a polars frame in ms; two such files read together
#   are one column with a mean of both. The unit stands only in a note (ARROW:schema), which pandas and polars read.
# Packages: duckdb 2.0.1, pandas 3.1.1, pyarrow 26.0.1, polars 2.1.0. Source: found by trying.
# Who is hurt: whoever joins logs of many runs by DuckDB. Instead: store durations as float seconds, with the unit in
#   the name; or hand the frame itself to DuckDB (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 pyarrow==26.0.1 polars==2.1.0 duckdb==2.0.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import duckdb
import pandas as pd
import polars as pl
import pyarrow

seconds = [0.5, 1.5]
files = {
    "pandas-ns": pd.DataFrame({"wait": pd.to_timedelta(seconds, unit="s").as_unit("ns")}),
    "pandas-us": pd.DataFrame({"wait": pd.to_timedelta(seconds, unit="s").as_unit("us")}),
    "polars-ms": pl.DataFrame({"wait": pl.Series([500, 1500]).cast(pl.Duration("ms"))}),
}
print("duckdb", duckdb.__version__, "pandas", pd.__version__, "pyarrow", pyarrow.__version__, "polars", pl.__version__)
seen = {}
for name, frame in files.items():
    if isinstance(frame, pd.DataFrame):
        frame.to_parquet(f"{name}.parquet")
    else:
        frame.write_parquet(f"{name}.parquet")
    seen[name] = duckdb.sql(f"SELECT wait, typeof(wait) FROM '{name}.parquet'").fetchall()
    itself = duckdb.sql("SELECT wait, typeof(wait) FROM frame").fetchall()
    print(f"{name}: 0.5 s and 1.5 s from the file: {seen[name]}; from the frame: {itself}")
    assert [t for _, t in itself] == ["INTERVAL"] * 2 and itself[0][0].total_seconds() == 0.5
    assert pd.read_parquet(f"{name}.parquet")["wait"].dt.total_seconds().tolist() == seconds
    assert pl.read_parquet(f"{name}.parquet")["wait"].dt.total_milliseconds().to_list() == [500, 1500]
for name, unit in {"pandas-ns": 10**9, "pandas-us": 10**6, "polars-ms": 10**3}.items():
    assert seen[name] == [(unit // 2, "BIGINT"), (3 * unit // 2, "BIGINT")]
both = duckdb.sql("SELECT avg(wait) FROM read_parquet(['pandas-ns.parquet', 'polars-ms.parquet'])").fetchall()[0][0]
print(f"mean of two files that hold the same: {both}")
assert both == (1e9 + 1e3) / 2
# instead
pd.DataFrame({"wait_s": seconds}).to_parquet("floats.parquet")
assert duckdb.sql("SELECT avg(wait_s) FROM 'floats.parquet'").fetchall()[0][0] == 1.0
PROGRAM
