#!/usr/bin/env bash
# Expected: `alpha` is the variance of the readings' errors, in the square of their unit; `normalize_y=True`, which a
#   reading of micrometres needs, rescales it along with the readings.
# What happens: the readings are divided by their standard deviation and `alpha` is not. Readings of 50 um with stated
#   errors of 2 um are met to 1e-8 of an error: the curve runs through each of them, with a band 10 000 times too narrow.
# Package: scikit-learn 1.9.1.
# Who is hurt: whoever smooths a track in metres by its stated errors, or takes a residual or slope from it.
# Instead: `alpha=sd**2 / np.var(y)` (tried below), or readings in a unit in which they are about 1. Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-learn==1.9.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import sklearn
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

warnings.simplefilter("ignore", ConvergenceWarning)
sd = 2e-6  # m
t = np.linspace(0.0, 1.0, 40)
x = 1e-4 + 5e-5 * np.sin(6.0 * t) + sd * np.random.default_rng(0).standard_normal(40)


def left_and_told(alpha):
    """What a fit leaves, and the error that it tells, in stated errors."""
    kernel = ConstantKernel(1.0, (1e-3, 1e3)) * RBF(0.2, (0.01, 10.0))
    fit = GaussianProcessRegressor(kernel, alpha=alpha, normalize_y=True).fit(t[:, None], x)
    mean, error = fit.predict(t[:, None], return_std=True)
    return float(np.std(x - mean)) / sd, float(np.median(error)) / sd


stated, scaled = left_and_told(sd**2), left_and_told(sd**2 / np.var(x))
assert stated[0] < 1e-6 and stated[1] < 1e-3, stated
# instead
assert 0.5 < scaled[0] < 1.2 and 0.1 < scaled[1] < 0.6, scaled
print("scikit-learn", sklearn.__version__)
print("left and told, in stated errors: alpha as stated {:.1e}, {:.1e}".format(*stated))
print("alpha over the variance of the readings {:.2f}, {:.2f}".format(*scaled))
PROGRAM
