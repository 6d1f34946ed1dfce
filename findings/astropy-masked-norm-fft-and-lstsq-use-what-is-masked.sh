#!/usr/bin/env bash
# Expected: a function that cannot respect a mask refuses a `Masked` array, as `dot`, `cov` and `histogram` do.
# What happens: `np.polyfit`, `np.linalg.norm`, `lstsq`, `inv` and `np.fft` calculate with the number below the mask and
#   return it unmasked; `float` of a masked element is that number. `mean` leaves masked elements out, but `sum` is
#   masked as a whole.
# Package: astropy 8.0.2, numpy 2.4.6 (`numpy.ma` has 7.0 as sum).
# Who is hurt: whoever masks a lost sensor's 900 and fits a line, or takes a spectrum.
# Instead: select by `~m.mask` and go on with `.unmasked` (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 astropy==8.0.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import astropy
import numpy as np
from astropy.utils.masked import Masked

read = Masked(np.array([1.0, 2.0, 900.0, 4.0]), mask=[False, False, True, False])
norm = np.linalg.norm(read)
assert np.isclose(norm, np.sqrt(1 + 4 + 900.0**2 + 16)) and not np.any(getattr(norm, "mask", False))
design = np.vander(np.arange(4.0), 2)
line = np.linalg.lstsq(design, read, rcond=None)[0]
assert np.allclose(np.asarray(line), np.linalg.lstsq(design, [1.0, 2.0, 900.0, 4.0], rcond=None)[0])
assert np.allclose(np.asarray(np.polyfit(np.arange(4.0), read, 1)), np.asarray(line))
spectrum = np.fft.rfft(read)
assert np.isclose(np.asarray(spectrum)[0], 907.0)
matrix = Masked(np.array([[2.0, 1.0], [1.0, 900.0]]), mask=[[False, False], [False, True]])
assert np.isclose(np.asarray(np.linalg.inv(matrix))[0, 0], 900.0 / 1799.0)
assert float(read[2]) == 900.0
for refused in (lambda: np.dot(read, read), lambda: np.cov(read), lambda: np.histogram(read)):
    try:
        refused()
    except TypeError:
        pass
    else:
        raise SystemExit("it is not refused any more")
assert np.isclose(float(np.mean(read)), 7.0 / 3.0)
assert bool(np.sum(read).mask)
assert np.ma.array(read.unmasked, mask=read.mask).sum() == 7.0
# instead
good = ~read.mask
right = np.linalg.lstsq(design[good], read.unmasked[good], rcond=None)[0]
assert np.allclose(right, [1.0, 1.0])
print("astropy", astropy.__version__, "numpy", np.__version__)
print("norm", norm, "line", np.asarray(line), "with the masked row left out", right)
PROGRAM
