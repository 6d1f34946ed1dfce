#!/usr/bin/env bash
# Expected: a `TimeSeries` knows its times; the difference of two that begin at different times, or have different rates,
#   is taken where both have readings, or refused, as `append` and `inject` refuse what does not fit.
# What happens: readings are paired by their place in the array, and the result has the times of the first. Of one motion
#   that two loggers began 3 s apart the difference, 0 at all common instants, is up to 2.2 for a swing of 1.2; of one at
#   100 and one at 50 readings a second it is up to 2.1. Comparisons and `csd` leave the starts out, too: the phase of
#   one motion against itself is 135 degrees. Units are converted: mm less um is right. No warning.
# Package: gwpy 4.1.0, numpy 2.4.6, astropy 8.0.2. Source: found by trying; the page of a Series says that each sample
#   has its position upon the axis.
# Who is hurt: whoever subtracts a reference or a second sensor from another machine's log.
# Instead: `crop` both to the common span first, or `inject` with the sign turned (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 astropy==8.0.2 gwpy==4.1.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
from gwpy.timeseries import TimeSeries

print(*(f"{name} {version(name)}" for name in ("gwpy", "numpy", "astropy")))


def logged(start, rate, number, unit="mm"):
    """The one motion of a body, at 0.125 and 0.5 Hz, as a logger sees it."""
    time = start + np.arange(number) / rate
    motion = np.sin(2 * np.pi * 0.125 * time + 0.3) + 0.2 * np.sin(2 * np.pi * 0.5 * time)
    return TimeSeries(motion * {"mm": 1.0, "um": 1000.0}[unit], t0=start, sample_rate=rate, unit=unit)


first, later, slower = logged(0.0, 100, 2000), logged(3.0, 100, 2000), logged(0.0, 50, 2000)
difference = first - later
print(f"begun 3 s apart: difference up to {abs(difference.value).max():.2f} {difference.unit}, from {difference.t0} on")
assert abs(difference.value).max() > 1.3 and difference.t0.value == 0.0 and len(difference) == 2000
assert np.array_equal(difference.value, first.value - later.value)
other = first - slower
print(f"at 100 and 50 Hz: difference up to {abs(other.value).max():.2f}, at {other.sample_rate}")
assert abs(other.value).max() > 1.3 and other.sample_rate.value == 100
units = first - logged(0.0, 100, 2000, "um")
print(f"in mm and um, from one start: difference up to {abs(units.value).max():.1g}")
assert abs(units.value).max() < 1e-12
assert (first == later).t0.value == 0.0
spectrum = first.csd(later, fftlength=8)
phase = np.degrees(np.angle(spectrum.value[np.argmin(abs(spectrum.frequencies.value - 0.125))]))
print(f"phase of the cross spectrum at 0.125 Hz: {phase:.0f} degrees, right 0")
assert abs(abs(phase) - 0.125 * 3 * 360) < 10
try:
    first.append(later, inplace=False)
    raise AssertionError("append took what overlaps")
except ValueError as refusal:
    print("append:", str(refusal).splitlines()[0])
common = first.crop(3.0, 20.0) - later.crop(3.0, 20.0)
injected = first.inject(-later).value[300:]
print(f"cropped first: {abs(common.value).max():.1g}, injected: {abs(injected).max():.1g}")
assert abs(common.value).max() < 1e-12 and abs(injected).max() < 1e-12 and common.t0.value == 3.0
PROGRAM
