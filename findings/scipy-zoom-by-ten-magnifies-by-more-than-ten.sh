#!/usr/bin/env bash
# Expected: `ndimage.zoom(image, 10)` magnifies ten times, and a distance in the result is divided by 10.
# What happens: the middles of the outer pixels are laid on each other, so that the pitch is (n - 1) / (10 n - 1) of a
#   pixel: an image of 50 px grows by 10.18, one of 400 px by 10.02; by half of 50 px it shrinks to 0.49. The shape
#   says 500. Cuts of different size have different scales. No warning.
# Package: scipy 1.17.1. Source: `grid_mode` and its default are documented; the size was found by trying.
# Who is hurt: whoever measures distances or places in enlarged cuts of a film, or in a pyramid of images.
# Instead: grid_mode=True with mode="nearest" (tried: 10.000).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import scipy
from scipy import ndimage

warnings.simplefilter("error")
print("scipy", scipy.__version__, "numpy", np.__version__)


def apart(line):
    """Distance of the two spots, by their centroids."""
    place, half = np.arange(line.size), line.size // 2
    return np.average(place[half:], weights=line[half:]) - np.average(place[:half], weights=line[:half])


for pixels in (50, 100, 400):
    x = np.arange(pixels)
    image = np.exp(-(((x - pixels // 4) / 2.0) ** 2)) + np.exp(-(((x - 3 * pixels // 4) / 2.0) ** 2))
    true = apart(image)
    seen = {factor: apart(ndimage.zoom(image, factor, order=1)) / true for factor in (10, 2, 0.5)}
    print(f"{pixels} px: distances grow by", {factor: round(float(ratio), 4) for factor, ratio in seen.items()})
    for factor, ratio in seen.items():
        assert np.isclose(ratio, (factor * pixels - 1) / (pixels - 1), rtol=2e-3)
    # instead
    mended = apart(ndimage.zoom(image, 10, order=1, grid_mode=True, mode="nearest")) / true
    assert np.isclose(mended, 10.0, rtol=1e-4)
    if pixels == 50:
        assert seen[10] > 10.17 and seen[0.5] < 0.491
PROGRAM
