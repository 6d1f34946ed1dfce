#!/usr/bin/env bash
# Expected: `scipy.differentiate.derivative`, which returns an error and a `success`, finds a smooth function's slope.
# What happens: its first step is 0.5 whatever x is. For a field that falls off over 1 mm, at x = 0.5 mm in metres, the
#   slope of a bell is 0 with success True and error 0, of a dipole 3e-6 of the right one. numdifftools is as wrong;
#   jacobi, whose step follows x, is right.
# Packages: scipy 1.17.1, numdifftools 0.11.2, jacobi 0.9.2. Source: scipy documents its `initial_step` of 0.5; found by
#   trying.
# Who is hurt: whoever takes a field's gradient, a stiffness or a sensitivity in SI units.
# Instead: initial_step of a tenth of the length over which the function changes (tried), or x in that length.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 numdifftools==0.11.2 jacobi==0.9.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import jacobi
import numdifftools
import numpy as np
import scipy
from scipy.differentiate import derivative

warnings.simplefilter("error")


def bell(x, length):
    return np.exp(-((x / length) ** 2))


def dipole(x, length):
    return (length**2 / (x**2 + length**2)) ** 1.5


def slope_of(field, length):
    x = 0.5 * length
    if field is bell:
        return -2.0 * x / length**2 * bell(x, length)
    return -3.0 * x * length**3 / (x**2 + length**2) ** 2.5


print("scipy", scipy.__version__, "numdifftools", numdifftools.__version__, "jacobi", jacobi.__version__)
print("numpy", np.__version__)
for field in (bell, dipole):
    for length in (1.0, 1e-3, 1e-6):
        right = slope_of(field, length)
        found = derivative(field, 0.5 * length, args=(length,))
        other = float(numdifftools.Derivative(lambda x: field(x, length))(0.5 * length))
        third = float(jacobi.jacobi(lambda x: field(x, length), 0.5 * length)[0])
        print(f"{field.__name__} of {length:g} m: share of the right slope {found.df / right:.2g} (success "
              f"{bool(found.success)}, error {abs(found.error / right):.1g}), numdifftools {other / right:.2g}, "
              f"jacobi {third / right:.6f}")
        assert abs(third / right - 1.0) < 1e-4 and (found.success or field is dipole)
        if length == 1.0:
            assert abs(found.df / right - 1.0) < 1e-6 and abs(other / right - 1.0) < 1e-6
        else:
            assert abs(found.df / right) < 1e-5 and abs(other / right) < 1e-5
            assert abs(found.error / right) < 1e-5
        # instead
        near = derivative(field, 0.5 * length, args=(length,), initial_step=0.1 * length)
        assert near.success and abs(near.df / right - 1.0) < 1e-6
PROGRAM
