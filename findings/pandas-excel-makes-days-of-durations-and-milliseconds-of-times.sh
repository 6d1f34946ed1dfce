#!/usr/bin/env bash
# Expected: `to_excel` and `read_excel` bring a table of times and durations back; a duration that comes back as a
#   number is one of seconds.
# What happens: half a second is read as 5.787e-06: durations become days, as plain floats, and Excel shows them as 0.
#   Times lose what is below a millisecond: ten readings 100 us apart have two times, and openpyxl rounds 500 us down,
#   calamine up, so that the same file has two records. No warning.
# Packages: pandas 3.1.1, openpyxl 3.1.5, python-calamine 0.9.1, xlsxwriter 3.3.1. Source: found by trying.
# Who is hurt: whoever hands logs on as .xlsx: rates are infinite, and sorting by time mixes readings.
# Instead: store seconds as floats, with the unit in the name (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 et_xmlfile==2.0.0 openpyxl==3.1.5 python-calamine==0.9.1 xlsxwriter==3.3.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import openpyxl
import pandas as pd

warnings.simplefilter("error")
seconds = np.arange(10) * 1e-4
table = pd.DataFrame({
    "time": pd.Timestamp("2026-01-02 03:04:05") + pd.to_timedelta(seconds, unit="s").as_unit("us"),
    "wait": pd.to_timedelta(np.full(10, 0.5), unit="s"),
    "seconds": seconds,
})
assert table["time"].nunique() == 10
print(*(f"{name} {version(name)}" for name in ("pandas", "openpyxl", "python-calamine", "xlsxwriter")))
for writer in ("openpyxl", "xlsxwriter"):
    table.to_excel("log.xlsx", index=False, engine=writer)
    cell = openpyxl.load_workbook("log.xlsx").active["B2"]
    assert cell.number_format == "0"  # what Excel shows
    late = {}
    for reader in ("openpyxl", "calamine"):
        seen = pd.read_excel("log.xlsx", engine=reader)
        late[reader] = (seen["time"] - table["time"]).dt.total_seconds().to_numpy()
        print(f"{writer} to {reader}: 0.5 s is {seen['wait'][0]:.4g} ({seen['wait'].dtype}), "
              f"{seen['time'].nunique()} different times of 10, off by {np.abs(late[reader]).max() * 1e6:.0f} us")
        assert seen["wait"].dtype == float and np.allclose(seen["wait"], 0.5 / 86400.0)
        assert seen["time"].nunique() == 2
        assert np.allclose(seen["seconds"], seconds)  # instead
    assert abs(late["calamine"][5] - late["openpyxl"][5] - 1e-3) < 1e-9
PROGRAM
