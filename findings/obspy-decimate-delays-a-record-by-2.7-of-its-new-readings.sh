#!/usr/bin/env bash
# Expected: `decimate` keeps what happened at its time: it has no phase, or corrects the start of the trace, as `resample`
#   of the same package and scipy's `decimate` do.
# What happens: its low-pass filter runs forwards alone, and the start time stays: a slow pulse at 10.00 s comes at
#   10.28 s after a factor of 10 at 100 Hz, at 10.13 s after 5, at 10.04 s after 2: 2.2 to 2.8 of the new steps.
#   `resample` of the same trace and scipy leave it within 1e-9 s. Two channels that are brought to one rate from 100
#   and 20 Hz are 0.13 s apart. The header notes the filter, not the delay; no warning.
# Package: obspy 1.5.1, scipy 1.17.1, numpy 2.4.6. Source: found by trying; the docstring speaks of a low-pass filter.
# Who is hurt: whoever measures lags, travel times or the order of slips after decimation.
# Instead: `filter("lowpass", ..., zerophase=True)` and `decimate(..., no_filter=True)`, or `resample` (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    setuptools==65.5.0 numpy==2.4.6 scipy==1.17.1 obspy==1.5.1
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
from obspy import Trace
from scipy import signal

print(*(f"{name} {version(name)}" for name in ("obspy", "scipy", "numpy")))


def pulse(rate=100.0):
    time = np.arange(round(20 * rate)) / rate
    return Trace(np.exp(-0.5 * ((time - 10) / 0.5) ** 2), {"sampling_rate": rate})


def late(trace):
    """How much later than 10 s the middle of the pulse stands, by the trace's own times."""
    return trace.times() @ trace.data / trace.data.sum() - 10


for factor, expected in ((2, 2.21), (4, 2.65), (5, 2.70), (10, 2.78), (16, 2.79)):
    delay = late(pulse().decimate(factor))
    other = signal.decimate(pulse().data, factor)
    steps = np.arange(len(other)) * factor / 100
    print(f"by {factor}: {delay:.3f} s late, {delay * 100 / factor:.2f} new steps; resample {late(pulse().resample(100 / factor)):.1g} s; scipy {steps @ other / other.sum() - 10:.1g} s")
    assert abs(delay * 100 / factor - expected) < 0.02
    assert abs(late(pulse().resample(100 / factor))) < 1e-9 and abs(steps @ other / other.sum() - 10) < 1e-9
    smooth = pulse().filter("lowpass", freq=40 / factor, corners=8, zerophase=True).decimate(factor, no_filter=True)
    assert abs(late(smooth)) < 1e-9
fast, slow = pulse(100.0).decimate(5), pulse(20.0)
assert fast.stats.sampling_rate == slow.stats.sampling_rate and fast.stats.starttime == slow.stats.starttime
lags = signal.correlation_lags(len(fast), len(slow))
lag = lags[np.argmax(signal.correlate(fast.data, slow.data))] / 20
print(f"one pulse in two channels, 20 Hz both: lag {lag} s, noted: {fast.stats.processing[0][:60]}")
assert lag in (0.1, 0.15)
PROGRAM
