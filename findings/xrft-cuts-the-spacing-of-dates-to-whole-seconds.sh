#!/usr/bin/env bash
# Expected: the spectrum of a record with date and time has the record's own frequencies; a sine of 0.0667 Hz, read
#   every 1.5 s, has its peak there, as with the same seconds as plain numbers.
# What happens: the spacing of dates is cut to whole seconds: 1.5 s is taken as 1 s and the peak stands at 0.1 Hz, 2.9 s
#   as 2 s. The density is too small by the same factor, so that the variance under it looks right. Only below 1 s is
#   there an error ("spacing is zero"). No warning.
# Packages: xrft 1.0.1, xarray 2026.9.0. Source: found by trying.
# Who is hurt: whoever logs drifts, temperatures or long walks at odd intervals.
# Instead: replace the times by seconds as floats first (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 xarray==2026.9.0 dask==2026.8.0 xrft==1.0.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import pandas as pd
import xarray as xr
import xrft

warnings.simplefilter("error", UserWarning)
warnings.simplefilter("error", RuntimeWarning)
warnings.simplefilter("ignore", FutureWarning)


def peak(times, readings):
    """Frequency of the peak, Hz, its density, and the variance under the whole spectrum."""
    record = xr.DataArray(readings, dims="t", coords={"t": times})
    power = xrft.power_spectrum(record, dim="t")
    frequency = power["freq_t"].values
    at = int(np.argmax(power.values))
    return abs(frequency[at]), float(power[at]), float(power.sum() * (frequency[1] - frequency[0]))


print("xrft", version("xrft"), "xarray", xr.__version__, "pandas", pd.__version__, "numpy", np.__version__)
for step, taken in ((1.5, 1.0), (2.9, 2.0), (4.0, 4.0)):
    seconds = np.arange(200) * step
    readings = np.sin(2.0 * np.pi * 0.1 / step * seconds)
    dates = pd.Timestamp("2026-01-01") + pd.to_timedelta(seconds, unit="s")
    (seen, density, variance), (right, density_right, variance_right) = peak(dates, readings), peak(seconds, readings)
    print(f"every {step} s: peak at {seen:.4f} Hz by dates, {right:.4f} Hz by seconds, "
          f"density {density:.1f} and {density_right:.1f}, variance {variance:.3f} and {variance_right:.3f}")
    assert abs(right - 0.1 / step) < 1e-9
    assert abs(seen - 0.1 / taken) < 1e-9
    assert abs(density / density_right - taken / step) < 1e-9
    assert abs(variance - 0.5) < 1e-9 and abs(variance_right - 0.5) < 1e-9
PROGRAM
