#!/usr/bin/env bash
# Expected: what the package wrote it reads back, and SI units are units: 3 Pa, 0.3 T, 5 K, 5 min.
# What happens: the first letter of a unit is a prefix wherever it can be one. `Quantity(3, 'Pa')` is written as 3 Pa and
#   read as 3e15 with the unit a; 3 T as 3e12 and 5 K as 5e3 without a unit; 5 min as 0.005 in, 30 fps as 3e-14 ps, 20 px
#   as 2e-11 x. With a prefix of its own, or a fraction, each is right: 3 kPa, 300 mT, 5 T/s, 7 K/W, 2 m/s; so are 5 Hz
#   and 5 N. A column of pressures has its factor thus by its size. No warning.
# Package: quantiphy 2.23. Source: the pages tell of the ambiguity of "1 m"; that the package's own output is hit by it
#   was found by trying.
# Who is hurt: whoever keeps settings or results as text, above all fields in tesla and temperatures in kelvin.
# Instead: `known_units` with all such units, or `ignore_sf=True` for text in base units (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check quantiphy==2.23
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version
from math import isclose

from quantiphy import Quantity

print("quantiphy", version("quantiphy"))


def returned(value, unit):
    """What is read of a quantity that the package itself wrote."""
    text = str(Quantity(value, unit))
    read = Quantity(text)
    print(f"{value} {unit}: written as {text}, read as {float(read):g} {read.units!r}")
    return float(read), read.units


wrong = {(3, "Pa"): (3e15, "a"), (3, "T"): (3e12, ""), (5, "K"): (5e3, ""), (5, "min"): (0.005, "in"), (30, "fps"): (3e-14, "ps"), (20, "px"): (2e-11, "x")}
for given, expected in wrong.items():
    value, unit = returned(*given)
    assert isclose(value, expected[0], rel_tol=1e-9) and unit == expected[1], (value, unit)
for value, unit in ((3000, "Pa"), (0.3, "T"), (5, "T/s"), (7, "K/W"), (2, "m/s"), (5, "Hz"), (5, "N")):
    read = returned(value, unit)
    assert isclose(read[0], value, rel_tol=1e-9) and read[1] == unit
plain = [Quantity(f"{value} {unit}", ignore_sf=True) for value, unit in wrong]
assert [(float(one), one.units) for one in plain] == [(value, unit) for value, unit in wrong]
print("with ignore_sf:", *plain, sep="  ")
with Quantity.prefs(known_units="Pa T K min fps px"):
    for value, unit in [*wrong, (3000, "Pa"), (0.3, "T")]:
        read = returned(value, unit)
        assert isclose(read[0], value, rel_tol=1e-9) and read[1] == unit
PROGRAM
