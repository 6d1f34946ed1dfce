#!/usr/bin/env bash
# Expected: all corner refinements of OpenCV's marker detector, and AprilTag's own, find a sharp tag of 80 px to 0.1
#   px.
# What happens: CORNER_REFINE_APRILTAG and pupil_apriltags count from the edge of the first pixel, not from its middle:
#   the tag stands 0.5 and 0.4 px to the right and below. Without refinement and with CONTOUR its corners are outer
#   pixels' middles: it is 79 px wide (SUBPIX 79.7), so 1.3 % too far away. No warning.
# Package: opencv-python-headless 5.0.0.93, pupil-apriltags 1.0.4.post11. Source: found by trying.
# Who is hurt: whoever measures by a small tag, mixes detectors, or hands AprilTag's corners to solvePnP.
# Instead: take 0.5 px from APRILTAG's corners (tried), and calibrate the scale with the refinement that measures.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 opencv-python-headless==5.0.0.93 pupil-apriltags==1.0.4.post11
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import cv2
import numpy as np
from pupil_apriltags import Detector

warnings.simplefilter("error")
print("OpenCV", cv2.__version__, "pupil-apriltags", version("pupil-apriltags"), "numpy", np.__version__)
family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
fine = np.full((2400, 3200), 255, np.uint8)
fine[800:1600, 1200:2000] = cv2.aruco.generateImageMarker(family, 5, 800)  # ten of these pixels are one of the picture
picture = cv2.GaussianBlur(cv2.resize(fine, (320, 240), interpolation=cv2.INTER_AREA), (0, 0), 0.7)
# a pixel's own place is its middle, as in cv2.moments, cornerSubPix, undistortPoints and numpy's indices
weight = 255.0 - picture
rows, columns = np.mgrid[:240, :320]
box = weight > 127
true = (columns[box].min() + columns[box].max()) / 2.0
assert true == 159.5 and np.ptp(columns[box]) + 1 == 80


def opencv(refinement):
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = getattr(cv2.aruco, f"CORNER_REFINE_{refinement}")
    return cv2.aruco.ArucoDetector(family, parameters).detectMarkers(picture)[0][0][0]


corners = {name: opencv(name) for name in ("NONE", "CONTOUR", "SUBPIX", "APRILTAG")}
corners["pupil_apriltags"] = Detector(families="tag36h11").detect(picture)[0].corners
seen = {name: (float(each[:, 0].mean()), float(np.sort(each[:, 0])[2:].mean() - np.sort(each[:, 0])[:2].mean()))
        for name, each in corners.items()}
print(f"a tag 80 px wide whose middle is at {true}:")
for name, (middle, width) in seen.items():
    print(f"  {name}: middle {middle:.2f}, width {width:.2f} px")
for name, middle, width in (("NONE", 159.5, 79.0), ("CONTOUR", 159.5, 79.0), ("SUBPIX", 159.5, 79.71),
                            ("APRILTAG", 160.0, 80.0), ("pupil_apriltags", 159.87, 80.0)):
    assert np.allclose(seen[name], (middle, width), atol=0.02)
# instead
assert abs(seen["APRILTAG"][0] - 0.5 - true) < 0.02
PROGRAM
