#!/usr/bin/env bash
# Expected: the filter that keeps two decimals rounds each reading to 0.01; NaN stays NaN, what does not fit is told.
# What happens: the steps of 0.01 begin at the least reading of each chunk: 2.0 beside 1.234567 is read as 2.004567,
#   other chunks of one record have other steps. NaN is read as that least reading. Integers with `scaleoffset=4` keep
#   four bits above the least one: 1000 is read as 8. Nothing is said.
# Package: h5py 3.16.0 with its HDF5.
# Who is hurt: whoever saves room with lossy storage of a track or log: lost frames come back as the smallest
#   coordinate.
# Instead: round, then compress without loss; for integers `scaleoffset=0` (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 h5py==3.16.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import h5py
import numpy as np

readings = np.array([1.234567, 2.0, np.nan, 5.0])
with h5py.File("log.h5", "w") as file:
    file.create_dataset("lossy", data=readings, scaleoffset=2)
    file.create_dataset("steady", data=readings[:2], scaleoffset=2)
    file.create_dataset("counts", data=np.array([0, 1000, 5]), scaleoffset=4)
    # instead
    file.create_dataset("rounded", data=np.round(readings, 2), compression="gzip", shuffle=True)
    file.create_dataset("fitting", data=np.array([0, 1000, 5]), scaleoffset=0)
with h5py.File("log.h5") as file:
    read = {name: file[name][:] for name in file}
assert np.isfinite(read["lossy"]).all()
assert np.isclose(read["lossy"][2], 1.234567)
assert np.allclose(read["steady"], [1.234567, 2.004567], rtol=0.0, atol=1e-9)
assert read["counts"].tolist() == [0, 1000 % 16, 5]
assert np.array_equal(read["rounded"], np.round(readings, 2), equal_nan=True)
assert read["fitting"].tolist() == [0, 1000, 5]
print("h5py", h5py.__version__, "HDF5", h5py.version.hdf5_version, "numpy", np.__version__)
print("written", readings, "read", read["lossy"], "; 0, 1000, 5 in four bits:", read["counts"])
PROGRAM
