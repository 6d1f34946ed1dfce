#!/usr/bin/env bash
# Expected: functions of a pure number use the number: exp(1 mm/m) is 1.001, exp(5 %) 1.051; exp(1 s) is refused.
# What happens: unyt takes the bare number: exp(1 mm/m) is 2.718, exp(5 percent) 148, log10(1 mm/m) 0, sin(1 mm/m) 0.84,
#   `2.0 ** (500 ms/s)` 2^500; `float` of 5 percent is 5.0; exp(1 s) is 2.718 and sin(1 s) 0.84. `1 - 5 percent` and
#   sin(90 deg) are right, and 500 ms / 1 s, which unyt reduces itself.
# Package: unyt 3.2.0 (pint 0.25.3 and astropy 8.0.2 give 1.001 and refuse seconds).
# Who is hurt: whoever writes a decay, slope or strain with its unit.
# Instead: `.to("dimensionless")` before the function (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 unyt==3.2.0 pint==0.25.3 astropy==8.0.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import astropy
import astropy.units as u
import numpy as np
import pint
import unyt

slope = unyt.unyt_array([1.0], "mm/m")
assert np.isclose(np.exp(slope), np.e)
assert np.log10(slope) == 0.0
assert np.isclose(np.sin(slope), np.sin(1.0))
part = unyt.unyt_quantity(5.0, "percent")
assert np.isclose(np.exp(part), np.exp(5.0))
assert float(part) == 5.0
assert np.isclose((1 - part).to_value("dimensionless"), 0.95)
assert np.isclose(2.0 ** unyt.unyt_array([500.0], "ms/s"), 2.0**500)
second = unyt.unyt_array([1.0], "s")
assert np.isclose(np.exp(second), np.e) and np.isclose(np.sin(second), np.sin(1.0))
registry = pint.UnitRegistry()
assert np.isclose(np.exp(registry.Quantity(1.0, "mm/m")).magnitude, np.exp(1e-3))
assert np.isclose(np.exp(1.0 * u.mm / u.m), np.exp(1e-3))
for refused in (lambda: np.exp(registry.Quantity(1.0, "s")), lambda: np.exp(1.0 * u.s)):
    try:
        refused()
    except (pint.DimensionalityError, u.UnitTypeError, TypeError):
        pass
    else:
        raise SystemExit("seconds are not refused any more")
# instead
assert np.isclose(np.exp(slope.to("dimensionless")), np.exp(1e-3))
print("unyt", unyt.__version__, "pint", pint.__version__, "astropy", astropy.__version__)
print("exp of 1 mm/m:", np.exp(slope), "of 5 percent:", np.exp(part), "of 1 s:", np.exp(second))
PROGRAM
