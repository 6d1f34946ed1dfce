#!/usr/bin/env bash
# Expected: `Line3.distance` of two straight lines is a length, whichever points or angle between them name the lines.
# What happens: the reciprocal product is divided by the square of |w1 x w2| and not by |w1 x w2|: lines 0.25 apart are
#   0.25 for points 1 apart at a right angle, 0.03 for points 2 apart, 2.5e-10 for 1000 and 2.5e8 for a thousandth; of
#   unit vectors at 30 degrees 0.5, at 5 degrees 2.9. No warning. `closest_to_line` is right.
# Package: spatialmath-python 1.1.18, numpy 2.4.6, scipy 1.17.1. Source: found by trying.
# Who is hurt: whoever checks axes, legs or wires for clearance: in metres with points a millimetre apart all is free.
# Instead: the second result of `closest_to_line` (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 ansitable==1.2.0 spatialmath-python==1.1.18
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from spatialmath import Line3

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("spatialmath-python", "numpy", "scipy")))
gap = 0.25

for apart, angle, seen in ((1.0, 90, 0.25), (2.0, 90, 0.25 / 8), (1000.0, 90, 2.5e-10), (1e-3, 90, 2.5e8),
                           (1.0, 30, 0.5), (1.0, 5, 0.25 / np.sin(np.radians(5.0)))):
    way = apart * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0])
    first = Line3.Join([0.0, 0.0, 0.0], [apart, 0.0, 0.0])
    second = Line3.Join([0.0, 0.0, gap], way + [0.0, 0.0, gap])
    found, right = first.distance(second), first.closest_to_line(second)[1]
    print(f"points {apart:g} apart, {angle} degrees: distance {found:.4g}, by closest_to_line {right:.4g}")
    assert abs(found / seen - 1.0) < 1e-6 and abs(right / gap - 1.0) < 1e-6
PROGRAM
