#!/usr/bin/env bash
# Expected: `trace.resample(rate)` keeps a sine that lies below half of both rates.
# What happens: its spectrum is multiplied by a Hann window by default. At 100 readings a second a sine of 5 Hz comes
#   back with 0.98 of its height, one of 20 Hz with 0.65, one of 40 Hz with 0.10, even where the new rate is higher or
#   the same. No warning; `scipy.signal.resample`, of the same name and way, has no window by default.
# Package: obspy 1.5.1. Source: the parameter `window` and its default are documented, what it costs was found by
#   trying.
# Who is hurt: whoever brings two recorders of vibration to one rate: velocities, powers and dampings come out small.
# Instead: window=None, after a filter of your own where the new rate is lower (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    setuptools==65.5.0 numpy==2.4.6 scipy==1.17.1 obspy==1.5.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import obspy
import scipy
from obspy import Trace
from scipy.signal import resample

OLD = 100.0
t = np.arange(2000) / OLD


def height(readings):
    """Amplitude of a sine, by its middle half."""
    n = readings.size // 4
    return float(np.sqrt(2.0) * np.std(readings[n : 3 * n]))


def kept(frequency, rate, **options):
    trace = Trace(np.sin(2.0 * np.pi * frequency * t), {"sampling_rate": OLD})
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        trace.resample(rate, **options)
    assert trace.stats.sampling_rate == rate
    return height(trace.data)


print("obspy", obspy.__version__, "scipy", scipy.__version__, "numpy", np.__version__)
for frequency, share in {5.0: 0.976, 20.0: 0.655, 40.0: 0.095}.items():
    by_default = [kept(frequency, rate) for rate in (200.0, 100.0, 90.0)]
    whole = [kept(frequency, rate, window=None) for rate in (200.0, 100.0, 90.0)]
    other = height(resample(np.sin(2.0 * np.pi * frequency * t), 4000))
    print(f"sine of {frequency} Hz at 200, 100, 90 readings a second: "
          + ", ".join(f"{v:.3f}" for v in by_default) + f"; window=None {whole[0]:.3f}; scipy {other:.3f}")
    assert np.allclose(by_default, share, atol=0.01), by_default
    assert np.allclose([*whole, other], 1.0, atol=0.01), (whole, other)
PROGRAM
