#!/usr/bin/env bash
# Expected: `scipy.spatial.distance.euclidean` of two places in uint16 pixels is their distance, as `cdist` of the same
#   arrays says.
# What happens: from (100, 900) to (130, 860) it is 65506 in place of 50: the difference is made in uint16 and wraps. Of
#   a track to and fro each second step is wrong. `minkowski`, `cityblock` and `chebyshev` are wrong as well;
#   `sqeuclidean` and `cdist` are right. No warning.
# Package: scipy 1.17.1. Source: found by trying; only sqeuclidean's code promotes integers.
# Who is hurt: whoever measures paths or pairs spots by places that a detector gave as uint16 (or ADC counts as uint8).
# Instead: cdist, or .astype(float) (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import scipy
from scipy.spatial import distance

warnings.simplefilter("error")
here, there = np.array([100, 900], np.uint16), np.array([130, 860], np.uint16)
right = {"euclidean": 50.0, "minkowski": 50.0, "cityblock": 70.0, "chebyshev": 40.0, "sqeuclidean": 2500.0}
print("scipy", scipy.__version__, "numpy", np.__version__)
for name, should in right.items():
    by_pair = float(getattr(distance, name)(here, there))
    by_cdist = float(distance.cdist(here[None], there[None], name)[0, 0])
    print(f"{name}: {by_pair:.1f} by the pair, {by_cdist:.1f} by cdist, right {should}")
    assert abs(by_cdist - should) < 1e-9
    assert abs(by_pair - should) < 1e-9 if name == "sqeuclidean" else by_pair > 60000.0
    # instead
    assert abs(getattr(distance, name)(here.astype(float), there.astype(float)) - should) < 1e-9
track = np.array([[100, 100], [103, 104], [100, 100], [103, 104]], np.uint16)
steps = [float(distance.euclidean(a, b)) for a, b in zip(track[1:], track[:-1], strict=True)]
print("steps of 5 px there and back:", [round(step, 1) for step in steps])
assert steps[0] == 5.0 == steps[2] and steps[1] > 60000.0
PROGRAM
