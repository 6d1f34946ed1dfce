#!/usr/bin/env bash
# Expected: readings with one stated error of 0.1 give with `weights` of 1/0.1**2 the curve and the band of no weights.
# What happens: the smoothing is not scaled with the weights, and the band of `prediction_intervals` is that of a
#   reading of weight 1: with 100 for each it is 3.7 wide for 0.39, with 1/100 0.08. The curve follows the noise: its
#   error is 0.032 for 0.018, with 1/100 0.075. Readings in a unit 1000 times as large with their 1/sigma**2 have a band
#   9600 times too wide. No warning.
# Package: pygam 0.12.0, scipy 1.16.3, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever gives a smooth force law or a calibration its readings' errors.
# Instead: weights divided by their mean (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.16.3 pygam==0.12.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from pygam import LinearGAM, s

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("pygam", "scipy", "numpy")))
place = np.linspace(0.0, 1.0, 200)
curve = np.sin(6 * place)
readings = curve + np.random.default_rng(0).normal(0.0, 0.1, len(place))


def fitted(unit, weight):
    """Error of the curve and width of the band of 95 % in its middle, in the errors' unit of 1."""
    options = {} if weight is None else {"weights": np.full(len(place), weight)}
    model = LinearGAM(s(0)).fit(place[:, None], readings * unit, **options)
    band = np.diff(model.prediction_intervals(place[:, None], width=0.95))[len(place) // 2, 0] / unit
    error = np.sqrt(np.mean((model.predict(place[:, None]) / unit - curve) ** 2))
    print(f"unit {unit:g}, weight {weight}: error of the curve {error:.3f}, band {band:.4g}, degrees of freedom "
          f"{model.statistics_['edof']:.1f}")
    return error, band


error, band = fitted(1.0, None)
assert abs(band - 4 * 0.1) < 0.02 and error < 0.02
for unit, weight, errors, bands in ((1.0, 1.0, 1.0, 1.0), (1e-3, None, 1.0, 1.0), (1.0, 100.0, 1.8, 9.6),
                                    (1.0, 0.01, 4.2, 0.2), (1e-3, 1e8, 2.0, 9600.0)):
    found = fitted(unit, weight)
    assert abs(found[0] / error / errors - 1) < 0.05 and abs(found[1] / band / bands - 1) < 0.05
stated = np.full(len(place), 1 / 1e-4**2)
model = LinearGAM(s(0)).fit(place[:, None], readings * 1e-3, weights=stated / stated.mean())
mended = np.diff(model.prediction_intervals(place[:, None], width=0.95))[len(place) // 2, 0] / 1e-3
print(f"weights over their mean: band {mended:.3f}")
assert abs(mended / band - 1) < 1e-6
PROGRAM
