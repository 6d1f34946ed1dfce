#!/usr/bin/env bash
# Expected: a masked reading (numpy.ma, what netCDF4 and others return) is stored as NaN or as the fill value, or
#   refused, as np.save does.
# What happens: h5py, np.savez, np.savetxt and tifffile store the reading under the mask: a saturated 99 is a reading
#   again, and the mean of 3 is 22.2. scipy's savemat stores 1e20. numpy.interp, savgol_filter and scipy's splines
#   calculate with it. No warning from any of them.
# Packages: numpy 2.4.6, scipy 1.17.1, h5py 3.16.0, tifffile 2026.3.3. Source: found by trying.
# Who is hurt: whoever masks bad readings and hands the array on. Instead: readings.filled(np.nan) first (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 h5py==3.16.0 tifffile==2026.3.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import h5py
import numpy as np
import scipy
import tifffile
from scipy.interpolate import make_interp_spline
from scipy.signal import savgol_filter

warnings.simplefilter("error")
BAD = 99.0
readings = np.ma.masked_greater(np.array([1.0, 2.0, BAD, 4.0, 5.0]), 90.0)  # the third is saturated
assert readings.mean() == 3.0


def to_h5py():
    with h5py.File("log.h5", "w") as file:
        file["x"] = readings
        return file["x"][:]


def to_matlab():
    scipy.io.savemat("log.mat", {"x": readings})
    return scipy.io.loadmat("log.mat")["x"].ravel()


def to_npz():
    np.savez("log.npz", x=readings)
    with np.load("log.npz") as file:
        return file["x"]


def to_text():
    np.savetxt("log.txt", readings)
    return np.loadtxt("log.txt")


def to_tiff():
    tifffile.imwrite("log.tif", readings[None])
    return np.ravel(tifffile.imread("log.tif"))


print("numpy", np.__version__, "scipy", scipy.__version__, "h5py", h5py.__version__, "tifffile", tifffile.__version__)
for write in (to_h5py, to_matlab, to_npz, to_text, to_tiff):
    seen = np.asarray(write())
    gap = 1e20 if write is to_matlab else BAD
    print(f"{write.__name__}: the gap is {seen[2]:.4g}, the mean {seen.mean():.4g}")
    assert seen[2] == gap and not np.ma.isMaskedArray(write())
try:
    np.save("log.npy", readings)
    raise SystemExit("np.save has become silent")
except NotImplementedError as error:
    print("np.save refuses:", error)
times = np.arange(5.0)
used = {
    "numpy.interp": np.interp(2.5, times, readings),
    "scipy spline": float(make_interp_spline(times, readings, 1)(2.5)),
    "savgol_filter": float(savgol_filter(readings, 3, 1)[1]),
}
print("between and around the gap:", {k: f"{v:.1f}" for k, v in used.items()})
assert all(v > 25.0 for v in used.values())
# instead
assert np.isnan(readings.filled(np.nan)[2])
PROGRAM
