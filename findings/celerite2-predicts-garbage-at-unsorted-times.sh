#!/usr/bin/env bash
# Expected: `gp.predict(readings, times)` is the curve at each of the times, in whatever order they are asked; `compute`
#   refuses readings whose times are not sorted.
# What happens: predict does not look. At 5, 3 and 1 s a sine read to 0.01 is -1.28, 0.18 and 1.11 (right: -0.96, 0.14,
#   0.84) with a stated error of 0.008; of 50 times in random order the median error is 0.4. No warning.
# Package: celerite2 0.3.3, numpy 2.4.6. Source: found by trying; the docstring names no order.
# Who is hurt: whoever predicts a record at the times of another log, a phase, or the rows of a shuffled table.
# Instead: sort the times, predict, and put the values back (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 celerite2==0.3.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import celerite2
import numpy as np
from celerite2 import terms

random = np.random.default_rng(0)
t = np.sort(random.uniform(0.0, 10.0, 100))
read = np.sin(t)
gp = celerite2.GaussianProcess(terms.SHOTerm(sigma=1.0, rho=6.0, Q=5.0), mean=0.0)
gp.compute(t, yerr=0.01)
ask = np.array([5.0, 3.0, 1.0])
seen, spread = gp.predict(read, ask, return_var=True)
alone = np.array([gp.predict(read, ask[[k]])[0] for k in range(ask.size)])
order = np.argsort(ask)
sorted_ = np.empty(ask.size)
sorted_[order] = gp.predict(read, ask[order])
print("celerite2", celerite2.__version__, "numpy", np.__version__)
for k, at in enumerate(ask):
    print(f"at {at}: {seen[k]:.4f} +- {np.sqrt(spread[k]):.4f} among three, {alone[k]:.4f} alone, "
          f"true {np.sin(at):.4f}")
assert np.abs(alone - np.sin(ask)).max() < 1e-3
assert np.abs(seen - np.sin(ask)).max() > 0.2 and spread.max() < 0.01**2
mixed = random.permutation(np.linspace(0.5, 9.5, 50))
off = np.abs(gp.predict(read, mixed) - np.sin(mixed))
print(f"50 times in random order: off by {off.max():.2f} at most, median {np.median(off):.2f}")
assert off.max() > 0.5 and np.median(off) > 0.1
try:
    gp.compute(t[::-1], yerr=0.01)
    raise SystemExit("compute has become silent")
except ValueError as error:
    print("compute refuses such times:", error)
# instead
assert np.abs(sorted_ - np.sin(ask)).max() < 1e-3
PROGRAM
