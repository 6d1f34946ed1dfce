#!/usr/bin/env bash
# Expected: a lossy filter with an absolute tolerance keeps NaN, as it keeps inf, or refuses it.
# What happens: SZ3 reads NaN back as a number of up to -2**31 times the tolerance: with 1e-3 one NaN among 10 000
#   readings of 15 to 25 is -1e6 and makes their mean -86, with 1e-6 it is -1059 and the mean 20.8 for 20.9, with 1e-8
#   4.47, a plausible one. Inf, -inf and 1e20 come back as they are, all other readings within the tolerance, and
#   isnan finds nothing more. No warning. SZ, its elder in the same package, keeps NaN; so does Blosc2.
# Package: hdf5plugin 7.1.0, h5py 3.16.0, numpy 2.4.6 (x86-64). Source: found by trying; the page promises the tolerance.
# Who is hurt: whoever stores tracks with lost frames, or maps with gaps, in compressed HDF5.
# Instead: a fill value of 1e20, which is kept, or a dataset of the mask beside it (the first tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 h5py==3.16.0 hdf5plugin==7.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import h5py
import hdf5plugin
import numpy as np

print(*(f"{name} {version(name)}" for name in ("hdf5plugin", "h5py", "numpy")))
time = np.linspace(0.0, 10.0, 10_000)
readings = 20.0 + 5.0 * np.sin(time) + np.random.default_rng(0).normal(0.0, 0.01, time.size)


def stored(value, compression, places=(5000,)):
    record = readings.copy()
    record[list(places)] = value
    with h5py.File("record.h5", "w") as file:
        file.create_dataset("x", data=record, chunks=record.shape, compression=compression)
    with h5py.File("record.h5") as file:
        read = file["x"][:]
    others = np.ones(len(read), bool)
    others[list(places)] = False
    return read[list(places)], abs(read - record)[others].max(), np.nanmean(read)


right = np.delete(readings, 5000).mean()
for tolerance in (1e-3, 1e-6, 1e-8):
    lost, off, mean = stored(np.nan, hdf5plugin.SZ3(absolute=tolerance))
    assert tolerance > 1e-8 or 0 < lost[0] < 20
    print(f"tolerance {tolerance:g}: NaN is {lost[0]:.6g}, the mean {mean:.4f} for {right:.4f}, others off by {off:.2g}")
    assert np.isfinite(lost).all() and -(2.0**31) * tolerance <= lost[0] < -(2.0**29) * tolerance + 30
    assert off < 1.01 * tolerance and abs(mean - right) > 1e-4
    gap, _, _ = stored(np.nan, hdf5plugin.SZ3(absolute=tolerance), range(3000, 3100))
    assert np.isfinite(gap).all()
    for value in (np.inf, -np.inf, 1e20):
        with np.errstate(invalid="ignore"):
            assert stored(value, hdf5plugin.SZ3(absolute=tolerance))[0][0] == value
lost, off, mean = stored(np.nan, hdf5plugin.SZ(absolute=1e-3))
print(f"SZ: NaN is {lost[0]}, the mean {mean:.4f}")
assert np.isnan(lost[0]) and off < 1.01e-3 and abs(mean - right) < 1e-3
assert np.isnan(stored(np.nan, hdf5plugin.Blosc2())[0][0])
PROGRAM
