#!/usr/bin/env bash
# Expected: a copy of values with uncertainties keeps what they have in common: copy - original is 0 +- 0.
# What happens: `DataArray.copy()` (deep by default), `Dataset.copy(deep=True)`, `sortby` and `copy.deepcopy` make each
#   value a new source: two readings with one offset of 0.1 differ by 1.00 +- 0.14 instead of 1 +- 0, and copy -
#   original is 0 +- 0.14. `isel`, `where`, pandas' copy and pickle keep it.
# Packages: uncertainties 3.2.3, xarray 2026.9.0.
# Who is hurt: whoever keeps readings with a shared calibration error in a data set: it averages away after a sort.
# Instead: `copy(deep=False)`, or sort by `isel` with `argsort` (tried below).
# Source: that copies are new sources stands in uncertainties' documentation; where xarray copies was found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 xarray==2026.9.0 uncertainties==3.2.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import copy
import importlib.metadata
import pickle

import numpy as np
import pandas as pd
import xarray as xr
from uncertainties import ufloat

offset = ufloat(0.0, 0.1)
readings = np.array([offset + 2.0, offset + 1.0], dtype=object)
array = xr.DataArray(readings, dims="n", coords={"n": [1, 0]})


def step(values):
    """The sd of the difference of the two readings: their offset is one and the same."""
    return (values[0] - values[1]).std_dev


assert step(array.values) == 0.0
lost = {
    "copy()": array.copy().values,
    "Dataset.copy": xr.Dataset({"v": array}).copy(deep=True)["v"].values,
    "sortby": array.sortby("n").values,
    "deepcopy": copy.deepcopy(readings),
}
for name, values in lost.items():
    assert np.isclose(step(values), 0.1 * np.sqrt(2.0)), name
kept = {
    "isel": array.isel(n=[1, 0]).values,
    "pandas": pd.Series(readings).copy(deep=True).to_numpy(),
    "pickle": pickle.loads(pickle.dumps(readings)),
    # instead
    "copy(deep=False)": array.copy(deep=False).values,
    "isel by argsort": array.isel(n=np.argsort(array["n"].values)).values,
}
for name, values in kept.items():
    assert step(values) == 0.0, name
print("xarray", xr.__version__, "uncertainties", importlib.metadata.version("uncertainties"))
print("difference of two readings with one offset:", readings[0] - readings[1], "after sortby:", lost["sortby"][1] - lost["sortby"][0])
print("lost by", ", ".join(lost), "; kept by", ", ".join(kept))
PROGRAM
