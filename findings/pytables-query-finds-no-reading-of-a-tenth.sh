#!/usr/bin/env bash
# Expected: `read_where("x == 0.1")` finds the rows that numpy's `rows["x"] == 0.1` finds.
# What happens: in a column of float32 the constant stays a float64, so that 0.1 equals nothing, and "x > 0.1" takes all
#   rows of 0.1 with it; numpy and pandas' `query` compare in float32. In uint8 the query is made in 32 bits: "u + u >
#   255" and "u - 1 < 0" find rows, and so does pandas' `query` if numexpr is installed, but none without it, as numpy.
#   No warning.
# Package: tables 3.11.1, numexpr 2.14.2, pandas 3.1.1, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever selects the runs of a setting of 0.1 by a query: no row, or by a threshold: too many.
# Instead: numpy.float32(0.1) by `condvars`, a band of two thresholds, columns made float or wider (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 numexpr==2.14.2 tables==3.11.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numexpr
import numpy as np
import pandas
import tables

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("tables", "numexpr", "pandas", "numpy")))
rows = np.zeros(3000, [("x", np.float32), ("u", np.uint8)])
rows["x"] = np.tile([0.0, 0.1, 0.25], 1000)
rows["u"] = np.tile([0, 100, 200], 1000)
columns = {name: rows[name] for name in rows.dtype.names}
frame = pandas.DataFrame(columns)
with tables.open_file("record.h5", "w") as file:
    table = file.create_table("/", "record", obj=rows)
    for condition, tables_finds, numpy_finds in (
            ("x == 0.1", 0, 1000), ("x > 0.1", 2000, 1000), ("x == 0.25", 1000, 1000), ("u + u > 255", 1000, 0),
            ("u - 1 < 0", 1000, 0)):
        found = {
            "tables": len(table.read_where(condition)),
            "numexpr": int(numexpr.evaluate(condition, columns).sum()),
            "numpy": int(eval(condition, {}, columns).sum()),
            "pandas with numexpr": len(frame.query(condition)),
            "pandas without": len(frame.query(condition, engine="python"))}
        print(f"{condition}:", ", ".join(f"{name} {number}" for name, number in found.items()), "rows")
        assert found["tables"] == found["numexpr"] == tables_finds
        assert found["numpy"] == found["pandas without"] == numpy_finds
        assert found["pandas with numexpr"] == (numpy_finds if "x" in condition else tables_finds)
    mended = [len(table.read_where("x == tenth", {"tenth": np.float32(0.1)})),
              len(table.read_where("(x > 0.099) & (x < 0.101)")), int((rows["u"].astype(int) * 2 > 255).sum())]
    print(f"with a float32, a band, a wider column: {mended}")
    assert mended == [1000, 1000, 1000]
PROGRAM
