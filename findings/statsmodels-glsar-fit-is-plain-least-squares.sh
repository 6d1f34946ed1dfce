#!/usr/bin/env bash
# Expected: `GLSAR(y, X, rho=1).fit()` fits a line with noise of the first order, as its name says.
# What happens: 1 is the number of coefficients, and `fit` leaves them 0: estimates and standard errors are those of
#   OLS, 3 times too small for noise of 0.8. `iterative_fit` finds 0.81. `rho=1.0` is a coefficient (a random walk), as
#   `rho=0.8` is.
# Package: statsmodels 0.15.0.
# Who is hurt: whoever takes the slope's error of a drift or a speed for one that allows for correlated noise.
# Instead: `iterative_fit(10)`, and look at `model.rho` (tried below).
# Source: found by trying; `iterative_fit` stands in the documentation.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 scipy==1.17.1 statsmodels==0.15.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import statsmodels
import statsmodels.api as sm

draw = np.random.default_rng(1)
noise = np.zeros(2000)
for i in range(1, noise.size):
    noise[i] = 0.8 * noise[i - 1] + draw.normal()
design = sm.add_constant(np.linspace(0.0, 1.0, noise.size))
readings = design @ [1.0, 2.0] + noise
plain = sm.OLS(readings, design).fit()
model = sm.GLSAR(readings, design, rho=1)
named = model.fit()
assert np.allclose(model.rho, 0.0)
# the first reading is left out, nothing else differs
shorter = sm.OLS(readings[1:], design[1:]).fit()
assert np.allclose(named.bse, shorter.bse) and np.allclose(named.params, shorter.params)
walk = sm.GLSAR(readings, design, rho=1.0)
assert np.allclose(walk.rho, 1.0) and walk.fit().bse[1] > 3.0 * named.bse[1]
# instead
model = sm.GLSAR(readings, design, rho=1)
fitted = model.iterative_fit(10)
assert abs(float(model.rho[0]) - 0.8) < 0.05
ratio = fitted.bse[1] / named.bse[1]
assert 2.5 < ratio < 3.6
known = sm.GLSAR(readings, design, rho=0.8).fit()
assert np.isclose(known.bse[1], fitted.bse[1], rtol=0.1)
print("statsmodels", statsmodels.__version__, "numpy", np.__version__)
print("error of the slope: OLS", plain.bse[1], "GLSAR.fit", named.bse[1], "iterative_fit", fitted.bse[1], "with rho", model.rho)
PROGRAM
