#!/usr/bin/env bash
# Expected: the estimators of one package give densities, so that the integral of each is about the record's variance;
#   `scale_by_freq` switches between density and power.
# What happens: of a white noise of variance 1 at 1000 Hz the integral over the frequencies is 1.0 by `pburg`, `pcovar`
#   and `pma`, 25.6 by `pyule`, 25616 by `pcorrelogram`, 190 by `Periodogram`, 983 by `MultiTapering`, 0.05 by
#   `pminvar`. `scale_by_freq=True` multiplies `pburg` by 25.7, 2 pi over the spacing of the frequencies, and
#   `Periodogram` by the square of this, so that a longer record has more. All have the right shape, no warning.
# Package: spectrum 0.10.0, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever reads a noise floor or compares two estimators, rates or lengths.
# Instead: psd * var(record) / integral of psd (tried), or scipy.signal.welch for the level (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 easydev==0.15.0 spectrum==0.10.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
import scipy.signal
import spectrum

print(*(f"{name} {version(name)}" for name in ("spectrum", "numpy", "scipy")))
rate = 1000.0
noise = np.random.default_rng(0).normal(size=4096)
estimators = {
    "pburg": (lambda x, **more: spectrum.pburg(x, order=20, sampling=rate, **more), 1.0),
    "pcovar": (lambda x, **more: spectrum.pcovar(x, 20, sampling=rate, **more), 1.0),
    "pma": (lambda x, **more: spectrum.pma(x, 15, 30, sampling=rate, **more), 1.0),
    "pyule": (lambda x, **more: spectrum.pyule(x, 20, sampling=rate, **more), 25.6),
    "pcorrelogram": (lambda x, **more: spectrum.pcorrelogram(x, lag=20, sampling=rate, **more), 25616.0),
    "Periodogram": (lambda x, **more: spectrum.Periodogram(x, sampling=rate, **more), 190.0),
    "MultiTapering": (lambda x, **more: spectrum.MultiTapering(x, NW=2.5, k=4, sampling=rate, **more), 983.0),
    "pminvar": (lambda x, **more: spectrum.pminvar(x, 20, sampling=rate, **more), 0.05),
}


def density(estimator, record, **more):
    estimate = estimator(record, **more)
    estimate.run()
    f = np.asarray(estimate.frequencies())
    return f, np.asarray(estimate.psd)


for name, (estimator, expected) in estimators.items():
    f, psd = density(estimator, noise)
    integral = float(np.sum(psd) * f[1])
    level = float(np.median(psd * np.var(noise) / integral))
    print(f"{name}: {len(f)} frequencies to {f[-1]:g} Hz, integral {integral:.4g}, scaled to the variance a level of "
          f"{level:.5f} per Hz")
    assert len(f) == len(psd) == 2049 and f[-1] == rate / 2
    assert abs(integral / expected - 1.0) < 0.05, name
    assert 0.001 < level < 0.0025
for name in ("pburg", "Periodogram"):
    power = 1 if name == "pburg" else 2
    for length in (4096, 1024):
        f, plain = density(estimators[name][0], noise[:length], scale_by_freq=False)
        _, scaled = density(estimators[name][0], noise[:length], scale_by_freq=True)
        print(f"{name} of {length} readings: scale_by_freq multiplies by {scaled[5] / plain[5]:.2f}")
        assert np.allclose(scaled / plain, (2 * np.pi / (rate / length)) ** power)
f, welch = scipy.signal.welch(noise, rate)
print(f"welch: integral {np.sum(welch) * f[1]:.3f}, level {np.median(welch):.5f} per Hz")
assert abs(np.sum(welch) * f[1] - 1.0) < 0.05 and 0.0018 < np.median(welch) < 0.0022
PROGRAM
