#!/usr/bin/env bash
# Expected: weights that are all equal change nothing, as they change no line; with 1/sigma as weights, as the docstring
#   asks, error bars are those of a weighted fit, and R squared stays near 1 for a good one.
# What happens: the bars are the scatter of bare residuals over a weighted matrix: equal weights of 20 (1/0.05) divide
#   them by 20, of 0.01 multiply them by 100, and p of an intercept that is 0 goes from 0.88 to 1e-127 at 400. R squared
#   sets weighted residuals beside bare ones: 0.999, then 0.59, and -162. `prediction_variance` leaves weights out. With a
#   sigma of 0.02 and 0.2 for two halves the bars are 6 times too small, those of the curve 8 times too large where the
#   readings are good. The fit itself is right. No warning.
# Package: pwlf 2.7.0, numpy 2.4.6, scipy 1.17.1. Source: found by trying, against 400 made records.
# Who is hurt: whoever states errors of readings and asks whether a kink, or a term, is real.
# Instead: the standard errors times the root of the ratio of mean squares of weighted and of bare residuals (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pwlf==2.7.0
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
import pwlf

print(*(f"{name} {version(name)}" for name in ("pwlf", "numpy", "scipy")))
PLACES = np.linspace(0, 10, 200)
TRUE = np.where(PLACES < 4, PLACES, 4 + 0.2 * (PLACES - 4))
noise = np.random.default_rng(0)


def fitted(readings, weights=None):
    """Two lines that meet at 4, their error bars, and that of the curve at 2."""
    fit = pwlf.PiecewiseLinFit(PLACES, readings, weights=weights)
    fit.fit_with_breaks([0.0, 4.0, 10.0])
    return fit, np.asarray(fit.standard_errors()), float(np.sqrt(fit.prediction_variance(np.array([2.0]))[0]))


readings = TRUE + noise.normal(0, 0.05, 200)
plain, bars, curve = fitted(readings)
squares = {}
for weight in (1.0, 20.0, 0.01, 400.0):
    fit, wrong, other = fitted(readings, np.full(200, weight))
    squares[weight] = fit.r_squared()
    print(f"equal weights of {weight:g}: bars {wrong}, p of the intercept {fit.p_values()[0]:.2g}, R squared {squares[weight]:.4f}")
    assert np.allclose(fit.beta, plain.beta, atol=1e-9) and np.allclose(wrong * weight, bars) and np.isclose(other, curve)
assert plain.p_values()[0] > 0.8 and fit.p_values()[0] < 1e-50
assert squares[1.0] > 0.998 and 0.5 < squares[20.0] < 0.7 and squares[400.0] < -100
sigma = np.where(PLACES < 5, 0.02, 0.2)
found = []
for _ in range(400):
    fit, *_ = fitted(TRUE + noise.normal(size=200) * sigma, 1 / sigma)
    found.append([*fit.beta, fit.predict(np.array([2.0]))[0]])
scatter = np.std(found, axis=0)
fit, wrong, other = fitted(TRUE + noise.normal(size=200) * sigma, 1 / sigma)
print(f"two sigmas: bars {wrong} and {other:.4f} at 2, scatter of 400 fits {scatter[:3]} and {scatter[3]:.4f}")
assert np.all(scatter[:3] / wrong > 5) and np.all(scatter[:3] / wrong < 8) and 5 < other / scatter[3] < 9
residuals = fit.predict(PLACES) - fit.y_data
mended = wrong * np.sqrt((residuals**2 / sigma**2).mean() / (residuals**2).mean())
print("mended:", mended)
assert np.allclose(mended, scatter[:3], rtol=0.25)  # one record scatters by a tenth
PROGRAM
