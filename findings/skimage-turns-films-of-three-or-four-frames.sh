#!/usr/bin/env bash
# Expected: a film of n grey frames in a TIFF file is read as n frames, whatever n: seen[0] is the first frame.
# What happens: films of three or four frames are taken as colour images and turned: (3, 60, 80) becomes (60, 80, 3),
#   though the file has three pages that say grey. seen[0] is then a column of the first lines. Films of two or five
#   frames are as stored. A loop over short films so mixes both; no warning.
# Package: scikit-image 0.26.0, tifffile 2026.3.3. Source: found by trying.
# Who is hurt: whoever cuts films to a few frames: before and after, one period of a walk.
# Instead: tifffile.imread (tried), which is what reads the file there, too.
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
print("scikit-image", skimage.__version__, "tifffile", tifffile.__version__, "numpy", np.__version__)
for frames in (2, 3, 4, 5):
    film = np.zeros((frames, 60, 80), np.uint8)
    film[0, 10, 20] = 255  # the robot, in the first frame only
    tifffile.imwrite("film.tif", film, photometric="minisblack")
    seen = imread("film.tif")
    with tifffile.TiffFile("film.tif") as file:
        pages = len(file.pages)
    print(f"{frames} frames in {pages} pages: shape {seen.shape}, of frame 0 {seen[0].shape}, "
          f"robot at {np.argwhere(seen)[0].tolist()}")
    assert pages == frames
    assert seen.shape == ((60, 80, frames) if frames in (3, 4) else (frames, 60, 80))
    # instead
    assert np.array_equal(tifffile.imread("film.tif"), film)
PROGRAM
