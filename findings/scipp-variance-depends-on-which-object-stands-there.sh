#!/usr/bin/env bash
# Expected: variances are carried without correlations: `v - v` has twice the variance of `v`, as with a copy of it.
# What happens: scipp asks whether both operands are the same memory: `v - v` has variance 0, `v * v` 4 v^2 s^2; with an
#   equal copy 2 s^2 and 2 v^2 s^2. One step more and it forgets: `2 v - v` has 5 s^2 (1 is right), `v * v * v` 5 v^4
#   s^2 (`v**3` has 9).
# Package: scipp 26.8.0.
# Who is hurt: whoever subtracts a drift made of the same readings: sd 2.2 times too large, or 0.
# Instead: write each variable once, or use uncertainties, which follows each source (tried below).
# Source: found by trying; scipp documents that it follows no correlations.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipp==26.8.0 uncertainties==3.2.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import importlib.metadata

import numpy as np
import scipp as sc
from uncertainties import ufloat

v = sc.array(dims=["n"], values=[1.0, 2.0, 3.0], variances=[1.0, 1.0, 1.0], unit="mm")
w = v.copy()
square = np.array([1.0, 4.0, 9.0])
found = {
    "v - v": ((v - v).variances, 0.0),
    "v - w": ((v - w).variances, 2.0),
    "v * v": ((v * v).variances, 4.0 * square),
    "v * w": ((v * w).variances, 2.0 * square),
    "v / v": ((v / v).variances, 0.0),
    "2 v - v": ((2.0 * v - v).variances, 5.0),
    "v + v - v": ((v + v - v).variances, 5.0),
    "v * v * v": ((v * v * v).variances, 5.0 * square**2),
    "v**3": ((v**3).variances, 9.0 * square**2),
}
for name, (seen, expected) in found.items():
    assert np.allclose(seen, expected), name
assert np.allclose((v["n", 0:3] - v["n", 0:3]).variances, 0.0)
# instead
one = ufloat(2.0, 1.0)
assert (2 * one - one).std_dev == 1.0
assert np.isclose((one * one * one).std_dev ** 2, 9.0 * 16.0)
print("scipp", sc.__version__, "uncertainties", importlib.metadata.version("uncertainties"))
for name, (seen, _) in found.items():
    print(f"variance of {name}:", seen)
PROGRAM
