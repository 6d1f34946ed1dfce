#!/usr/bin/env bash
# Expected: `np.trapezoid` of uint8 grey values along a line is their integral, as it returns a float.
# What happens: neighbours are added in uint8 before they are halved, and wrap: 851 in place of 1875 for nine values of
#   200 to 255; of int16 readings of 30000 it is -7072 in place of 124000. scipy's `trapezoid` and
#   `cumulative_trapezoid` do the same, `simpson` and `cumulative_simpson` are right, `romb` is wrong with a warning.
#   None for the others.
# Packages: numpy 2.4.6, scipy 1.17.1. Source: found by trying.
# Who is hurt: whoever integrates camera rows, ADC counts or accelerations as they were stored. Dark frames are right.
# Instead: .astype(float) first (tried); a dx of 1.0 does not help (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import scipy
from scipy import integrate

warnings.simplefilter("error")
rows = {
    "uint8": np.array([200, 210, 220, 230, 240, 250, 255, 250, 240], np.uint8),
    "int16": np.array([30000, 31000, 32000, 31000, 30000], np.int16),
}
wraps = {
    "numpy.trapezoid": lambda y: np.trapezoid(y, dx=1.0),
    "scipy trapezoid": integrate.trapezoid,
    "scipy cumulative_trapezoid": lambda y: integrate.cumulative_trapezoid(y)[-1],
}
right = {"scipy simpson": integrate.simpson, "scipy cumulative_simpson": lambda y: integrate.cumulative_simpson(y)[-1]}
print("numpy", np.__version__, "scipy", scipy.__version__)
for kind, row in rows.items():
    for name, integral in {**wraps, **right}.items():
        seen, should = float(integral(row)), float(integral(row.astype(float)))
        print(f"{name} of {kind}: {seen:.0f}, of the same as floats {should:.0f}")
        if name in right:
            assert abs(seen - should) < 1e-6
        else:
            assert abs(seen - should) > 0.5 * should
            half = np.diff(row.astype(float)) / 2.0 + row[:-1]
            # instead
            assert abs(should - half.sum()) < 1e-9
    dark = (row // 3).astype(row.dtype)
    assert float(np.trapezoid(dark)) == float(np.trapezoid(dark.astype(float)))
PROGRAM
