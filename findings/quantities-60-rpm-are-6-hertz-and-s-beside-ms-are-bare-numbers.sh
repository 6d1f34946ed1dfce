#!/usr/bin/env bash
# Expected: 60 rpm are 1 Hz; 20 degC as kelvin are 293.15 K or an error; seconds joined to milliseconds are converted, or
#   refused, as a sum of both is; 1 s holds 300 ms three whole times; the range of times is a time.
# What happens: 60 rpm are 6.28 Hz, since a turn is 2 pi and a radian, a cycle and nothing are one; 20 degC are 20 K;
#   concatenate, stack and append give 1, 2, 1000, 2000 without a unit, interp takes 1500 ms for 1500 s; 1 s // 300 ms
#   is 0; numpy's ptp of seconds has no unit, where the largest less the smallest has.
# Packages: quantities 0.16.4, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever analyses recordings with it, as neo does: rates are 2 pi too large, joined clocks are off by 1000.
# Instead: divide rpm by 60 yourself, rescale each part before it is joined, and add 273.15 (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.4.6 quantities==0.16.4
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import quantities as pq

rate = (60 * pq.rpm).rescale(pq.Hz)
assert abs(float(rate) - 2 * np.pi) < 1e-12
warm = (20 * pq.degC).rescale(pq.K)
assert float(warm) == 20.0
seconds, millis = np.array([1.0, 2.0]) * pq.s, np.array([1000.0, 2000.0]) * pq.ms
assert np.all((seconds + millis).magnitude == [2.0, 4.0])
for joined in (np.concatenate([seconds, millis]), np.append(seconds, millis)):
    assert np.all(joined.magnitude == [1.0, 2.0, 1000.0, 2000.0])
    assert joined.dimensionality == pq.dimensionless.dimensionality
assert float(np.interp(1500 * pq.ms, seconds, [0.0, 1.0])) == 1.0  # half-way is right
whole = (1 * pq.s) // (300 * pq.ms)
assert float(whole.magnitude) == 0.0
spread = np.ptp(seconds)
assert spread.dimensionality == pq.dimensionless.dimensionality
assert (seconds.max() - seconds.min()).dimensionality == pq.s.dimensionality
safe = np.concatenate([seconds.magnitude, millis.rescale(pq.s).magnitude])
assert np.all(safe == [1.0, 2.0, 1.0, 2.0])
print("quantities", pq.__version__, "numpy", np.__version__)
print("60 rpm:", rate, " 20 degC:", warm, " joined:", joined, " 1 s // 300 ms:", whole)
PROGRAM
