#!/usr/bin/env bash
# Expected: an array written by zarr reads the same in xarray, whichever of its two formats it has.
# What happens: zarr gives floats the fill value 0.0 by default. In format 2 xarray takes that for the mark of a gap:
#   each reading of exactly 0 becomes NaN, and the mean of 0, 1, 2, 3 is 2. In format 3 zeros stay. No argument named
#   for masks was set, and `use_zarr_fill_value_as_mask=False` does not help in format 2.
# Packages: zarr 3.1.6, xarray 2026.9.0.
# Who is hurt: velocities at rest, offsets and clipped readings of old stores vanish, the means are too large.
# Instead: `fill_value=None` or NaN when writing, `mask_and_scale=False` when reading (tried below). Source: xarray's
#   issues 5475 and 10269.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 xarray==2026.9.0 zarr==3.1.6
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import xarray as xr
import zarr

readings = [0.0, 1.0, 2.0, 3.0]


def written(edition, **fill):
    names = {"dimension_names": ["t"]} if edition == 3 else {"attributes": {"_ARRAY_DIMENSIONS": ["t"]}}
    group = zarr.open_group(f"log{edition}.zarr", mode="w", zarr_format=edition)
    array = group.create_array("v", shape=(4,), dtype="f8", **names, **fill)
    array[:] = readings
    assert array[:].tolist() == readings
    return f"log{edition}.zarr"


def opened(path, **options):
    return xr.open_dataset(path, engine="zarr", consolidated=False, **options)["v"]


old, new = opened(written(2)), opened(written(3))
assert np.isnan(old.values[0]) and float(old.mean()) == 2.0
assert new.values.tolist() == readings and float(new.mean()) == 1.5
assert np.isnan(opened("log2.zarr", use_zarr_fill_value_as_mask=False).values[0])
# instead
assert opened("log2.zarr", mask_and_scale=False).values.tolist() == readings
assert opened(written(2, fill_value=None)).values.tolist() == readings
print("zarr", zarr.__version__, "xarray", xr.__version__)
print("format 2:", old.values, "format 3:", new.values)
PROGRAM
