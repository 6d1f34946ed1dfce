#!/usr/bin/env bash
# Expected: two libraries that both know degrees Celsius and m/s^2 read each other's text of them, as of "mT".
# What happens: astropy writes `deg_C`, unknown to pint, and pint `degree_Celsius`, unknown to astropy. Of
#   astropy's `m / s2` pint takes `s2` for a name. astropy converts Celsius to K only with an equivalency.
# Packages: astropy 6.1.7, pint 0.24.4.
# Who is hurt: whoever passes the text of a unit from one to the other: a log in Celsius or of an acceleration
#   is refused, where the same log in K or in m / s / s works.
# Instead: convert to K on the side that made the values, and write powers with ** (tried below).
# Source: found by trying; both names stand in the lists of units of the two documentations.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==1.26.4 astropy==6.1.7 pint==0.24.4
"$folder/venv/bin/python" - <<'PROGRAM'
import astropy
import astropy.units as u
import pint

registry = pint.UnitRegistry()
for shared in (u.K, u.mT):
    registry.Unit(str(shared))
acceleration = u.m / u.s**2
try:
    registry.Unit(str(acceleration))
except pint.UndefinedUnitError:
    pass
else:
    raise SystemExit("pint knows m / s2 now")
assert registry.Unit("m / s**2").dimensionality == registry.Unit("m/s/s").dimensionality
try:
    registry.Unit(str(u.deg_C))
except pint.UndefinedUnitError as error:
    unknown = str(error)
else:
    raise SystemExit("pint knows deg_C now")
try:
    u.Unit(str(registry.degC))
except ValueError:
    pass
else:
    raise SystemExit("astropy knows pint's name now")
warm = 20.0 * u.deg_C
try:
    warm.to(u.K)
except u.UnitConversionError:
    pass
else:
    raise SystemExit("astropy converts without an equivalency now")
kelvin = warm.to(u.K, equivalencies=u.temperature())
assert abs(registry.Quantity(kelvin.value, str(kelvin.unit)).to("degC").magnitude - 20.0) < 1e-9
print("astropy", astropy.__version__, "pint", pint.__version__)
print("astropy writes", str(u.deg_C), "and", str(acceleration), "and pint says:", unknown)
print("pint writes", str(registry.degC))
PROGRAM
