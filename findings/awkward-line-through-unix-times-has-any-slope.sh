#!/usr/bin/env bash
# Expected: the slope of a drift of 3 um/s does not depend on where time begins, as in numpy's polyfit; nor does its
#   error, and readings without any scatter have a slope without error.
# What happens: `linear_fit` takes differences of plain sums: over 10 s it is right to 2e-4 at a start of 1e6 s, and with
#   Unix times the slopes are inf and 0.000004 in place of 0.003, beside errors of inf and 0.001, where 0.03 is its own
#   right one; as one array it is 0.00005. No warning. `var`, `covar` and `corr` subtract the mean first and are right.
#   The errors are those of readings with a standard deviation of 1: 0.011 for an exact line as for a noisy one.
# Package: awkward 2.14.0, numpy 2.4.6. Source: found by trying; the page prints the formula, and not what it loses.
# Who is hurt: whoever fits drifts of runs of unequal length in one call, from logs with Unix times.
# Instead: subtract ak.mean(t, axis=-1, keepdims=True) first, or ak.covar / ak.var (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check numpy==2.4.6 awkward==2.14.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import awkward as ak
import numpy as np

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("awkward", "numpy")))
runs = [np.arange(0.0, 10.0, 0.01), np.arange(0.0, 5.0, 0.01)]
slope, seen = 0.003, {}
for start in (0.0, 86400.0, 1e6, 1.7e9):
    times = ak.Array([run + start for run in runs])
    readings = ak.Array([1.0 + slope * run for run in runs])
    fit = ak.linear_fit(times, readings, axis=-1)
    ratio = ak.covar(times, readings, axis=-1) / ak.var(times, axis=-1)
    centred = ak.linear_fit(times - ak.mean(times, axis=-1, keepdims=True), readings, axis=-1)
    plain = [np.polyfit(np.asarray(t), np.asarray(y), 1)[0] for t, y in zip(times, readings)]
    seen[start] = float(fit.slope[0]), float(fit.slope_error[0])
    print(f"start at {start:g} s: slopes {fit.slope.to_list()}, errors {fit.slope_error.to_list()}")
    print(f"  centred {centred.slope.to_list()}, covar / var {ratio.to_list()}, polyfit {plain}")
    for right in (ratio, centred.slope, plain):
        assert all(abs(value / slope - 1) < 1e-6 for value in right)
assert all(abs(seen[start][0] / slope - 1) < 1e-3 for start in (0.0, 86400.0, 1e6))
assert abs(seen[1e6][0] / slope - 1) > 1e-5
assert not 0.5 < seen[1.7e9][0] / slope < 2
noise = ak.Array([np.random.default_rng(0).normal(0.0, size, 1000) for size in (1e-6, 1.0, 100.0)])
errors = ak.linear_fit(ak.Array([runs[0]] * 3), noise, axis=-1).slope_error.to_list()
print("errors with a scatter of 1e-6, 1 and 100:", errors)
assert max(errors) == min(errors) and abs(seen[0.0][1] - errors[0]) < 1e-9
one = 1.7e9 + runs[0]
fit = ak.linear_fit(one, slope * (one - 1.7e9), axis=None)
print("as one array with Unix times:", fit.to_list())
assert not 0.5 < fit.slope / slope < 2
PROGRAM
