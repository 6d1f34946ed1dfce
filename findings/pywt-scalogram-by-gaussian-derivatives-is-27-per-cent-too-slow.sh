#!/usr/bin/env bash
# Expected: the top of a scalogram of a sine of 1 Hz stands at 1 Hz of the frequencies that `cwt` returns, within the
#   spacing of the scales, whatever the wavelet.
# What happens: the centre frequency of a wavelet is the largest line of a short spectrum, on a grid of 0.06 to 0.1, and
#   `cwt` weighs by the root of the scale: with gaus1 the top stands at 0.73 Hz, gaus2 0.84, gaus4 1.04, gaus8 0.92,
#   cgau1 0.83, cmor1.0-0.5 0.89; with morl, mexh and cmor1.5-1.0 it is right to 2 %. Finer tables (`precision`) change
#   nothing. No warning.
# Package: pywavelets 1.9.0, numpy 2.4.6. Source: found by trying; the page calls the frequency a central one.
# Who is hurt: whoever reads the frequency of chatter or of stick and slip off a scalogram, or compares two wavelets.
# Instead: for gausN the scale s in readings belongs to sqrt(2 N + 1) / (2 pi s) per reading (tried), or morl.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check numpy==2.4.6 pywavelets==1.9.0
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
import pywt

print(*(f"{name} {version(name)}" for name in ("pywavelets", "numpy")))
rate = 200
time = np.arange(0, 40, 1 / rate)
record = np.sin(2 * np.pi * time)


def top(wavelet, precision):
    """Frequency and scale at the top of the scalogram, between the lines by a parabola."""
    scales = np.geomspace(rate / 12, rate * 3, 100)
    found, frequencies = pywt.cwt(record, scales, wavelet, 1 / rate, precision=precision)
    power = (abs(found[:, 2000:-2000]) ** 2).mean(axis=1)
    best = int(np.argmax(power))
    assert 0 < best < len(scales) - 1
    below, here, above = np.log(power[best - 1 : best + 2])
    shift = 0.5 * (below - above) / (below - 2 * here + above)
    scale = scales[best] * (scales[1] / scales[0]) ** shift
    return frequencies[best] * scales[best] / scale, scale


seen = {}
expected = {"gaus1": 0.727, "gaus2": 0.84, "gaus4": 1.045, "gaus8": 0.915, "cgau1": 0.826, "cmor1.0-0.5": 0.89, "morl": 1.0, "mexh": 1.0, "cmor1.5-1.0": 0.985}
for wavelet, right in expected.items():
    seen[wavelet] = [top(wavelet, precision) for precision in (12, 15)]
    (first, _), (second, _) = seen[wavelet]
    print(f"{wavelet}: centre {pywt.central_frequency(wavelet):.4f}, top at {first:.3f} and {second:.3f} Hz")
    assert abs(second - right) < 0.012 and abs(first - second) < 0.012
for name in ("gaus1", "gaus2", "gaus4", "gaus8"):
    frequency = np.sqrt(2 * int(name[-1]) + 1) / (2 * np.pi * seen[name][1][1]) * rate
    print(f"{name} by its own formula: {frequency:.3f} Hz")
    assert abs(frequency - 1) < 0.006
PROGRAM
