#!/usr/bin/env bash
# Expected: 2 by 2 binning (`downscale_local_mean`, `block_reduce`) of an image of one grey value gives this value;
#   where the size is odd the last row is left out, or is the mean of what is there.
# What happens: the image is filled up with zeros: the last row and column have half the grey value, the corner a
#   quarter. In bins of 8 the border of 481 by 641 has an eighth. The minimum is 0 and the median as well. No warning.
# Package: scikit-image 0.26.0. Source: `cval` and its default are documented; what it does was found by trying.
# Who is hurt: whoever bins films before thresholds, centroids or differences: a dark rim, or a film's range, appears.
# Instead: cut the image to a multiple of the bin first, or block_reduce with cval=nan and numpy.nanmean (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pillow==13.0.0 tifffile==2026.3.3 imageio==2.38.1 networkx==3.6.1 lazy-loader==0.6 \
    packaging==26.4 scikit-image==0.26.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import skimage
from skimage.measure import block_reduce
from skimage.transform import downscale_local_mean

warnings.simplefilter("error")
print("scikit-image", skimage.__version__, "numpy", np.__version__)
image = np.full((5, 5), 100.0)
for binned in (downscale_local_mean(image, (2, 2)), block_reduce(image, 2, np.mean)):
    print("2 by 2 bins of 100:", binned.tolist())
    assert np.array_equal(binned, [[100, 100, 50], [100, 100, 50], [50, 50, 25]])
film = np.full((481, 641), 100.0)
film[-1, -1] = 100.0
binned = downscale_local_mean(film, (8, 8))
print("481 by 641 in bins of 8: last row", binned[-1, 0], "corner", binned[-1, -1], "; least by block",
      block_reduce(film, 8, np.min).min(), "median of the corner", block_reduce(film, 8, np.median)[-1, -1])
assert binned[-1, 0] == 12.5 and binned[-1, -1] == 100.0 / 64.0
assert block_reduce(film, 8, np.min)[-1].max() == 0.0 and block_reduce(film, 8, np.median)[-1, -1] == 0.0
# instead
assert np.all(downscale_local_mean(film[:480, :640], (8, 8)) == 100.0)
assert np.all(block_reduce(film, 8, np.nanmean, cval=np.nan) == 100.0)
PROGRAM
