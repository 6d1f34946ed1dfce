#!/usr/bin/env bash
# Expected: a virtual dataset over one file per run raises an error when one of these files is missing, as an external
#   link does.
# What happens: its readings are 0, by default; no error, no warning. The same where the file is there and its dataset
#   has another name.
# Package: h5py 3.16.0 (HDF5 in its wheel). Source: HDF5 documents the fill value; found by trying.
# Who is hurt: whoever copies logs that a recorder splits into files.
# Instead: fillvalue=np.nan when the whole is made, or look for the files of `virtual_sources()` (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 h5py==3.16.0 packaging==26.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import os
import warnings

import h5py
import numpy as np

warnings.simplefilter("error")
RUNS = 3
for run in range(RUNS):
    with h5py.File(f"run{run}.h5", "w") as file:
        file["temperature"] = 20.0 + 0.01 * np.arange(5) + run


def whole(name, **options):
    layout = h5py.VirtualLayout(shape=(5 * RUNS,), dtype="f8")
    for run in range(RUNS):
        layout[5 * run : 5 * run + 5] = h5py.VirtualSource(f"run{run}.h5", "temperature", shape=(5,))
    with h5py.File(name, "w") as file:
        file.create_virtual_dataset("temperature", layout, **options)
        file["link"] = h5py.ExternalLink("run1.h5", "temperature")


def read(name):
    with h5py.File(name) as file:
        return file["temperature"][:]


def missing(name):
    with h5py.File(name) as file:
        return [s.file_name for s in file["temperature"].virtual_sources() if not os.path.exists(s.file_name)]


print("h5py", h5py.__version__, "HDF5", h5py.version.hdf5_version, "numpy", np.__version__)
whole("all.h5")
assert read("all.h5").min() >= 20.0 and missing("all.h5") == []
os.rename("run1.h5", "moved.h5")
seen = read("all.h5")
print("one file of three is missing:", seen.tolist())
assert np.array_equal(seen[5:10], np.zeros(5)) and seen[:5].min() >= 20.0 and seen[10:].min() >= 20.0
try:
    h5py.File("all.h5")["link"]
    raise SystemExit("the external link has become silent")
except KeyError as error:
    print("the external link to it:", str(error)[:80])
with h5py.File("run1.h5", "w") as file:
    file["Temperature"] = 20.0 + 0.01 * np.arange(5)
print("its dataset has another name:", read("all.h5")[5:10].tolist())
assert np.array_equal(read("all.h5")[5:10], np.zeros(5))
# instead
os.remove("run1.h5")
whole("safe.h5", fillvalue=np.nan)
assert np.isnan(read("safe.h5")[5:10]).all()
assert missing("safe.h5") == ["run1.h5"]
PROGRAM
