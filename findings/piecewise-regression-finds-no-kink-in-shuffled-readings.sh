#!/usr/bin/env bash
# Expected: the order of readings means nothing to a test for a kink of y(x), and its p-value is a probability.
# What happens: `davies_test` looks for the kink between the third and the last but two reading of the list, wherever
#   they stand: of a clear kink (p of 3e-23 in order) 200 shuffles have p from 2e-26 to 1.3, one in eleven above 0.05,
#   or nan. `Fit` finds the kink in either order and prints this p beside it. Of straight lines one p in three is above
#   1, up to 2.5. Of neither there is a warning of its own.
# Package: piecewise-regression 1.5.0, statsmodels 0.15.0, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever asks for an onset of slip in readings that are not sorted by force, or combines p-values.
# Instead: sort by x, and take p above 1 as 1 (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 statsmodels==0.15.0 matplotlib==3.11.2 piecewise-regression==1.5.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from piecewise_regression import Fit
from piecewise_regression.davies import davies_test

print(*(f"{name} {version(name)}" for name in ("piecewise-regression", "statsmodels", "numpy")))
x = np.linspace(0.0, 10.0, 200)
chance = np.random.default_rng(0)
y = np.where(x > 3.0, 0.3 * (x - 3.0), 0.0) + chance.normal(0.0, 0.2, len(x))
right = davies_test(x, y)
orders = [chance.permutation(len(x)) for _ in range(200)]
warnings.simplefilter("ignore")  # statsmodels names a singular matrix where the range is short
found = np.array([davies_test(x[order], y[order]) for order in orders])
lost = orders[int(np.nanargmax(found))]
sorts = np.argsort(x[lost])
mended = davies_test(x[lost][sorts], y[lost][sorts])
kinks = []
for order in (np.arange(len(x)), lost):
    fit = Fit(list(x[order]), list(y[order]), n_breakpoints=1, start_values=[5.0])
    result = fit.get_results()
    kinks.append((result["estimates"]["breakpoint1"]["estimate"], fit.davies))
print(f"kink at 3: p {right:.2g} in order, {mended:.2g} sorted again")
print(f"shuffled 200 times: {np.nanmin(found):.2g} to {np.nanmax(found):.2g}, {np.mean(found > 0.05):.3f} above 0.05, "
      f"{np.mean(found > 1):.3f} above 1, {np.mean(np.isnan(found)):.3f} nan")
print("fits, kink and p in order and shuffled:", *(f"{place:.2f} {chance:.2g}," for place, chance in kinks))
lines = (2.0 * x + np.random.default_rng(seed).normal(0.0, 0.5, len(x)) for seed in range(200))
line = np.array([davies_test(x, readings) for readings in lines])
print(f"straight lines: p up to {line.max():.2f}, {np.mean(line > 1):.2f} above 1")
assert right < 1e-6 and mended == right and np.mean(found > 0.05) > 0.08
assert np.nanmax(found) > 1.0 and np.nanmin(found) < 1e-6
assert all(abs(place - 3.0) < 0.5 for place, _ in kinks) and kinks[1][1] > 1.0 and kinks[0][1] < 1e-6
assert line.max() > 2.0 and np.mean(line > 1) > 0.2
PROGRAM
