#!/usr/bin/env bash
# Expected: the filter Delta of a Zarr store gives back the readings that went in; a NaN among them is one NaN.
# What happens: differences are stored and added up on reading. One NaN makes each later reading of its chunk NaN; one
#   fill value of 1e20 makes later readings of 20.00 read as 0.00. Integers that do not fit `astype` wrap. No warning.
# Packages: numcodecs 0.16.6, zarr 3.1.6. Source: its docstring warns of small integers alone; found by trying.
# Who is hurt: whoever adds Delta to compress a log with gaps: what is written is lost, the store looks healthy.
# Instead: no Delta for floats; shuffle with a compressor (Blosc, tried) keeps all bits.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 numcodecs==0.16.6 zarr==3.1.6
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numcodecs
import numpy as np
import zarr
from numcodecs import Blosc, Delta

warnings.simplefilter("error", RuntimeWarning)
warnings.simplefilter("ignore", UserWarning)


def back(codec, readings):
    return np.frombuffer(np.ascontiguousarray(codec.decode(codec.encode(readings))), readings.dtype)


random = np.random.default_rng(0)
readings = (20.0 + 0.01 * random.normal(size=1000)).astype(np.float32)
print("numcodecs", numcodecs.__version__, "zarr", zarr.__version__, "numpy", np.__version__)
assert np.array_equal(back(Delta("f4"), readings), readings)
gap = readings.copy()
gap[100] = np.nan
seen = back(Delta("f4"), gap)
print("one NaN at 100 of 1000:", int(np.isnan(seen).sum()), "NaN are read")
assert np.isnan(seen[100:]).all() and not np.isnan(seen[:100]).any()
store = zarr.create_array("log.zarr", shape=(1000,), chunks=(500,), dtype="f4", filters=[
    zarr.codecs.numcodecs.Delta(dtype="f4")])
store[:] = gap
print("the same in a Zarr store with chunks of 500:", int(np.isnan(store[:]).sum()))
assert np.isnan(store[:]).sum() == 400
gap[100] = 1e20
seen = back(Delta("f4"), gap)
print("one 1e20 at 100: the next readings are", seen[101:104].tolist(), "for", gap[101:104].tolist())
assert np.abs(seen[101:]).max() < 0.2
counts = np.array([10, 500, 3], np.int16)
seen = back(Delta("i2", astype="i1"), counts)
print("10, 500, 3 with differences in 8 bits are read as", seen.tolist())
assert seen.tolist() != counts.tolist()
# instead
gap[100] = np.nan
assert np.array_equal(back(Blosc(shuffle=Blosc.SHUFFLE), gap), gap, equal_nan=True)
PROGRAM
