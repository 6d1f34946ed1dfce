#!/usr/bin/env bash
# Expected: times appended to a Zarr store come back as written, or the append is refused.
# What happens: the first part decides the unit; later times that do not fit (2.5 s after whole seconds) are written in
#   a finer one, as a warning says, but the store goes on stating the first. 00:00:02.5 comes back as 00:41:40, and half
#   hours after whole hours as six days later.
# Packages: xarray 2026.9.0, zarr 3.1.6.
# Who is hurt: whoever writes a long run in parts: the clock is wrong from the second part on.
# Instead: `encoding={"t": {"units": "microseconds since ..."}}` in the first part, fine enough for all (tried below).
#   Source: xarray's issues 5969 (closed) and 10639 (open).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 xarray==2026.9.0 zarr==3.1.6
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import xarray as xr
import zarr


def part(*times):
    return xr.Dataset({"v": ("t", np.zeros(len(times)))}, coords={"t": np.array(times, "M8[ns]")})


def stored(name, first, then, **encoding):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        first.to_zarr(name, mode="w", consolidated=False, **encoding)
        then.to_zarr(name, append_dim="t", consolidated=False)
    return xr.open_zarr(name, consolidated=False, chunks=None).t.values, [str(w.message) for w in told]


first = part("2026-01-01T00:00:00", "2026-01-01T00:00:01")
then = part("2026-01-01T00:00:02", "2026-01-01T00:00:02.5")
found, told = stored("run.zarr", first, then)
assert (found[:2] == first.t.values).all()
assert found[2] == np.datetime64("2026-01-01T00:33:20")
assert found[3] == np.datetime64("2026-01-01T00:41:40")
assert any("faithfully" in text for text in told)
hours = part("2026-01-01T00:00", "2026-01-01T01:00")
halves = part("2026-01-01T02:30", "2026-01-01T03:30")
later, _ = stored("hours.zarr", hours, halves)
assert later[2] == np.datetime64("2026-01-07T06:00")
# instead
fine = {"encoding": {"t": {"units": "microseconds since 2026-01-01"}}}
right, _ = stored("fine.zarr", first, then, **fine)
assert (right == np.concatenate([first.t.values, then.t.values])).all()
print("xarray", xr.__version__, "zarr", zarr.__version__)
print("written 00:00:02 and 00:00:02.5, read", found[2:])
PROGRAM
