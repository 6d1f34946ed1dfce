#!/usr/bin/env bash
# Expected: all converters of `resample` keep a pulse at its time, as the first output is the first input.
# What happens: "linear" and "zero_order_hold" are one reading of the input late: a pulse at 1 s, read each ms, stands at
#   1.0010 s at half, twice and ten times the rate (hold at ten times 1.0015 s), a constant slope is lower by one reading;
#   of a camera's 25 Hz that is 40 ms. "sinc_best" and soxr are right to a microsecond, but begin a record of 100 at
#   74, since all before it is zero. Lengths are as asked, no warning.
# Package: samplerate 0.2.4 (libsamplerate), soxr 1.1.0, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever brings two sensors of different rates to one clock and reads a lag.
# Instead: numpy.interp onto the new times (tried), or take one reading of the input off the new times (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check --only-binary :all: \
    numpy==2.4.6 samplerate==0.2.4 soxr==1.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import samplerate
import soxr

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("samplerate", "soxr", "numpy")))
step = 0.001
times = np.arange(2000) * step
pulse = np.exp(-(((times - 1.0) / 0.02) ** 2)).astype(np.float32)


def late(found, ratio):
    """How many readings of the input the middle of the pulse is late."""
    assert abs(len(found) - len(pulse) * ratio) <= 1
    at = np.arange(len(found)) * step / ratio
    return float(((found * at).sum() / found.sum() - 1.0) / step)


for ratio in (0.1, 0.5, 2.0, 10.0):
    lags = {name: late(samplerate.resample(pulse, ratio, name), ratio)
            for name in ("sinc_best", "linear", "zero_order_hold")}
    lags["soxr"] = late(soxr.resample(pulse, 1 / step, ratio / step), ratio)
    new = np.arange(int(len(pulse) * ratio)) * step / ratio
    lags["numpy.interp"] = late(np.interp(new, times, pulse), ratio)
    print(f"ratio {ratio:g}: late by", ", ".join(f"{name} {lag:.2f}" for name, lag in lags.items()), "readings")
    assert all(abs(lags[name]) < 0.01 for name in ("sinc_best", "soxr", "numpy.interp"))
    assert abs(lags["linear"] - 1.0) < 0.01
    assert 0.99 < lags["zero_order_hold"] < 1.6
slope = samplerate.resample(times.astype(np.float32), 2.0, "linear")
mended = np.arange(len(slope)) * step / 2 - step
print(f"a reading that equals its time, at {slope[2000]:.4f}: at {2000 * step / 2:.4f} s; mended {mended[2000]:.4f} s")
assert abs(slope[2000] - 0.999) < 1e-5 and np.allclose(slope[10:], mended[10:], atol=1e-5)
constant = np.full(1000, 100.0, np.float32)
starts = {"sinc_best": samplerate.resample(constant, 0.5, "sinc_best")[0], "soxr": soxr.resample(constant, 1000, 500)[0]}
print("a record of 100 begins at", ", ".join(f"{name} {start:.1f}" for name, start in starts.items()))
assert all(70.0 < start < 80.0 for start in starts.values())
PROGRAM
