#!/usr/bin/env bash
# Expected: more readings make a fit better: a force with a part in x**4, over 1 mm in metres, is found from 1000
#   readings.
# What happens: singular values below eps times the number of readings are cut, and the columns 1 and x**4 differ by
#   1e-12: with 100 readings the term is right, from 1000 on it is 0 and a quadratic one stands in its place. The
#   returned rank is 4 in place of 5; no warning. scipy's lstsq (cut at eps), pinv and polyfit are right.
# Package: numpy 2.4.6, scipy 1.17.1. Source: the cut is documented at `rcond`; what it does was found by trying.
# Who is hurt: whoever fits force laws, field maps or calibrations in SI units with columns of his own.
# Instead: divide each column by its norm, `scipy.linalg.lstsq`, or `numpy.polyfit`, which scales (all tried).
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
import scipy.linalg

warnings.simplefilter("error")
print("numpy", np.__version__, "scipy", scipy.__version__)
random = np.random.default_rng(0)
true = np.array([1.0, 0.0, 0.0, 0.0, 1e12])  # N, N/m, ... N/m^4
for count in (100, 1000, 10000):
    x = np.linspace(-1e-3, 1e-3, count)
    columns = np.vander(x, 5, increasing=True)
    force = columns @ true + 0.01 * random.normal(size=count)
    found, _, rank, _ = np.linalg.lstsq(columns, force)
    others = [scipy.linalg.lstsq(columns, force)[0], np.linalg.pinv(columns) @ force, np.polyfit(x, force, 4)[::-1]]
    print(f"{count} readings: x^0 {found[0]:.3f}, x^2 {found[2]:.3g}, x^4 {found[4]:.3g}, rank {rank}; largest misfit "
          f"{np.abs(columns @ (found - true)).max():.3f}; others' x^4: {[f'{each[4]:.3g}' for each in others]}")
    assert all(abs(each[4] / 1e12 - 1.0) < 0.05 for each in others)
    if count == 100:
        assert rank == 5 and abs(found[4] / 1e12 - 1.0) < 0.05
    else:
        assert rank == 4 and abs(found[4]) < 10.0 and abs(found[2] - 8.57e5) < 1e4
    # instead
    norms = np.linalg.norm(columns, axis=0)
    scaled = np.linalg.lstsq(columns / norms, force)[0] / norms
    assert abs(scaled[4] / 1e12 - 1.0) < 0.05 and np.abs(columns @ (scaled - true)).max() < 0.01
PROGRAM
