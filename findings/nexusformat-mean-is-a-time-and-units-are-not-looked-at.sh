#!/usr/bin/env bash
# Expected: `NXdata.mean()` is the mean of the readings, `sum()` has an error where the readings have, and 1 m + 1 mm is
#   1.001 m or refused, as fields carry units.
# What happens: mean, std and var are moments of the axis weighted by the readings: of 1 to 100 mm over 0 to 9.9 s the
#   mean is 6.6, seconds. sum gives a bare number without error. 1 m + 1 mm is 2 m, 1 mm + 1 m is 2 mm. A slice by 2:5
#   is by numbers, by 2.0:5.0 by seconds. No warning.
# Package: nexusformat 2.1.0. Source: docstrings tell of moments and slices; units: found by trying.
# Who is hurt: whoever uses it as an array with units. Instead: average() is the mean (tried); convert units before.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 h5py==3.16.0 nexusformat==2.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from nexusformat.nexus import NXdata, NXfield

warnings.simplefilter("error")
time = NXfield(np.arange(100) * 0.1, name="t", units="s")
readings = NXfield(np.arange(1.0, 101.0), name="y", units="mm")
log = NXdata(readings, time, errors=NXfield(np.full(100, 2.0), name="errors"))
print("nexusformat", version("nexusformat"), "numpy", np.__version__)
mean, spread = float(log.mean()), float(log.std())
print(f"readings 1 to 100 mm: mean {mean:.2f}, std {spread:.2f}, average {float(log.average()):.2f}, sum {log.sum()}")
values, seconds = np.arange(1.0, 101.0), np.arange(100) * 0.1
first = float((values * seconds).sum() / values.sum())
assert abs(mean - first) < 1e-9 and abs(mean - 6.6) < 1e-9
assert abs(spread - float(np.sqrt((values * (seconds - first) ** 2).sum() / values.sum()))) < 0.1 < 20.0
assert not isinstance(log.sum(), NXdata) and float(log.sum()) == 5050.0
assert float(log.average()) == 50.5
metre, millimetre = NXfield(np.array([1.0]), units="m"), NXfield(np.array([1.0]), units="mm")
for a, b in ((metre, millimetre), (millimetre, metre)):
    seen = a + b
    print(f"1 {a.units} + 1 {b.units} = {float(seen.nxdata[0])} {seen.units}")
    assert float(seen.nxdata[0]) == 2.0 and seen.units == a.units
by_number, by_seconds = log[2:5].t.nxdata, log[2.0:5.0].t.nxdata
print(f"2:5 is {by_number[0]:.1f} to {by_number[-1]:.1f} s, 2.0:5.0 is {by_seconds[0]:.1f} to {by_seconds[-1]:.1f} s")
assert np.allclose(by_number, [0.2, 0.3, 0.4]) and by_seconds.size == 31
PROGRAM
