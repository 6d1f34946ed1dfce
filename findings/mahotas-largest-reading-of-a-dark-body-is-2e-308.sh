#!/usr/bin/env bash
# Expected: `labeled_max` and `labeled_sum` give for each label what numpy gives for its pixels.
# What happens: the largest of values below zero is the least positive float, 2.2e-308 (1.2e-38 in 32 bits), since the
#   search begins there; integers and `labeled_min` are right. The sum of uint8 is made in uint8: four pixels of 200 are
#   32, and a count of True is True. No warning.
# Package: mahotas 1.4.19 (1.4.13 alike), scipy 1.17.1, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever asks for the top of bodies in an image less its background or in a map of heights, or for the
#   brightness of bodies.
# Instead: scipy.ndimage.maximum and sum_labels (tried), -labeled_min(-values), a sum of floats (tried).
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

import numpy as np
from mahotas import labeled as bodies  # codespell:ignore labeled
from scipy import ndimage

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("mahotas", "scipy", "numpy")))
labels = np.zeros((20, 20), int)
labels[2:8, 2:8], labels[12:14, 12:14] = 1, 2
frame = np.full(labels.shape, 200, np.uint8)
height = np.where(labels == 1, -3.5, np.where(labels == 2, 7.5, -9.0))

for kind in (np.float64, np.float32, np.int32):
    found = bodies.labeled_max(height.astype(kind), labels)
    right = ndimage.maximum(height.astype(kind), labels, range(3))
    print(f"largest of {kind.__name__} values around, in body 1 and 2: {found}, scipy {right}")
    if kind is np.int32:
        assert np.array_equal(found, right)
    else:
        assert np.array_equal(found, [np.finfo(kind).tiny, np.finfo(kind).tiny, 7.5]) and right[1] == -3.5
mended = -bodies.labeled_min(-height, labels)
print(f"as the least of minus: {mended}")
assert np.array_equal(mended, [-9.0, -3.5, 7.5])
total, wide = bodies.labeled_sum(frame, labels), bodies.labeled_sum(frame.astype(float), labels)
count, right = bodies.labeled_sum(frame > 100, labels), ndimage.sum_labels(frame, labels, range(3))
print(f"sum of uint8 {total}, of floats {wide}, by scipy {right}; count of bright pixels {count}")
assert np.array_equal(total, right % 256) and total[2] == 32 and np.array_equal(wide, right) and count.dtype == bool
PROGRAM
