#!/usr/bin/env bash
# Expected: where NumPy takes a second quantity (`prepend`, `initial`, `mean`), it is converted or refused.
# What happens: pint and unyt take its bare number: `diff` of 1 m, 2 m with `prepend` 900 mm begins with -899 m, `sum`
#   with `initial` 1600 mm is 1603 m, pint's `std` about `mean` 1500 mm is 1498.5 m. unyt's `fill` and `pad` write 1600
#   m for 1600 mm, and `nan_to_num` with `nan` 1600 mm makes the whole array mm, 1 m becoming 1 mm.
# Packages: pint 0.25.3, unyt 3.2.0, numpy 2.4.6 (astropy 8.0.2 converts).
# Who is hurt: whoever puts a start value before a difference, or a stated value for lost readings.
# Instead: convert the second quantity first (tried below). Source: found by trying.
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

registry = pint.UnitRegistry()
way = registry.Quantity(np.array([1.0, 2.0]), "m")
short, long = registry.Quantity(900.0, "mm"), registry.Quantity(1600.0, "mm")
assert np.diff(way, prepend=short).to("m").magnitude.tolist() == [-899.0, 1.0]
assert np.sum(way, initial=long).to("m").magnitude == 1603.0
spread = np.std(way, mean=registry.Quantity(1500.0, "mm"))
assert spread.to("m").magnitude > 1498.0
track = unyt.unyt_array([1.0, 2.0], "m")
assert np.diff(track, prepend=unyt.unyt_quantity(900.0, "mm")).to_value("m").tolist() == [-899.0, 1.0]
assert np.sum(track, initial=unyt.unyt_quantity(1600.0, "mm")).to_value("m") == 1603.0
assert np.pad(track, 1, constant_values=unyt.unyt_quantity(1600.0, "mm")).to_value("m")[0] == 1600.0
held = track.copy()
held.fill(unyt.unyt_quantity(1600.0, "mm"))
assert held.to_value("m").tolist() == [1600.0, 1600.0]
gap = unyt.unyt_array([1.0, np.nan], "m")
filled = np.nan_to_num(gap, nan=unyt.unyt_quantity(1600.0, "mm"))
assert np.allclose(filled.to_value("m"), [0.001, 1.6])
theirs = np.diff([1.0, 2.0] * u.m, prepend=900.0 * u.mm)
assert np.allclose(theirs.to_value(u.m), [0.1, 1.0])
assert np.isclose(np.sum([1.0, 2.0] * u.m, initial=1600.0 * u.mm).to_value(u.m), 4.6)
# instead
assert np.allclose(np.diff(way, prepend=short.to("m")).to("m").magnitude, [0.1, 1.0])
print("pint", pint.__version__, "unyt", unyt.__version__, "astropy", astropy.__version__, "numpy", np.__version__)
print("pint: diff", np.diff(way, prepend=short), "sum", np.sum(way, initial=long), "std", spread)
print("unyt: 1 m and NaN with 1600 mm for NaN:", filled)
PROGRAM
