#!/usr/bin/env bash
# Expected: the third array of `oadev` and its kin, the error of the deviation, is its scatter from record to record.
# What happens: it is the deviation over the root of the number of overlapping pairs, which share most of their
#   readings. Over 100 steps of 2000 readings of white noise the scatter is 14 %, the stated error 2 %: one record in
#   six lies within one error of the mean, where two in three should. `adev` is right.
# Package: allantools 2024.6. Source: documented as a simple error beside `confidence_interval`; the size was tried.
# Who is hurt: whoever compares two sensors, or weighs a fit of noise terms to an Allan curve.
# Instead: edf_greenhall with confidence_interval (tried), or adev's own error (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 allantools==2024.6
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import allantools
import numpy as np
from importlib.metadata import version

warnings.simplefilter("error")
print("allantools", version("allantools"), "numpy", np.__version__)
random = np.random.default_rng(0)
records, length, lag = 100, 2000, 100
phases = np.cumsum(random.normal(size=(records, length)), axis=1)
true = lag**-0.5
ratios = {}
for name in ("adev", "oadev", "ohdev", "totdev", "mdev"):
    seen = [getattr(allantools, name)(phase, rate=1.0, taus=[lag]) for phase in phases]
    values, stated = np.array([s[1][0] for s in seen]), np.array([s[2][0] for s in seen])
    ratios[name] = values.std() / stated.mean()
    inside = np.mean(np.abs(values - values.mean()) < stated)
    print(f"{name}: {values.mean():.4f}, scatter {values.std():.4f}, stated error {stated.mean():.4f}, ratio "
          f"{ratios[name]:.1f}, {inside:.0%} within one error of the mean")
    if name != "adev":
        assert ratios[name] > 4.0 and inside < 0.35
assert 0.7 < ratios["adev"] < 1.3
# instead
freedom = allantools.edf_greenhall(alpha=0, d=2, m=lag, N=length, overlapping=True, modified=False)
within = []
for phase in phases:
    value = allantools.oadev(phase, rate=1.0, taus=[lag])[1][0]
    low, high = allantools.confidence_interval(value, edf=freedom, ci=0.683)
    within.append(low < true < high)
print(f"confidence_interval with {freedom:.0f} degrees of freedom holds the true value {np.mean(within):.0%} of times")
assert 0.5 < np.mean(within) < 0.85
PROGRAM
