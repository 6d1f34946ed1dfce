#!/usr/bin/env bash
# Expected: `float(length)` is the value in one unit, whichever size it has, or is refused.
# What happens: float, int and numpy take the number that is printed, after a prefix was chosen for it: 1500 m, 1.5 m
#   and 1.5 mm are all 1.5; an array of 1 mm, 10 mm, ... 1 km as floats is 1, 10, 100, 1, 10, 100, 1. Comparisons and
#   arithmetic of the quantities are right. No warning.
# Package: forallpeople 3.0.0, numpy 2.4.6. Source: that float is the printed number is documented; its effect on
#   a column was tried.
# Who is hurt: whoever plots, fits or stores quantities: numpy.array(list, dtype=float), a format, a file.
# Instead: the quotient by the wanted unit, x / si.m, which is a number (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 forallpeople==3.0.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import math
import warnings
from importlib.metadata import version

import forallpeople as si
import numpy as np

warnings.simplefilter("error")
si.environment("default")
print("forallpeople", version("forallpeople"), "numpy", np.__version__)
lengths = [10.0**k * si.m for k in range(-3, 4)]
floats = np.array(lengths, dtype=float)
print("1 mm to 1 km in decades, as floats:", floats, "; each over 1 m:", [float(x / si.m) for x in lengths])
forces = [0.5 * si.N, 0.9 * si.N, 1100.0 * si.N]
print("0.5 N, 0.9 N and 1100 N as floats:", np.array(forces, dtype=float), "the largest:", max(forces))
print("interp of a force at 0.9 of the table 500 m, 900 m, 1100 m:",
      np.interp(1.0, np.array([500 * si.m, 900 * si.m, 1100 * si.m], dtype=float)[::-1], [2.0, 1.0, 0.0]))
assert all(math.isclose(float(x / si.m), 10.0**k) for k, x in zip(range(-3, 4), lengths))
assert max(forces) == forces[2] and sorted(lengths) == lengths
assert math.isclose(float(1500 * si.m), 1.5) and math.isclose(float(0.0015 * si.m), 1.5)
PROGRAM
