#!/usr/bin/env bash
# Expected: two libraries of units that both know degrees Celsius and m/s^2 understand each other's
#   text of them, as they do for "mT" or "K".
# What happens: astropy writes `deg_C`, which pint does not know; pint writes `degree_Celsius`, which
#   astropy does not know. An acceleration of astropy is `m / s2`, of which pint takes `s2` for a name.
#   And astropy converts Celsius to kelvin only with an equivalency that has to be given.
# Packages: astropy 6.1.7, pint 0.24.4.
# Who is hurt: whoever passes the text of a unit from one to the other: a log in Celsius or of an
#   acceleration is refused, where the same log in K or in m / s / s works.
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
