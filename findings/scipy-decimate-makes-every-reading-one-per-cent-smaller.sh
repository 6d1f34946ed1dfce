#!/usr/bin/env bash
# Expected: reducing the rate of a constant 100 gives 100.
# What happens: `scipy.signal.decimate` gives 98.855 everywhere, for each factor: its default is a Chebyshev filter of
#   even order, which passes the constant part 0.05 dB low, and forward and backward it is applied twice. A slow wave is
#   as much too small.
# Package: scipy 1.17.1.
# Who is hurt: whoever decimates before a fit: speeds, temperatures and torques are 1.1 % low, and no residual shows it.
# Instead: an odd order (`n=7`), or `ftype="fir"`, whose ends are wrong: the first reading is 62.5 of 100 (tried below).
#   Source: SciPy's issues 9402 and 17042, open since 2018.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import scipy
from scipy import signal

level = np.full(400, 100.0)
for factor in (2, 3, 4, 5, 8, 10):
    low = signal.decimate(level, factor)
    assert np.allclose(low, 100.0 * 10 ** (-0.1 / 20), rtol=1e-6)
assert np.isclose(signal.decimate(level, 4, zero_phase=False)[-1], 100.0 * 10 ** (-0.05 / 20), rtol=1e-5)
wave = np.sin(2 * np.pi * np.arange(4000.0) / 400)
slow = signal.decimate(wave, 4)[100:-100]
assert np.isclose(slow.std() / np.sqrt(0.5), 0.98855, atol=1e-3)
# instead
assert np.allclose(signal.decimate(level, 4, n=7), 100.0)
fir = signal.decimate(level, 4, ftype="fir")
assert np.isclose(fir[50], 100.0) and fir[0] < 65.0
assert np.allclose(signal.resample_poly(level, 1, 4, padtype="line"), 100.0)
print("scipy", scipy.__version__, "numpy", np.__version__)
print("100 decimated:", low[5], "with n=7:", signal.decimate(level, 4, n=7)[50], "fir:", fir[50], "and at its start", fir[0])
PROGRAM
