#!/usr/bin/env bash
# Expected: `BayesianRidge`, `ARDRegression` and `HuberRegressor` of a clear line have its slope in any unit; the priors
#   of the first two are called non-informative.
# What happens: times of 0 to 1 us in seconds have the slope 0 in all three, of 0 to 1 ms in Huber 0.14 of the right
#   one. With readings in micrometres in metres ARD has 0, and the stated error of a prediction by BayesianRidge is 143
#   times the scale of the readings (right: 0.05); with readings around 1e6 the slope is 0. The priors, 1e-6, and
#   Huber's epsilon and tolerance are in the data's own units. No warning; LassoCV is right in all of them.
# Package: scikit-learn 1.9.1, numpy 2.4.6, scipy 1.17.1. Source: found by trying.
# Who is hurt: whoever wants error bars, sparse terms or a line without outliers of small robots in SI units.
# Instead: times and readings over their standard deviation, and the slope turned back (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-learn==1.9.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import sklearn
from sklearn.linear_model import ARDRegression, BayesianRidge, HuberRegressor, LassoCV

warnings.simplefilter("error")
print("scikit-learn", sklearn.__version__, "numpy", np.__version__)
rng = np.random.default_rng(0)
t = np.linspace(0.0, 1.0, 100)[:, None]
readings = 2.0 * t[:, 0] + rng.normal(0.0, 0.05, 100)
MODELS = BayesianRidge, ARDRegression, HuberRegressor, LassoCV


def fits(time, size):
    """The slopes, and the error of a prediction by BayesianRidge, in units of 1 s and 1 reading."""
    slopes = [float(Model().fit(time * t, size * readings).coef_[0]) * time / size for Model in MODELS]
    model = BayesianRidge().fit(time * t, size * readings)
    return slopes, float(model.predict(time * t, return_std=True)[1].mean()) / size


seen = {}
for time, size in ((1.0, 1.0), (1e-3, 1.0), (1e-6, 1.0), (1.0, 1e6), (1.0, 1e-3), (1.0, 1e-6)):
    slopes, error = seen[time, size] = fits(time, size)
    print(f"times of {time:g}, readings of {size:g}: slopes", ", ".join(
        f"{Model.__name__} {slope:.3f}" for Model, slope in zip(MODELS, slopes)), f"; error {error:.3g}")
    assert abs(slopes[3] - 2.0) < 0.02
scaled = fits(1.0 / t.std(), 1.0 / readings.std())
print("over their standard deviations:", [round(slope, 3) for slope in scaled[0]], f"error {scaled[1]:.3g}")
assert all(abs(slope - 2.0) < 0.02 for slope in seen[1.0, 1.0][0] + scaled[0])
assert all(abs(slope) < 1e-3 for slope in seen[1e-6, 1.0][0][:3])
assert 0.1 < seen[1e-3, 1.0][0][2] < 0.5
assert abs(seen[1.0, 1e6][0][0]) < 1e-3 and abs(seen[1.0, 1e-6][0][1]) < 1e-3
assert seen[1.0, 1e-6][1] > 100.0 and 0.04 < seen[1.0, 1.0][1] < 0.06
PROGRAM
