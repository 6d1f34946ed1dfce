#!/usr/bin/env bash
# Expected: the mean of 30 million float32 readings of 1.1 is 1.1 to seven digits, as numpy has it, which sums in parts.
# What happens: numba's np.mean and bottleneck's nanmean add one reading after the other in 32 bits. The sum stops at
#   33554432 = 2^25, where 1.1 is less than half its last digit: the mean is 1.118, the standard deviation of a constant
#   0.017 to 0.018. numba's sum, bottleneck's nansum and numexpr's sum stop there, too. Nothing is said; numbers of 1e4
#   do not help: what counts is how many readings there are. At 3 million the mean is 1.0735.
# Packages: numba 0.68.1, bottleneck 1.6.0, numexpr 2.14.2, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever speeds up statistics of films or of fast logs, which are float32 more often than not.
# Instead: astype(np.float64) first, a block at a time if memory is short (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 llvmlite==0.50.0 numba==0.68.1 bottleneck==1.6.0 numexpr==2.14.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import bottleneck as bn
import numba
import numexpr
import numpy as np

READING = 1.1


@numba.njit
def by_numba(x):
    return np.mean(x), np.std(x), np.sum(x)


print("numba", numba.__version__, "bottleneck", bn.__version__, "numexpr", numexpr.__version__, "numpy", np.__version__)
few = np.full(3_000_000, READING, np.float32)
print(f"3 million: numba {by_numba(few)[0]:.5f}, bottleneck {bn.nanmean(few):.5f}, numpy {few.mean():.5f}")
x = np.full(30_000_000, READING, np.float32)
mean, deviation, total = by_numba(x)
seen = {"numba": mean, "bottleneck": bn.nanmean(x), "numpy": float(x.mean())}
totals = {"numba": total, "bottleneck": float(bn.nansum(x)), "numexpr": float(numexpr.evaluate("sum(x)"))}
spread = {"numba": deviation, "bottleneck": float(bn.nanstd(x)), "numpy": float(x.std())}
print("30 million, mean:", {k: round(v, 5) for k, v in seen.items()})
print("sum:", totals, "standard deviation:", {k: round(v, 6) for k, v in spread.items()})
assert abs(seen["numpy"] - READING) < 1e-6 and spread["numpy"] < 1e-6
assert all(1.118 < seen[k] < 1.119 for k in ("numba", "bottleneck"))
assert all(v == 2.0**25 for v in totals.values())
assert all(0.015 < spread[k] < 0.02 for k in ("numba", "bottleneck"))
assert all(1e-3 < abs(v / READING - 1.0) < 5e-2 for v in (by_numba(few)[0], bn.nanmean(few)))
# instead
assert abs(by_numba(x.astype(np.float64))[0] - READING) < 1e-6
PROGRAM
