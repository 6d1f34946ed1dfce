#!/usr/bin/env bash
# Expected: `Tsd.smooth(std)` of std in seconds smooths over these; a spectrum's peaks are at their frequencies.
# What happens: both count readings and take their mean rate. A sine of 0.2 Hz, read 100 and later 10 times a second,
#   keeps 0.94 of its height and then 0.003, for 0.82 both; with half of a record missing, 2 Hz stands at 1.33 Hz. No
#   warning.
# Package: pynapple 0.11.4. Source: smooth's docstring tells of the rate; found by trying.
# Who is hurt: whoever smooths a log of changing rate or with lost readings.
# Instead: interpolate to even times first (tried), and split at gaps by time_support (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 pynapple==0.11.4
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import pynapple as nap

warnings.simplefilter("error", UserWarning)
random = np.random.default_rng(0)


def height(values):
    return float(np.sqrt(2.0) * np.std(np.asarray(values)))


def sine(times, frequency):
    return np.sin(2.0 * np.pi * frequency * times)


def peak(tsd):
    power = nap.compute_power_spectral_density(tsd)
    return float(power.index[int(np.argmax(power.values[:, 0]))])


print("pynapple", nap.__version__, "numpy", np.__version__)
t = np.concatenate([np.arange(0.0, 50.0, 0.01), np.arange(50.0, 100.0, 0.1)])
seen = np.asarray(nap.Tsd(t, sine(t, 0.2)).smooth(0.5, size_factor=10))
dense, sparse = height(seen[(t > 10.0) & (t < 40.0)]), height(seen[(t > 60.0) & (t < 90.0)])
right = float(np.exp(-0.5 * (2.0 * np.pi * 0.2 * 0.5) ** 2))
print(f"a sine of 0.2 Hz smoothed by 0.5 s: {dense:.3f} where dense, {sparse:.4f} where sparse, right {right:.3f}")
assert dense > 0.92 and sparse < 0.05
t = np.concatenate([np.arange(0.0, 10.0, 0.01), np.arange(20.0, 30.0, 0.01)])
seen = peak(nap.Tsd(t, sine(t, 2.0)))
print(f"2 Hz with ten of thirty seconds missing: the peak is at {seen:.3f} Hz")
assert abs(seen - 4.0 / 3.0) < 0.05
# instead
even = np.arange(0.0, 100.0, 0.1)
smooth = np.asarray(nap.Tsd(even, sine(even, 0.2)).smooth(0.5, size_factor=10))
assert abs(height(smooth[100:400]) - right) < 0.03 and abs(height(smooth[600:900]) - right) < 0.03
runs = nap.IntervalSet([0.0, 20.0], [9.995, 29.995])
whole = nap.Tsd(t, sine(t, 2.0), time_support=runs)
assert all(abs(peak(whole.restrict(runs[k])) - 2.0) < 0.11 for k in range(2))
PROGRAM
