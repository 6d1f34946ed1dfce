#!/usr/bin/env bash
# Expected: ten pixels of 0.1 mm from a mark a distance map is 1 mm, or 10 px; a blur by sigma has that sigma.
# What happens: `SignedMaurerDistanceMap` is 100, the square of the distance in pixels, beside 10 of
#   `DanielssonDistanceMap`; both leave the spacing out, though SimpleITK keeps it with each image.
#   `DiscreteGaussian` cuts its kernel at 32 px: a blur of 20 px is one of 15.8, of 25 px one of 16.9; up to 10 px it
#   is right, and the sum of grey values is kept, so that the usual test passes.
# Package: SimpleITK 2.5.7, numpy 2.4.6. Source: squaredDistance, useImageSpacing and maximumKernelWidth are documented.
# Who is hurt: whoever measures gaps and thicknesses of parts, or takes a background as a wide blur.
# Instead: squaredDistance=False, useImageSpacing=True; SmoothingRecursiveGaussian, or maximumKernelWidth=400 (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 SimpleITK==2.5.7
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import SimpleITK as sitk

warnings.simplefilter("error")
print("SimpleITK", sitk.Version.VersionString(), "numpy", np.__version__)
mark = np.zeros((41, 41), np.uint8)
mark[20, 20] = 1
image = sitk.GetImageFromArray(mark)
image.SetSpacing((0.1, 0.1))
distance = {
    "SignedMaurerDistanceMap": sitk.SignedMaurerDistanceMap(image)[30, 20],
    "DanielssonDistanceMap": sitk.DanielssonDistanceMap(image)[30, 20],
    "asked for": sitk.SignedMaurerDistanceMap(image, squaredDistance=False, useImageSpacing=True)[30, 20],
}
print("ten pixels of 0.1 mm:", ", ".join(f"{name} {value:g}" for name, value in distance.items()))
assert distance["SignedMaurerDistanceMap"] == 100.0 and distance["DanielssonDistanceMap"] == 10.0
assert abs(distance["asked for"] - 1.0) < 1e-6

point = np.zeros((601, 601), np.float32)
point[300, 300] = 1.0
across = np.arange(601) - 300.0


def width(blurred):
    blurred = sitk.GetArrayFromImage(blurred).astype(float)
    return float(np.sqrt((blurred * across**2).sum() / blurred.sum())), float(blurred.sum())


image = sitk.GetImageFromArray(point)
for sigma in (2.0, 5.0, 10.0, 20.0, 25.0):
    plain, total = width(sitk.DiscreteGaussian(image, variance=sigma**2))
    wide, _ = width(sitk.DiscreteGaussian(image, variance=sigma**2, maximumKernelWidth=400))
    recursive, _ = width(sitk.SmoothingRecursiveGaussian(image, sigma=sigma))
    print(f"blur of {sigma:g} px: DiscreteGaussian {plain:.2f} (sum {total:.4f}), kernel of 400 {wide:.2f}, "
          f"SmoothingRecursiveGaussian {recursive:.2f}")
    assert abs(wide / sigma - 1.0) < 0.05 and abs(recursive / sigma - 1.0) < 0.05 and abs(total - 1.0) < 1e-3
    assert abs(plain / sigma - 1.0) < 0.05 if sigma <= 10.0 else plain < 18.0
PROGRAM
