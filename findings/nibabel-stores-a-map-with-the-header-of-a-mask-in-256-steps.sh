#!/usr/bin/env bash
# Expected: an image of float64 is stored as floats, or with an error; the header is there for the place and the units.
# What happens: the type of the header decides. With the header of a mask of uint8, the usual way to keep its geometry,
#   a map from -1 to 1 has 256 steps, and NaN is read back as -0.004, a plausible reading; one reading of 1e6 makes all
#   others, 0 to 300, one value. With int16 there are 65536 steps. No warning; `get_fdata` hides it as float64. The
#   image in memory is right, so that a test before the file is closed passes. Without a header all is kept.
# Package: nibabel 5.4.2, numpy 2.4.6. Source: found by trying; the page of Nifti1Image does not speak of it.
# Who is hurt: whoever segments a scan of a part and stores a map of distances, strains or forces over the mask.
# Instead: `image.set_data_dtype(np.float64)` before saving, or no header (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check numpy==2.4.6 nibabel==5.4.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import nibabel
import numpy as np

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("nibabel", "numpy")))
shape = (10, 10, 10)
place = np.diag([0.1, 0.1, 0.1, 1.0])


def stored(values, kind, mend=False):
    mask = nibabel.Nifti1Image(np.zeros(shape, kind), place)
    image = nibabel.Nifti1Image(values, mask.affine, mask.header)
    if mend:
        image.set_data_dtype(np.float64)
    assert np.array_equal(image.get_fdata(), values, equal_nan=True)
    nibabel.save(image, "map.nii.gz")
    return nibabel.load("map.nii.gz").get_fdata()


smooth = np.linspace(-1.0, 1.0, 1000).reshape(shape)
gap = smooth.copy()
gap[5, 5, 5] = np.nan
wild = np.linspace(0.0, 300.0, 1000).reshape(shape)
wild[9, 9, 9] = 1e6
for kind, steps in ((np.uint8, 256), (np.int16, 1000)):
    read = stored(smooth, kind)
    print(f"header of {np.dtype(kind)}: {len(np.unique(read))} values of 1000, off by {abs(read - smooth).max():.2g}")
    assert len(np.unique(read)) == steps and 0 < abs(read - smooth).max() < 1.01 / min(steps, 256)
read = stored(gap, np.uint8)
print("NaN is read as", read[5, 5, 5])
assert np.isfinite(read).all() and abs(read[5, 5, 5]) < 0.01
read = stored(wild, np.uint8)
print("beside 1e6, 0 to 300 are read as", np.unique(read)[:-1])
assert len(np.unique(read)) == 2
for values in (smooth, gap, wild):
    assert np.array_equal(stored(values, np.uint8, mend=True), values, equal_nan=True)
    nibabel.save(nibabel.Nifti1Image(values, place), "plain.nii.gz")
    assert np.array_equal(nibabel.load("plain.nii.gz").get_fdata(), values, equal_nan=True)
PROGRAM
