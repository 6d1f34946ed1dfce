#!/usr/bin/env bash
# Expected: two squares that overlap by half of each have an intersection, in metres as in millimetres.
# What happens: coordinates are rounded to a thousandth of the unit before all else. Squares of 1 mm in metres have no
#   intersection, of 3 mm one of 0.67 of the right area; the area after an offset by a fifth of the side is 0.5 and 1.4
#   times the right one. The result is an empty list, as of two that lie apart. No warning; shapely is right.
# Package: pyclipr 0.1.8, shapely 2.2.0, numpy 2.3.5. Source: found by trying; `scaleFactor` is an attribute.
# Who is hurt: whoever takes parts, tool paths or contacts of small robots in SI units.
# Instead: scaleFactor = 1e9 (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 shapely==2.2.0 pyclipr==0.1.8
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import pyclipr
from shapely import Polygon

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("pyclipr", "shapely", "numpy")))


def square(size, left):
    return size * np.array([[left, 0.0], [left + 1.0, 0.0], [left + 1.0, 1.0], [left, 1.0]])


def common(size, scale=None):
    """The area that two squares have in common, of half of each."""
    clipper = pyclipr.Clipper()
    if scale:
        clipper.scaleFactor = scale
    clipper.addPath(square(size, 0.0), pyclipr.Subject)
    clipper.addPath(square(size, 0.5), pyclipr.Clip)
    return sum(Polygon(path).area for path in clipper.execute(pyclipr.Intersection)) / (0.5 * size**2)


def grown(size, scale=None):
    """The area of a square after an offset by a fifth of its side, with square corners."""
    offset = pyclipr.ClipperOffset()
    if scale:
        offset.scaleFactor = scale
    offset.addPath(square(size, 0.0), pyclipr.JoinType.Miter, pyclipr.EndType.Polygon)
    return sum(Polygon(path).area for path in offset.execute(0.2 * size)) / (1.96 * size**2)


print("default grid: a part in", pyclipr.Clipper().scaleFactor)
for size in (1.0, 3e-3, 1e-3, 1e-4):
    exact = Polygon(square(size, 0.0)).intersection(Polygon(square(size, 0.5))).area / (0.5 * size**2)
    row = common(size), common(size, 1e9), grown(size), grown(size, 1e9)
    print(f"side {size:g}: intersection {row[0]:.3f} of the right one, with 1e9 {row[1]:.3f}, by shapely {exact:.3f}; "
          f"offset {row[2]:.3f}, with 1e9 {row[3]:.3f}")
    assert all(abs(value - 1.0) < 1e-3 for value in (exact, row[1], row[3]))
    assert row[0] == 0.0 if size <= 1e-3 else row[0] > 0.3
assert common(1e-3) == 0.0
PROGRAM
