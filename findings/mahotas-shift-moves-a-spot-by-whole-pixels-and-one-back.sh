#!/usr/bin/env bash
# Expected: `interpolate.shift` moves an image by what is asked for, in parts of a pixel, as its splines of order 0 to 5
#   say; a shift by 0 and `imresize` to its own size change nothing.
# What happens: shifts are whole pixels and one too small in each direction: 0 moves a spot by -1 and -1, 0.1 to 1.0
#   along a row by 0, 1.5 and 2.0 by 1, with the values of the image itself, so that nothing shows it. `imresize` and
#   `zoom` to the same size move by -1, too. No warning.
# Package: mahotas 1.4.19 (1.4.13, 1.4.15 and 1.4.18 alike), scipy 1.17.1, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever takes a drift or a stage's motion out of a film, or tests a tracker on shifted frames.
# Instead: scipy.ndimage.shift and zoom (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 mahotas==1.4.19
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import mahotas
import numpy as np
from mahotas import interpolate
from scipy import ndimage

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("mahotas", "scipy", "numpy")))
row, column = np.mgrid[:100, :100]
spot = np.exp(-((row - 40.6) ** 2 + (column - 50.3) ** 2) / 50.0)


def moved(image):
    """Rows and columns by which the middle of the spot went."""
    return np.subtract(ndimage.center_of_mass(image), ndimage.center_of_mass(spot))


for order in (1, 3):
    for asked in (0.0, 0.1, 0.5, 1.0, 1.5, 2.0):
        found = moved(interpolate.shift(spot, [0.0, asked], order=order))
        right = moved(ndimage.shift(spot, [0.0, asked], order=order))
        print(f"order {order}, asked for 0 and {asked:g} px: mahotas {found.round(3)}, scipy {right.round(3)}")
        assert np.allclose(found, [-1.0, np.ceil(asked) - 1.0], atol=1e-3)
        assert np.allclose(right, [0.0, asked], atol=1e-3)
for name, same in (("imresize", mahotas.imresize(spot, spot.shape)), ("zoom", interpolate.zoom(spot, 1.0))):
    print(f"{name} to its own size: {moved(same).round(3)} px")
    assert np.allclose(moved(same), -1.0, atol=1e-3)
PROGRAM
