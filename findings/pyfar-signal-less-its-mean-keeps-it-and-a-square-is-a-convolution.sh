#!/usr/bin/env bash
# Expected: `s - 1.5` takes 1.5 off each reading, `s * s` squares them, and `resample` keeps their size.
# What happens: operators of a `Signal` act on its spectrum, and numbers are added to each of its lines: of 2000 readings
#   with the mean 1.5, s - s.time.mean() still has the mean 1.499; the first reading alone is 1.5 lower. `s * s` is the
#   circular convolution, up to 1000 for a sine of 1. `TimeData` of the same readings takes all as expected.
#   `resample` to half the rate doubles each reading, unless the signal was made with fft_norm="rms". No warning.
# Package: pyfar 0.8.1, numpy 2.4.6, scipy 1.17.1. Source: both are documented, the operators on the page of arithmetic,
#   the factor at `match_amplitude`; what a number does to a record was found by trying.
# Who is hurt: whoever takes an offset off a recording, or puts a measured force and motion into one product.
# Instead: the functions with domain="time", and match_amplitude="time" (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pyfar==0.8.1
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
import pyfar

print(*(f"{name} {version(name)}" for name in ("pyfar", "numpy", "scipy")))
time = np.arange(2000) / 1000
swing = np.sin(2 * np.pi * 5 * time + 0.3)
record = pyfar.Signal(swing + 1.5, 1000)
less = (record - record.time.mean()).time[0]
change = less - record.time[0]
print(f"mean 1.5 taken off: mean {less.mean():.4f}, first reading changed by {change[0]:.3f}, others by {abs(change[1:]).max():.1g}")
assert abs(less.mean() - 1.5) < 0.001 and abs(change[0] + 1.5) < 1e-9 and abs(change[1:]).max() < 1e-9
square = pyfar.Signal(swing, 1000) * pyfar.Signal(swing, 1000)
turned = np.fft.irfft(np.fft.rfft(swing) ** 2, 2000)
print(f"square of a sine: up to {abs(square.time).max():.1f}, as its circular convolution")
assert abs(abs(square.time).max() - 1000) < 1 and np.allclose(square.time[0], turned, atol=1e-6)
data = pyfar.TimeData(swing + 1.5, time)
assert np.allclose((data - 1.5).time, swing) and np.allclose((data * data).time, (swing + 1.5) ** 2)
print("TimeData: as expected")
for norm, factor in (("none", 2.0), ("rms", 1.0)):
    half = pyfar.dsp.resample(pyfar.Signal(swing + 1.5, 1000, fft_norm=norm), 500).time[0, 100:900]
    size = half.mean() / 1.5
    print(f"resampled to half the rate, fft_norm {norm}: mean {half.mean():.3f}, {size:.3f} of the right one")
    assert abs(size - factor) < 0.01
right = pyfar.subtract((record, 1.5), domain="time").time[0]
product = pyfar.multiply((pyfar.Signal(swing, 1000), pyfar.Signal(swing, 1000)), domain="time").time[0]
kept = pyfar.dsp.resample(record, 500, match_amplitude="time").time[0, 100:900]
assert np.allclose(right, swing) and np.allclose(product, swing**2) and abs(kept.mean() - 1.5) < 0.01
print("in the domain of time: as expected")
PROGRAM
