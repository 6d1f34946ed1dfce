#!/usr/bin/env bash
# Expected: a fit, root or minimum of readings in metres (1e-6) is found as in micrometres, or its failure is told.
# What happens: the tolerances are absolute: `least_squares` of a way of 5 um stops at its start with success, and so do
#   BFGS, L-BFGS-B, SLSQP, CG and trust-constr; `brentq` on (-1e-12, 1e-12) gives the end 1e-12 for the root 3e-13,
#   `minimize_scalar` on (0, 1e-8) its first try. A float32 objective stops BFGS at its start too, whatever the scale.
# Package: scipy 1.17.1.
# Who is hurt: whoever fits small robots in SI: the guess comes back as the result, `success` is True.
# Instead: divide residuals by their sd and unknowns by their size, in float64 (tried below). Source: SciPy's
#   documentation has the defaults; found by trying.
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
from scipy import optimize

t = np.linspace(0.0, 10.0, 100)
sd = 5e-8
way = 5e-6 * (1.0 - np.exp(-t / 2.0)) + np.random.default_rng(0).normal(0.0, sd, t.size)


def residuals(p):
    return p[0] * 1e-6 * (1.0 - np.exp(-t / p[1])) - way


def total(p):
    return float(np.sum(residuals(p) ** 2))


start = [1.0, 1.0]
fit = optimize.least_squares(residuals, start)
assert fit.success and fit.x.tolist() == start
for method in ("BFGS", "L-BFGS-B", "SLSQP", "CG", "trust-constr"):
    found = optimize.minimize(total, start, method=method)
    assert found.success and found.x.tolist() == start, method
end = optimize.brentq(lambda x: x - 3e-13, -1e-12, 1e-12)
assert end == 1e-12
place = optimize.minimize_scalar(lambda x: ((x - 3e-9) * 1e9) ** 2, bounds=(0.0, 1e-8), method="bounded")
assert place.success and abs(place.x - 3.8197e-9) < 1e-12
single = optimize.minimize(lambda p: np.float32(total(p) / sd**2), start, method="BFGS")
assert single.success and single.x.tolist() == start
# instead
scaled = optimize.least_squares(lambda p: residuals(p) / sd, start)
assert np.allclose(scaled.x, [5.0, 2.0], rtol=0.02)
assert np.allclose(optimize.minimize(lambda p: total(p) / sd**2, start, method="L-BFGS-B").x, scaled.x, rtol=1e-3)
root = 1e-12 * optimize.brentq(lambda x: x * 1e-12 - 3e-13, -1.0, 1.0)
assert abs(root - 3e-13) < 1e-20
print("scipy", scipy.__version__, "numpy", np.__version__)
print("least_squares:", fit.x, fit.message, "; divided by the sd:", scaled.x)
print("brentq:", end, "for 3e-13; minimize_scalar:", place.x, "for 3e-9")
PROGRAM
