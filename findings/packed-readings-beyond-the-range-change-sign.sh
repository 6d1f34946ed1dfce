#!/usr/bin/env bash
# Expected: a value that does not fit the packed integer is refused, clipped or made a gap when it is written.
# What happens: it wraps: 400 degC in int16 of 0.1 is right, 4000 is stored and read as -2553.6, by netCDF4 and by
#   xarray (netCDF, Zarr), without a word. xarray keeps the packing of the file that it read: open a log in steps of
#   0.001, correct one reading to 40, save, and -25.536 is in the new file.
# Packages: netCDF4 1.7.5.1.post1, xarray 2026.9.0, h5netcdf 1.8.2.
# Who is hurt: whoever edits and saves a packed log (temperatures, positions in int16).
# Instead: `drop_encoding()` before saving, or compare what was saved (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 xarray==2026.9.0 netCDF4==1.7.5.1.post1 h5netcdf==1.8.2 h5py==3.16.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import netCDF4
import numpy as np
import xarray as xr

with netCDF4.Dataset("direct.nc", "w") as file:
    file.createDimension("t", 3)
    variable = file.createVariable("v", "i2", ("t",))
    variable.scale_factor = 0.1
    variable[:] = [400.0, 4000.0, -5000.0]
with netCDF4.Dataset("direct.nc") as file:
    direct = np.asarray(file["v"][:])
assert np.allclose(direct, [400.0, -2553.6, 1553.6])
packing = {"v": {"dtype": "int16", "scale_factor": 0.001, "_FillValue": -32768}}
for engine in ("netcdf4", "h5netcdf"):
    xr.Dataset({"v": ("t", [20.0, 21.0])}).to_netcdf("log.nc", engine=engine, encoding=packing)
    log = xr.open_dataset("log.nc", engine=engine).load()
    log.close()
    log["v"][0] = 40.0
    log.to_netcdf("corrected.nc", engine=engine)
    read = xr.open_dataset("corrected.nc", engine=engine).load()["v"].values
    assert np.allclose(read, [-25.536, 21.0])
    # instead
    log.drop_encoding().to_netcdf("whole.nc", engine=engine)
    whole = xr.open_dataset("whole.nc", engine=engine).load()["v"].values
    assert np.allclose(whole, [40.0, 21.0])
print("netCDF4", netCDF4.__version__, "xarray", xr.__version__)
print("netCDF4: 400, 4000, -5000 are read as", direct)
print("xarray: 20 corrected to 40 and saved is read as", read[0])
PROGRAM
