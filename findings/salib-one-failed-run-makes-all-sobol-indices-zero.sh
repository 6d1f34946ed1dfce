#!/usr/bin/env bash
# Expected: if one of 8192 runs of a model failed (NaN), the Sobol indices are NaN, or refused.
# What happens: all first indices are exactly 0, in place of 0.8, 0.2 and 0: no parameter matters. And a sample made
#   with calc_second_order=False (5120 runs), analysed without saying so again, is cut into the wrong blocks: 0.15,
#   -1.0, -0.04, since 5120 divides, too. No warning of either.
# Package: SALib 1.6.0, numpy 2.4.6, scipy 1.17.1. Source: found by trying.
# Who is hurt: whoever ranks the constants of a simulator some of whose runs fail.
# Instead: look for NaN first, and say calc_second_order in both calls (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 SALib==1.6.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from SALib.analyze import sobol
from SALib.sample import sobol as points

problem = {"num_vars": 3, "names": ["mass", "friction", "drag"], "bounds": [[0.0, 1.0]] * 3}


def model(x):
    return 4.0 * x[:, 0] + 2.0 * x[:, 1]  # the first has 80 % of the variance, the second 20 %


def first(values, **options):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = np.asarray(sobol.analyze(problem, values, seed=1, **options)["S1"])
    return found, [str(w.message) for w in caught]


values = model(points.sample(problem, 1024, seed=1))
failed = values.copy()
failed[5] = np.nan  # one of 8192 runs
short = model(points.sample(problem, 1024, calc_second_order=False, seed=1))
right, none, other = first(values), first(failed), first(short)
print("SALib", version("SALib"), "numpy", np.__version__, "scipy", version("scipy"))
print(f"all of {values.size} runs: {right[0].round(3).tolist()}; one of them NaN: {none[0].tolist()}; "
      f"{short.size} runs of a sample without second order: {other[0].round(3).tolist()}")
print("warnings:", right[1], none[1], other[1])
assert np.allclose(right[0], [0.8, 0.2, 0.0], atol=1e-3)
assert np.all(none[0] == 0.0)
assert not right[1] + none[1] + other[1]
assert np.abs(other[0] - right[0]).max() > 0.3 and other[0].min() < -0.1
# instead
assert not np.all(np.isfinite(failed))  # look before the call
assert np.allclose(first(short, calc_second_order=False)[0], [0.8, 0.2, 0.0], atol=1e-3)
PROGRAM
