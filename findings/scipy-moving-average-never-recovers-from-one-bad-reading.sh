#!/usr/bin/env bash
# Expected: one NaN spoils the five averages of five that contain it; one glitch of 1e20 spoils five too.
# What happens: `uniform_filter1d` carries a running sum: after one NaN all later readings are NaN, after 1e20 all later
#   ones are 0, after inf all are NaN. `median_filter` and `medfilt` hide the NaN but give numbers that are no medians
#   of the others; `gaussian_filter1d`, `savgol_filter` and `convolve` behave as expected, `fftconvolve` loses all.
# Package: scipy 1.17.1.
# Who is hurt: whoever smooths a log with one lost frame: the rest of the record is gone, or zero without a word.
# Instead: `correlate1d` with equal weights, or `np.convolve` (tried below). Source: SciPy's issue 7818; the glitch was
#   found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import scipy
from scipy import ndimage, signal

lost, glitch = np.ones(100), np.ones(100)
lost[50], glitch[50] = np.nan, 1e20
smooth = ndimage.uniform_filter1d(lost, 5)
assert np.isnan(smooth[48:]).all() and (smooth[:48] == 1.0).all()
after = ndimage.uniform_filter1d(glitch, 5)
assert (after[53:] == 0.0).all() and (after[:48] == 1.0).all()
weights = np.full(5, 0.2)
for usual in (
    lambda v: np.convolve(v, weights, "same"),
    lambda v: signal.savgol_filter(v, 5, 1),
    lambda v: ndimage.gaussian_filter1d(v, 0.5),
):
    assert np.isnan(usual(lost)).sum() == 5
assert np.isnan(signal.fftconvolve(lost, weights, "same")).all()
ramp = np.arange(1.0, 9.0)
ramp[4] = np.nan
median = ndimage.median_filter(ramp, 5)
assert np.isfinite(median).all()
window = ramp[1:6]
assert np.nanmin(window) == 2.0 and np.nanmedian(window) == 3.5
assert median[3] == 2.0
# instead
safe = ndimage.correlate1d(lost, weights)
assert np.isnan(safe).sum() == 5
assert np.allclose(ndimage.correlate1d(glitch, weights)[53:], 1.0)
print("scipy", scipy.__version__, "numpy", np.__version__)
print("one NaN of 100: uniform_filter1d has", np.isnan(smooth).sum(), "NaN, correlate1d", np.isnan(safe).sum())
print("one 1e20: the reading 20 later is", after[70], "; median of 2, 3, 4, NaN, 6:", median[3])
PROGRAM
