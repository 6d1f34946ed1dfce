#!/usr/bin/env bash
# Expected: `differentiate`, `integrate` and `polyfit` along time have one unit, whatever the clock's resolution.
# What happens: `differentiate` and `integrate` count in the coordinate's own unit (s, ms, us, ns), `polyfit` of dates
#   always in ns: one ramp has slopes of 1e-6 and 1e-9. What pandas 2 made in ns pandas 3 makes in us.
# Packages: xarray 2026.9.0, pandas 3.1.1.
# Who is hurt: a speed by `differentiate("t") * 1e9`, right with dates in ns, is 1000 times too large with those of
#   pandas 3.
# Instead: `datetime_unit="s"` for dates, or a coordinate of float seconds for all (tried below).
# Source: found by trying; the defaults of `datetime_unit` are documented, what they mean since pandas 3 is not.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 xarray==2026.9.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import pandas as pd
import xarray as xr

clock = pd.date_range("2026-01-01", periods=4, freq="1s")
assert clock.dtype == "datetime64[us]"
found = {}
for unit in ("s", "ms", "us", "ns"):
    way = xr.DataArray([0.0, 1.0, 2.0, 3.0], dims="t", coords={"t": clock.as_unit(unit)})
    speed = float(way.differentiate("t")[1])
    area = float(way.integrate("t"))
    fitted = float(way.polyfit("t", 1).polyfit_coefficients[0])
    found[unit] = (speed, area, fitted)
    assert float(way.differentiate("t", datetime_unit="s")[1]) == 1.0
    assert float(way.integrate("t", datetime_unit="s")) == 4.5
per_second = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
for unit, (speed, area, fitted) in found.items():
    assert np.isclose(speed, 1.0 / per_second[unit], rtol=1e-12, atol=0.0)
    assert np.isclose(area, 4.5 * per_second[unit], rtol=1e-12, atol=0.0)
    assert np.isclose(fitted, 1e-9, rtol=1e-4, atol=0.0)
# instead: seconds as numbers
since = (way.t - way.t[0]) / np.timedelta64(1, "s")
plain = way.assign_coords(t=since)
assert np.isclose(plain.polyfit("t", 1).polyfit_coefficients[0], 1.0)
assert float(plain.differentiate("t")[1]) == 1.0
print("xarray", xr.__version__, "pandas", pd.__version__)
for unit, row in found.items():
    print(f"clock in {unit}: differentiate {row[0]:g}, integrate {row[1]:g}, polyfit {row[2]:.4g}")
PROGRAM
