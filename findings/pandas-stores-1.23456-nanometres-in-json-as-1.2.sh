#!/usr/bin/env bash
# Expected: what `to_json` writes, `read_json` reads again, as with every other writer of JSON.
# What happens: numbers have ten decimals, counted from the point: 1.23456e-9 is stored as 1.2e-9, 1/3 of a micrometre
#   as 3.333e-7, 2e-11 as 0, yet 1e-16 as itself. Instants are cut to whole milliseconds: frames 0.1 ms apart stand
#   at one instant, ten at a time, and orient="table" restores their type beside it. No warning.
# Package: pandas 3.1.1, numpy 2.4.6. Source: double_precision=10 and date_unit="ms" are documented.
# Who is hurt: whoever keeps readings in SI units or fast frames in JSON.
# Instead: df.to_dict("list") through `json` (tried), date_unit="ns" for instants (tried); double_precision=15, the most
#   there is, keeps seven digits of 1.23456e-9 (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import io
import json
import warnings

import numpy as np
import pandas as pd

warnings.simplefilter("error")
print("pandas", pd.__version__, "numpy", np.__version__)
readings = [1.23456, 1.23456e-6, 1e-6 / 3, 1.23456e-9, 2e-11, 1e-16]
table = pd.DataFrame({"x": readings})


def back(text):
    return pd.read_json(io.StringIO(text))["x"].tolist()


found, most = back(table.to_json()), back(table.to_json(double_precision=15))
plain = json.loads(json.dumps(table.to_dict("list")))["x"]
for written, read, read_15, kept in zip(readings, found, most, plain):
    print(f"{written!r}: read {read!r}, with 15 decimals {read_15!r}, through json {kept!r}")
assert plain == readings
assert found[0] == 1.23456 and np.allclose(found[1:4], [1.2346e-6, 3.333e-7, 1.2e-9], rtol=1e-9, atol=0)
assert found[4:] == [0.0, 1e-16] and np.isclose(most[3], 1.23456e-9, rtol=1e-9, atol=0)

frames = pd.DataFrame({"at": pd.Timestamp("2026-01-01") + pd.to_timedelta(100 * np.arange(50), unit="us"), "x": 1.0})
for date_unit, different in ((None, 5), ("ns", 50)):
    options = {} if date_unit is None else {"date_unit": date_unit}
    read = pd.read_json(io.StringIO(frames.to_json(orient="table", date_format="iso", **options)), orient="table")
    print(f"50 frames 0.1 ms apart, date_unit {date_unit}: {read['at'].nunique()} different instants")
    assert read["at"].nunique() == different
PROGRAM
