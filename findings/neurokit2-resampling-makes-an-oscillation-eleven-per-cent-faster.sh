#!/usr/bin/env bash
# Expected: `signal_resample` from 1000 to 10 Hz returns readings each 0.1 s.
# What happens: by default ("interpolation") first and last reading are kept and those between are spread evenly: 1 s at
#   1000 Hz becomes ten readings 0.111 s apart, so that a reading that equals its time is 0.555 at 0.5 s, and 1.5 Hz
#   is 1.67 Hz on the new clock. The stretch is the new length over itself less one, of 10 s 1 %. "FFT" and "poly"
#   ring at the ends of a drift, 10.8 for 9.9; "numpy" is right. The number of readings is right in all, no warning.
# Package: neurokit2 0.3.0, numpy 2.4.6, pandas 3.1.1. Source: found by trying.
# Who is hurt: whoever brings a fast sensor to a camera's rate, or cuts a record into short pieces and resamples each.
# Instead: method="numpy" (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 scikit-learn==1.9.1 matplotlib==3.11.2 neurokit2==0.3.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import neurokit2
import numpy as np

print(*(f"{name} {version(name)}" for name in ("neurokit2", "numpy", "pandas")))


def resampled(record, method=None):
    options = {} if method is None else {"method": method}
    return np.asarray(neurokit2.signal_resample(record, sampling_rate=1000, desired_sampling_rate=10, **options))


for seconds in (1, 2, 10):
    times = np.arange(1000 * seconds) / 1000
    clock = np.arange(10 * seconds) / 10
    angles = 2 * np.pi * 1.5 * times
    for method in (None, "numpy"):
        at, phase = resampled(times, method), np.interp(resampled(times, method), times, angles)
        wave = resampled(np.sin(angles), method)
        assert len(at) == len(wave) == len(clock) and np.allclose(wave, np.sin(phase), atol=0.05)
        fast = (at[-1] - at[0]) / (clock[-1] - clock[0])
        print(f"{seconds} s, {method or 'by default'}: a reading that equals its time is {at[len(at) // 2]:.3f} at "
              f"{clock[len(at) // 2]:.1f} s, 1.5 Hz is {1.5 * fast:.3f} Hz")
        right = len(clock) / (len(clock) - 1) if method is None else 1.0
        assert abs(fast - right) < 2e-3
at = {method: resampled(times, method) for method in ("FFT", "poly")}
print("a reading that equals its time at 9.9 s:", ", ".join(f"{name} {y[-1]:.2f}" for name, y in at.items()))
assert all(y[-1] > 10.5 for y in at.values())
PROGRAM
