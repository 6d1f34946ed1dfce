#!/usr/bin/env bash
# Expected: a right-hand side compiled by numba that divides by zero ends the integration with an error, as the same
#   Python function does; or it gives nan or inf, as C would.
# What happens: the error is printed as "ignored", and the callback returns what it has written: a scalar is 0, an array
#   keeps what it held. A block with the dry friction v / |v|, pushed by twice its friction, stays where it is for good,
#   and LSODA reports success. A root of a negative number is no error but nan: which fault is seen is the operator's.
# Packages: numba 0.68.1, numbalsoda 0.3.4, numpy 2.4.6. Source: numba's page on cfunc says that errors are printed and
#   ignored; found by trying.
# Who is hurt: whoever hands a compiled force to a solver and does not read its stderr: "it sticks" is plausible.
# Instead: @cfunc(..., error_model="numpy") divides as C does: the states are nan then, though LSODA still reports success
#   (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 numba==0.68.1 numbalsoda==0.3.4
"$folder/venv/bin/python" - <<'PROGRAM' 2> "$folder/stderr"
import math

import numba
import numpy as np
from numba import cfunc
from numbalsoda import lsoda, lsoda_sig


@cfunc(lsoda_sig)
def block(t, state, rate, parameters):
    rate[0] = state[1]
    rate[1] = 2.0 - state[1] / abs(state[1])


@cfunc(lsoda_sig, error_model="numpy")
def as_in_c(t, state, rate, parameters):
    rate[0] = state[1]
    rate[1] = 2.0 - state[1] / abs(state[1])


@cfunc("float64(float64)")
def inverse(x):
    return 1.0 / x


@cfunc("float64(float64)")
def root(x):
    return math.sqrt(x)


assert inverse.ctypes(0.0) == 0.0 and math.isnan(root.ctypes(-1.0))
times = np.linspace(0.0, 2.0, 5)
moving, well = lsoda(block.address, np.array([0.0, 1e-9]), times)
assert well and abs(moving[-1, 0] - 2.0) < 1e-6  # half of the net push of 1, times t^2
resting, well = lsoda(block.address, np.zeros(2), times)
assert well and np.all(resting == 0.0)
bad, well = lsoda(as_in_c.address, np.zeros(2), times)
assert well and np.all(np.isnan(bad[1:]))
print("numba", numba.__version__, "numpy", np.__version__)
print(f"after 2 s: {moving[-1, 0]:.3f} m from 1 nm/s, {resting[-1, 0]:.3f} m from rest, "
      "both a success")
PROGRAM
grep -c "Exception ignored" "$folder/stderr" | sed 's/^/errors printed and ignored: /'
