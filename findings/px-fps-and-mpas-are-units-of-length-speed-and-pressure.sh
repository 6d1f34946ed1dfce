#!/usr/bin/env bash
# Expected: `px`, `fps` and `mPas` of a table are pixels, frames per second and mPa s, or unknown.
# What happens: pint's `px` is a length of 1/96 inch, so 100 px are 26458 um without a calibration (`pixel` is a unit of
#   its own); `fps` is foot per second, `dpi` a dry pint, and `mPas` the plural of millipascal. scipp has `mPas` as mPa
#   and `fps` as ft/s too, and `a` as an are.
# Packages: pint 0.25.3, scipp 26.8.0 (unyt 3.2.0 and astropy 8.0.2 refuse them).
# Who is hurt: whoever lets a heading's unit be converted: a track in px becomes a speed in um/s, wrong and plausible.
# Instead: refuse these names before parsing, and compare the dimension that came out (tried below). Source: pint's
#   issue 1396; the rest by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pint==0.25.3 scipp==26.8.0 unyt==3.2.0 astropy==8.0.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import astropy
import astropy.units as u
import numpy as np
import pint
import scipp as sc
import unyt

registry = pint.UnitRegistry()
track = registry.Quantity(100.0, "px/s").to("um/s")
assert np.isclose(track.magnitude, 100.0 * 25400.0 / 96.0)
assert registry.Quantity(1.0, "pixel").dimensionality != registry.Quantity(1.0, "m").dimensionality
assert np.isclose(registry.Quantity(30.0, "fps").to("m/s").magnitude, 9.144)
assert registry.Unit("dpi").dimensionality == registry.Unit("m**3").dimensionality
assert registry.Unit("mPas") == registry.Unit("mPa")
assert sc.Unit("mPas") == sc.Unit("mPa")
assert sc.Unit("fps") == sc.Unit("ft/s")
assert sc.Unit("a").name != sc.Unit("year").name and sc.scalar(1.0, unit="a").to(unit="m**2").value == 100.0
for name in ("px", "fps", "mPas"):
    try:
        unyt.Unit(name)
    except unyt.exceptions.UnitParseError:
        pass
    else:
        raise SystemExit("unyt knows " + name)
    try:
        u.Unit(name)
    except ValueError:
        pass
    else:
        raise SystemExit("astropy knows " + name)


# instead
def unit_of(heading, dimension):
    unit = registry.Unit(heading)
    if heading in {"px", "fps", "dpi"} or unit.dimensionality != registry.Unit(dimension).dimensionality:
        raise ValueError(f"{heading} is no unit of {dimension}")
    return unit


for heading, dimension in (("px", "m"), ("fps", "1/s"), ("mPas", "Pa*s")):
    try:
        unit_of(heading, dimension)
    except ValueError:
        continue
    raise SystemExit("not refused: " + heading)
print("pint", pint.__version__, "scipp", sc.__version__, "unyt", unyt.__version__, "astropy", astropy.__version__)
print("pint: 100 px/s is", track, "; 30 fps is", registry.Quantity(30.0, "fps").to("m/s"), "; mPas is", registry.Unit("mPas"))
print("scipp: mPas is", sc.Unit("mPas"), "and a is", sc.Unit("a"))
PROGRAM
