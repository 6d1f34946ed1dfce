#!/usr/bin/env bash
# Expected: the distance of patterns is of normalised ones, so that the unit of a record does not matter, and one pattern
#   has one distance from its own copy, 0, from every function of the package.
# What happens: the number of readings times two standard deviations is taken as 1e-14 at least in `mass`, and so in
#   `match`, `motifs` and `mstump`: of a pattern of 50 readings of 5 nm in metres the pattern itself is 9.7 away, a
#   constant would be 7.1, and all is between 9.7 and 10.4; `match` lists strangers, `motifs` nothing. `stump` of the same
#   record finds the copy at 0.0 (tried; it is too slow for this script). In millimetres all is right. No warning.
# Package: stumpy 1.14.1, numpy 2.4.6, scipy 1.17.1. Source: found by trying; the pages say that distances are of
#   normalised patterns; STUMPY_DENOM_THRESHOLD stands in the package's settings alone.
# Who is hurt: whoever looks for a pattern in small motions, currents or forces in SI; the profile by `stump` looks right.
# Instead: divide the record by its standard deviation first (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 numba==0.68.1 stumpy==1.14.1
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
import stumpy

print(*(f"{name} {version(name)}" for name in ("stumpy", "numpy", "scipy")))
record = np.random.default_rng(0).normal(size=500).cumsum()
record[100:150] = record[400:450] = 5.0 * np.sin(np.arange(50) / 3)


def normalised(readings):
    return (readings - readings.mean()) / readings.std()


def seen(readings):
    away = stumpy.mass(readings[100:150], readings)
    found = stumpy.match(readings[100:150], readings)
    right = np.array([np.linalg.norm(normalised(readings[100:150]) - normalised(readings[i : i + 50])) for i in range(len(away))])
    return away, right, [(round(float(distance), 2), int(place)) for distance, place in found]


for unit, name in ((1.0, "nm"), (1e-6, "mm"), (1e-9, "m"), (1e-12, "km")):
    away, right, found = seen(record * unit)
    print(f"in {name}: away {away[[100, 400]].round(2)}, right {right[[100, 400]].round(2)}, all {away.min():.2f} to {away.max():.2f}; match {found}")
    assert right[[100, 400]].max() < 1e-9 and right.max() > 12
    if unit > 1e-9:
        assert abs(away - right).max() < 1e-3 and found == [(0.0, 100), (0.0, 400)]
    else:
        assert away.min() > 9.6 and away.max() < 10.6 and found[0][0] > 9.6
    if unit == 1e-9:
        assert len(found) > 2
small = record * 1e-9
away, right, found = seen(small / small.std())
print(f"divided by the deviation: {away[[100, 400]]}; match {found}")
assert abs(away - right).max() < 1e-3 and found == [(0.0, 100), (0.0, 400)]
PROGRAM
