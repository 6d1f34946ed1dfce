#!/usr/bin/env bash
# Expected: `calc_angle`, the angle of a step with regard to the x axis, runs from -180 to 180 degrees, as
#   `calc_heading` does.
# What happens: it is the angle of |dy| and |dx|: on a circle it goes 87, 81, ... 3, 3, ... 87 four times, so that
#   steps to the left and to the right, up and down have one angle, and a robot that runs around has the mean direction
#   45 degrees. `length` leaves a gap out: a straight way of 99 mm with eleven lost frames is 87 mm, `distance` 99 mm.
# Package: traja 25.0.1, pandas 2.3.3, numpy 2.4.6. Source: found by trying; the page names no range.
# Who is hurt: whoever tells from directions of steps whether a robot drifts, or turns one way more often.
# Instead: `calc_heading`, or np.arctan2 of the differences (both tried); fill gaps before a length.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pandas==2.3.3 scikit-learn==1.9.1 traja==25.0.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np

warnings.simplefilter("ignore")  # it asks for PyTorch
import traja

print(*(f"{name} {version(name)}" for name in ("traja", "pandas", "numpy")))
turn = np.linspace(0.0, 2 * np.pi, 60, endpoint=False)
circle = traja.TrajaDataFrame({"x": 10 * np.cos(turn), "y": 10 * np.sin(turn), "time": 0.1 * np.arange(60)})
step = np.diff(circle[["x", "y"]].to_numpy(), axis=0)
right = np.degrees(np.arctan2(step[:, 1], step[:, 0]))
angle = traja.calc_angle(circle).to_numpy()[1:]
heading = traja.calc_heading(circle).to_numpy()[1:]
print("arctan2: ", *right[::6].round().astype(int))
print("heading: ", *heading[::6].round().astype(int))
print("angle:   ", *angle[::6].round().astype(int), "mean", angle.mean().round(1))
assert np.allclose(heading, right)
assert np.allclose(angle, np.degrees(np.arctan2(np.abs(step[:, 1]), np.abs(step[:, 0]))))
assert angle.min() > 0 and angle.max() < 90

straight = traja.TrajaDataFrame({"x": np.arange(100.0), "y": np.zeros(100), "time": 0.1 * np.arange(100)})
straight.loc[50:60, ["x", "y"]] = np.nan
print("99 mm with eleven frames lost: length", traja.length(straight), "distance", traja.distance(straight))
assert traja.length(straight) == 87.0 and traja.distance(straight) == 99.0
PROGRAM
