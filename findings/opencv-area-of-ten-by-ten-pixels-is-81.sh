#!/usr/bin/env bash
# Expected: a blob of 10 by 10 pixels has an area of 100, a width of 10 in any box, and one middle.
# What happens: a contour runs through the middles of the outer pixels: `contourArea` and the moments of the contour
#   give 81, minAreaRect 9 by 9, boundingRect 10 by 10, a line of 40 pixels 0. Thin parts lose more than thick ones:
#   the middle of a body with a thin leg moves by 2 px. cv2.moments of the image is right. No warning.
# Package: opencv-python-headless 5.0.0.93. Source: found by trying.
# Who is hurt: whoever measures spots, wear or robots of some pixels by their contours, or sieves blobs by their area.
# Instead: cv2.moments(image, binaryImage=True) or connectedComponentsWithStats (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 opencv-python-headless==5.0.0.93
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import cv2
import numpy as np

warnings.simplefilter("error")
print("OpenCV", cv2.__version__, "numpy", np.__version__)


def sizes(image):
    contour = cv2.findContours(image, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0][0]
    by_line, by_pixel = cv2.moments(contour), cv2.moments(image, binaryImage=True)
    return contour, cv2.contourArea(contour), by_line, by_pixel


for side in (2, 5, 10, 40):
    image = np.zeros((80, 80), np.uint8)
    image[20 : 20 + side, 20 : 20 + side] = 255
    contour, area, by_line, by_pixel = sizes(image)
    box, turned = cv2.boundingRect(contour), cv2.minAreaRect(contour)
    print(f"{side} by {side} pixels: contourArea {area:.0f}, moments of the contour {by_line['m00']:.0f}, of the image "
          f"{by_pixel['m00']:.0f}; boundingRect {box[2:]}, minAreaRect {turned[1]}")
    assert area == by_line["m00"] == (side - 1) ** 2 and by_pixel["m00"] == side**2
    assert box[2:] == (side, side) and np.allclose(turned[1], side - 1)
    assert cv2.connectedComponentsWithStats(image)[2][1, cv2.CC_STAT_AREA] == side**2  # instead
line = np.zeros((80, 80), np.uint8)
line[20:60, 30] = 255
print("a line of 40 pixels: contourArea", sizes(line)[1], "of the image", sizes(line)[3]["m00"])
assert sizes(line)[1] == 0.0 and sizes(line)[3]["m00"] == 40.0
angle = np.zeros((80, 80), np.uint8)  # a leg of two pixels on a body of twelve
angle[20:32, 20:32] = 255
angle[24:26, 32:60] = 255
_, area, by_line, by_pixel = sizes(angle)
middles = [moments["m10"] / moments["m00"] for moments in (by_line, by_pixel)]
print(f"a body with a thin leg: middle by the contour {middles[0]:.2f}, by its pixels {middles[1]:.2f}")
assert middles[1] - middles[0] > 1.8 and np.isclose(middles[1], np.argwhere(angle)[:, 1].mean())
PROGRAM
