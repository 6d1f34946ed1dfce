#!/usr/bin/env bash
# Expected: the integers of a file are scaled to the readings in it, in any unit; 3333 readings at 33.3333 Hz last 100 s.
# What happens: the scale is a power of ten and at least 1: with units="A" readings of 1e-6 are all read as 0, of 1e-4
#   have five steps; a reading of 1.01 in the record makes the steps ten times as coarse. All are cut towards zero. The
#   rate is stored as it is and read as a whole number: 33.3333 Hz is 33 Hz, so that 100 s are 101 s, 29.97 Hz is 29 Hz
#   and 3.3 % too long, and a sine of 5 Hz has 4.84.
# Package: pyabf 2.3.8, numpy 2.4.6. Source: found by trying; the page of `writeABF1` names none of it.
# Who is hurt: whoever keeps currents of coils in amperes, or brings frames of a camera into a file of sweeps.
# Instead: readings in a unit in which they are below 1.0 and above 0.1; times from one's own rate (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check numpy==2.4.6 pyabf==2.3.8
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
import pyabf
from pyabf.abfWriter import writeABF1

print(*(f"{name} {version(name)}" for name in ("pyabf", "numpy")))


def stored(readings, rate=1000.0):
    writeABF1(np.atleast_2d(readings), "record.abf", rate, units="A")
    record = pyabf.ABF("record.abf")
    record.setSweep(0)
    assert record.sweepUnitsY == "A" and len(record.sweepY) == np.size(readings)
    return record


sine = 0.9 * np.sin(np.arange(5000) / 30)
for height in (1.0, 1e-2, 1e-4, 1e-6):
    read = stored(height * sine).sweepY.astype(float)
    print(f"readings of {height:g} A: {len(np.unique(read))} values, off by {abs(read - height * sine).max() / height:.2g}")
    if height == 1.0:
        assert abs(read - sine).max() < 3.2e-5
    elif height == 1e-4:
        assert len(np.unique(read)) == 5
    elif height == 1e-6:
        assert not read.any()
fine, coarse = (len(np.unique(stored(top * sine).sweepY)) for top in (1.1, 1.12))
print(f"values with a largest reading of 0.99: {fine}, of 1.008: {coarse}")
assert fine > 1.4 * coarse
assert (np.abs(stored(sine).sweepY) <= np.abs(sine) + 1e-7).all()

for rate, whole in ((1000.0 / 30, 33), (29.97, 29), (300.0, 300)):
    time = np.arange(int(100 * rate)) / rate
    record = stored(0.9 * np.sin(2 * np.pi * 5.0 * time), rate)
    spectrum = np.abs(np.fft.rfft(record.sweepY * np.hanning(len(time))))
    peak = np.fft.rfftfreq(len(time), record.sweepX[1])[spectrum.argmax()]
    print(f"{rate:.4f} Hz: read {record.dataRate}, {time[-1]:.2f} s are {record.sweepX[-1]:.2f} s, 5 Hz are {peak:.3f} Hz")
    assert record.dataRate == whole and abs(record.sweepX[-1] / time[-1] - rate / whole) < 1e-6
    assert abs(peak - 5.0 * whole / rate) < 0.01
PROGRAM
