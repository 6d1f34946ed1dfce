#!/usr/bin/env bash
# Expected: ten frames written one by one by a TiffWriter make a film of ten frames for `imread`.
# What happens: `tifffile.imread` gives the first frame alone, and so does scikit-image's, though the file holds ten
#   pages: each write begins a series of its own, and only the first series is read. A film read so has no motion; no
#   warning.
# Package: tifffile 2026.3.3, scikit-image 0.26.0. Source: series are documented; the loss was found by trying.
# Who is hurt: whoever stores frames as the camera gives them and reads one image.
# Instead: contiguous=True when writing, or key=slice(None) when reading (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 tifffile==2026.3.3 scikit-image==0.26.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import skimage
import tifffile
from skimage.io import imread

warnings.simplefilter("error")
with tifffile.TiffWriter("film.tif") as file:  # frame by frame, as a camera does
    for k in range(10):
        file.write(np.full((60, 80), k, np.uint8), photometric="minisblack")
first, again = tifffile.imread("film.tif"), imread("film.tif")
whole = tifffile.imread("film.tif", key=slice(None))
with tifffile.TiffFile("film.tif") as file:
    pages = len(file.pages)
print(f"10 frames written one by one: {pages} pages, tifffile reads {first.shape}, scikit-image {again.shape}, "
      f"with key=slice(None) {whole.shape}")
print("tifffile", tifffile.__version__, "scikit-image", skimage.__version__, "numpy", np.__version__)
assert pages == 10
assert first.shape == again.shape == (60, 80) and not np.any(first)
# instead
assert whole[:, 0, 0].tolist() == list(range(10))
with tifffile.TiffWriter("film.tif") as file:
    for k in range(10):
        file.write(np.full((60, 80), k, np.uint8), photometric="minisblack", contiguous=True)
assert tifffile.imread("film.tif").shape == (10, 60, 80)
PROGRAM
