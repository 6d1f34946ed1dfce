#!/usr/bin/env bash
# Expected: what `pyfftw.builders` returns gives a spectrum at each call, as scipy's `rfft`, and leaves its argument.
# What happens: all calls give one array: with `before = f(film); after = f(other)` both are the second spectrum, and
#   their difference is 0. A spectrum in two dimensions is overwritten by `builders.irfft2` of it, where it lies aligned
#   in memory, which is chance with numpy. A transform made for float32 casts float64 readings. No warning.
#   `interfaces` give new arrays, and right.
# Package: pyfftw 0.15.1, scipy 1.17.1, numpy 2.4.6. Source: that arrays are used again is in the documentation of FFTW.
# Who is hurt: whoever compares two records or two images by their spectra: nothing differs.
# Instead: pyfftw.interfaces with its cache, or a copy of each result (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pyfftw==0.15.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import pyfftw
import scipy.fft

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("pyfftw", "scipy", "numpy")))
times = np.arange(1000) / 1000
before, after = np.sin(2 * np.pi * 20 * times), 0.5 * np.sin(2 * np.pi * 50 * times)


def peaks(spectra):
    return [int(np.abs(spectrum).argmax()) for spectrum in spectra]


transform = pyfftw.builders.rfft(before)
built = [transform(before), transform(after)]
given = [scipy.fft.rfft(before), scipy.fft.rfft(after)]
interfaces = [pyfftw.interfaces.numpy_fft.rfft(before), pyfftw.interfaces.numpy_fft.rfft(after)]
copied = [transform(before).copy(), transform(after).copy()]
print(f"peaks in Hz of records with 20 and 50 Hz: builders {peaks(built)}, scipy {peaks(given)}, interfaces "
      f"{peaks(interfaces)}, copies {peaks(copied)}; difference by builders {np.abs(built[0] - built[1]).max()}")
assert peaks(built) == [50, 50] and np.abs(built[0] - built[1]).max() == 0
assert peaks(given) == peaks(interfaces) == peaks(copied) == [20, 50]

image = np.random.default_rng(1).normal(size=(64, 64))
for name, back in (("builders", lambda spectrum: pyfftw.builders.irfft2(spectrum)()),
                   ("interfaces", pyfftw.interfaces.numpy_fft.irfft2), ("scipy", scipy.fft.irfft2)):
    spectrum = pyfftw.byte_align(scipy.fft.rfft2(image))
    kept = spectrum.copy()
    right = np.allclose(back(spectrum), image)
    changed = float(np.mean(spectrum != kept))
    print(f"irfft2 of a spectrum by {name}: right {right}, share of the spectrum that is changed {changed:.2f}")
    assert right and (changed > 0.9 if name == "builders" else changed == 0)

single = pyfftw.builders.rfft(before.astype(np.float32))
error = np.abs(single(before) - given[0]).max() / np.abs(given[0]).max()
print(f"float64 readings by a transform made for float32: an error of {error:.1g} of the largest")
assert 1e-9 < error < 1e-5
PROGRAM
