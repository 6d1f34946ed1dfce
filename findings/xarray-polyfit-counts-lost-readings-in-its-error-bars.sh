#!/usr/bin/env bash
# Expected: `polyfit(..., cov=True)` leaves NaN out (`skipna`), and its covariance is that of the readings that are
#   left, as numpy's polyfit of them gives it.
# What happens: the coefficients are right, but the covariance is made with all times and the number of all readings.
#   With three readings in four lost the error of a slope is four times too small. No warning.
# Package: xarray 2026.9.0. Source: found by trying.
# Who is hurt: whoever states a speed with its error from a record with lost frames, or compares two of them.
# Instead: dropna along the dimension before polyfit (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 xarray==2026.9.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import xarray as xr

warnings.simplefilter("error")
print("xarray", xr.__version__, "numpy", np.__version__)
random = np.random.default_rng(0)
time = np.linspace(0.0, 10.0, 400)
readings = 2.0 * time + random.normal(size=400)
for lost in (0.0, 0.5, 0.75):
    seen = np.where(random.random(400) < lost, np.nan, readings)
    there = ~np.isnan(seen)
    record = xr.DataArray(seen, coords={"time": time}, dims="time")
    fit = record.polyfit("time", 1, cov=True)
    stated = np.sqrt(np.diag(fit.polyfit_covariance))
    slope, covariance = np.polyfit(time[there], seen[there], 1, cov=True)
    right = np.sqrt(np.diag(covariance))
    print(f"{there.sum()} of 400 left: slope {float(fit.polyfit_coefficients[0]):.4f} +- {stated[0]:.4f}, numpy "
          f"{slope[0]:.4f} +- {right[0]:.4f}")
    assert np.isclose(float(fit.polyfit_coefficients[0]), slope[0], rtol=1e-9)
    assert np.isclose(stated[0], right[0] * there.mean(), rtol=0.1)
    # instead
    again = record.dropna("time").polyfit("time", 1, cov=True)
    assert np.allclose(np.sqrt(np.diag(again.polyfit_covariance)), right, rtol=1e-9)
PROGRAM
