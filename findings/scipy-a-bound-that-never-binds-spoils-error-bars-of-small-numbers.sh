#!/usr/bin/env bash
# Expected: curve_fit with bounds (0, inf) that the answer stays far away from gives the answer and the error bars of
#   curve_fit without bounds.
# What happens: the bound changes the method, and with it the step of the Jacobian, which is then 1.5e-8 * max(1, |p|):
#   for a mass of 2e-9 kg seven times the mass. Its error bar comes out 6 times too wide, and success is reported.
# Packages: scipy 1.17.1, numpy 2.3.5. Source: found by trying; the page of least_squares says that the step is the
#   parameter times a factor.
# Who is hurt: whoever fits masses, moments or drags of small things in SI, also by least_squares.
# Instead: give diff_step (then it is relative to the parameter), or fit in units near one (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import scipy
from scipy.optimize import curve_fit

warnings.simplefilter("error")
force, mass, drag = 2e-8, 2e-9, 1.5e-7
t = np.linspace(0.0, 0.1, 50)


def speed(t, m, c):
    return force / c * -np.expm1(-c * t / m)


seen = speed(t, mass, drag)
seen = seen + np.random.default_rng(1).normal(0.0, 0.01 * seen.max(), t.size)


def fit(law, start, **options):
    values, covariance = curve_fit(law, t, seen, p0=start, **options)
    return values[0], np.sqrt(covariance[0, 0])


start = (4e-9, 5e-7)
free = fit(speed, start)
bound = fit(speed, start, bounds=(0.0, np.inf))
relative = fit(speed, start, bounds=(0.0, np.inf), diff_step=1.5e-8)
micro = fit(lambda t, m, c: speed(t, m * 1e-9, c * 1e-9), (4.0, 500.0), bounds=(0.0, np.inf))

# The truth without any solver: derivatives by small relative steps at the fitted values.
columns = []
best, _ = curve_fit(speed, t, seen, p0=start)
for i in range(2):
    step = np.zeros(2)
    step[i] = 1e-5 * best[i]
    columns.append((speed(t, *(best + step)) - speed(t, *(best - step))) / (2 * step[i]))
slope = np.array(columns).T * best
variance = np.sum((seen - speed(t, *best)) ** 2) / (t.size - 2)
true_bar = best[0] * np.sqrt(np.linalg.inv(slope.T @ slope)[0, 0] * variance)

assert abs(free[1] / true_bar - 1) < 0.01
assert abs(relative[1] / true_bar - 1) < 0.01
assert abs(micro[1] / (true_bar * 1e9) - 1) < 0.01
assert 5 < bound[1] / true_bar < 8
assert abs(bound[0] - free[0]) > 0.1 * true_bar
print("scipy", scipy.__version__, "numpy", np.__version__)
print(f"no bound           m = {free[0]:.4e} +- {free[1]:.2e} kg")
print(f"bounds (0, inf)    m = {bound[0]:.4e} +- {bound[1]:.2e} kg")
print(f"and diff_step      m = {relative[0]:.4e} +- {relative[1]:.2e} kg")
print(f"in micrograms      m = {micro[0]:.4f} +- {micro[1]:.4f}")
PROGRAM
