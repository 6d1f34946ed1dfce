#!/usr/bin/env bash
# Expected: a lost marker is NaN, or is left out, in each reader of motion capture files.
# What happens: ezc3d writes NaN (or a residual of -1) as the residual -1 and reads NaN; the same file read by `c3d` has
#   the point at 0, 0, 0, a place like any other, and only the fourth column, -1, tells. Frames are counted from 0 there
#   and from 1 here, and the residual stands in another array.
# Packages: ezc3d 1.7.2, c3d 0.6.0.
# Who is hurt: whoever takes speeds from the coordinates that `c3d` gives: a jump to the origin and back.
# Instead: set points whose fourth column is below 0 to NaN (tried below).
# Source: the C3D format's text has -1 for an invalid point; found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 ezc3d==1.7.2 c3d==0.6.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import importlib.metadata

import c3d
import ezc3d
import numpy as np

made = ezc3d.c3d()
made["parameters"]["POINT"]["RATE"]["value"] = [100]
made["parameters"]["POINT"]["LABELS"]["value"] = ("A",)
points = np.ones((4, 1, 4))
points[:3, 0, :] = [[10.0, 11.0, 12.0, 13.0], [20.0, 21.0, 22.0, 23.0], [30.0, 31.0, 32.0, 33.0]]
points[:3, 0, 1] = np.nan
made["data"]["points"] = points
residuals = np.zeros((1, 1, 4))
residuals[0, 0, 2] = -1.0
made["data"]["meta_points"]["residuals"] = residuals
made.write("walk.c3d")
here = ezc3d.c3d("walk.c3d")["data"]["points"][:3, 0, :].T
assert np.isnan(here[1]).all() and np.isnan(here[2]).all()
assert here[3].tolist() == [13.0, 23.0, 33.0]
with open("walk.c3d", "rb") as file:
    frames = [(number, table[0].copy()) for number, table, _ in c3d.Reader(file).read_frames()]
there = np.array([row for _, row in frames])
assert [number for number, _ in frames] == [1, 2, 3, 4]
assert (there[1:3, :3] == 0.0).all() and (there[1:3, 3] == -1.0).all()
speed = np.linalg.norm(np.diff(there[:, :3], axis=0), axis=1) * 100.0
assert speed.max() > 3000.0
# instead
clean = np.where(there[:, 3:4] < 0.0, np.nan, there[:, :3])
assert np.array_equal(clean, here.astype(np.float32), equal_nan=True)
print("ezc3d", importlib.metadata.version("ezc3d"), "c3d", importlib.metadata.version("c3d"), "numpy", np.__version__)
print("the lost frames for ezc3d:", here[1:3].tolist(), "for c3d:", there[1:3, :4].tolist())
PROGRAM
