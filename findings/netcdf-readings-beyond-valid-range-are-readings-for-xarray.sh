#!/usr/bin/env bash
# Expected: netCDF4 and xarray, which read by netCDF4, agree on which readings of a file are gaps.
# What happens: netCDF4 masks what lies beyond `valid_range`, `valid_min` or `valid_max`, and what was never written.
#   xarray knows none of these: -999 beside a valid_min of 0 is a reading, and never written int32 is -2147483647, int8
#   -127, float 9.97e36. A mean of 20 degC becomes -133. No warning, by either engine.
# Packages: netCDF4 1.7.5, h5netcdf 1.8.1, xarray 2026.9.0. Source: both document their masking; the difference was
#   found by trying.
# Who is hurt: whoever reads with xarray a logger's file that names a sensor's range in place of a fill value.
# Instead: `where` with the attributes after reading (tried), or write a _FillValue and NaN.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 netCDF4==1.7.5 h5netcdf==1.8.2 h5py==3.16.0 xarray==2026.9.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import h5netcdf
import netCDF4
import numpy as np
import xarray as xr

warnings.simplefilter("error")
with netCDF4.Dataset("log.nc", "w") as file:
    file.createDimension("t", 6)
    limited = file.createVariable("limited", "f8", ("t",))
    limited.valid_min, limited.valid_max = 0.0, 100.0
    limited[:] = [20.0, 21.0, -999.0, 19.0, 20.0, 120.0]
    for name in ("f8", "i4", "i1"):
        file.createVariable(name, name, ("t",))[:4] = [1, 2, 3, 4]
print("netCDF4", netCDF4.__version__, "h5netcdf", h5netcdf.__version__, "xarray", xr.__version__, "numpy",
      np.__version__)
with netCDF4.Dataset("log.nc") as file:
    masked = {name: np.ma.getmaskarray(file[name][:]).tolist() for name in ("limited", "f8", "i4", "i1")}
    mean = float(file["limited"][:].mean())
assert masked["limited"] == [False, False, True, False, False, True] and abs(mean - 20.0) < 1e-9
assert all(masked[name] == [False] * 4 + [True] * 2 for name in ("f8", "i4", "i1"))
for engine in ("netcdf4", "h5netcdf"):
    with xr.open_dataset("log.nc", engine=engine) as data:
        print(f"xarray by {engine}: mean {float(data['limited'].mean()):.1f}, netCDF4 {mean:.1f}; never written: "
              f"{float(data['f8'][5]):.3g}, {int(data['i4'][5])}, {int(data['i1'][5])}")
        assert abs(float(data["limited"].mean()) + 133.0) < 1.0
        assert float(data["f8"][5]) > 9e36 and int(data["i4"][5]) == -2147483647 and int(data["i1"][5]) == -127
        # instead
        read = data["limited"]
        kept = read.where((read >= read.attrs["valid_min"]) & (read <= read.attrs["valid_max"]))
        assert np.isnan(kept.values).tolist() == masked["limited"]
PROGRAM
