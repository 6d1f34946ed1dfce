#!/usr/bin/env bash
# Expected: the sample entropy of a record changes little with one more reading; one lost reading (NaN) gives nan.
# What happens: up to 4999 readings templates count that differ by less than the tolerance, from 5000 on also those that
#   differ by as much. Of whole numbers with a tolerance of 1 count the entropy is 1.99 with 4999 readings and 0.95 with
#   5000; of readings of 0.1 that a converter rounded the same. Of one NaN among 4999 readings of noise the entropy is
#   -0.0, that of a perfectly regular record; from 5000 on there is an error.
# Package: antropy 0.2.3, numpy 2.4.6. Source: found by trying; the page says that both ways should be equivalent.
# Who is hurt: whoever compares the regularity of motions in pixels or counts over records of unequal length.
# Instead: a tolerance between two steps, 1.5 counts (tried); fill or cut gaps before.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-learn==1.9.1 antropy==0.2.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import antropy
import numpy as np

print(*(f"{name} {version(name)}" for name in ("antropy", "numpy")))
rng = np.random.default_rng(0)
counts = np.round(np.cumsum(rng.normal(size=5200)) * 2)
seen = {}
for number in (4800, 4999, 5000, 5200):
    at, between = (antropy.sample_entropy(counts[:number], tolerance=limit) for limit in (1.0, 1.5))
    seen[number] = float(at)
    print(f"{number} readings: entropy {at:.3f} with a tolerance of 1.0, {between:.3f} with 1.5")
    assert abs(between - 0.95) < 0.02
assert abs(seen[4800] - seen[4999]) < 0.05 and abs(seen[5000] - seen[5200]) < 0.05
assert seen[4999] > 1.9 and seen[5000] < 1.0
volts = np.round(counts * 0.25, 2)
short, long = (antropy.sample_entropy(volts[:number], tolerance=0.25) for number in (4999, 5000))
print(f"in steps of 0.25 with a tolerance of 0.25: {short:.3f} and {long:.3f}")
assert short > 1.9 and long < 1.0

noise = rng.normal(size=4999)
gap = noise.copy()
gap[2500] = np.nan
whole, lost = antropy.sample_entropy(noise), antropy.sample_entropy(gap)
lost_given = antropy.sample_entropy(gap, tolerance=0.2)
print(f"noise: entropy {whole:.3f}, with one NaN {lost}, with a tolerance given {lost_given:.3f}")
assert whole > 2.0 and lost == 0.0
PROGRAM
