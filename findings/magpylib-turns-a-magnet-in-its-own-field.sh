#!/usr/bin/env bash
# Expected: getFT gives the torque of the sources on the target. A magnet put among the sources, as in a Collection of
#   the whole scene, adds nothing to its own force and torque, or is refused.
# What happens: its force on itself is zero, but not its torque: the magnet's own field inside is not along its
#   polarization, and J x B of it is summed up. A plate of 4 x 2 x 0.5 m polarised at 45 degrees "feels" 2.9e5 N m of
#   itself; the dipole whose torque was asked for gives 0.011 N m.
# Packages: magpylib 6.3.0, scipy 1.17.1, numpy 2.3.5. Source: found by trying; seen in 6.1 already.
# Who is hurt: whoever computes all forces of an assembly at once, with the same list as sources and targets.
# Instead: take the target out of the sources, or subtract its own share (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 magpylib==6.3.0
"$folder/venv/bin/python" - <<'PROGRAM'
import magpylib
import numpy as np
import scipy

plate = magpylib.magnet.Cuboid(dimension=(4, 2, 0.5), polarization=(0.7, 0, 0.7))
far = magpylib.misc.Dipole(moment=(0, 0, 1e3), position=(30, 0, 5))
cells = {"meshing": (8, 4, 2)}
_, true = magpylib.getFT(far, plate, **cells)
force, own = magpylib.getFT(plate, plate, **cells)
scene = magpylib.Collection(far, plate)
_, counted = magpylib.getFT(scene, plate, **cells)
print("magpylib", magpylib.__version__, "scipy", scipy.__version__, "numpy", np.__version__)
print(f"torque of the dipole {true[1]:.4f} N m; of the plate itself {own[1]:.4g}; of both {counted[1]:.4g}")
assert np.abs(force).max() < 1e-6
assert own[1] > 1e5 and 0.01 < true[1] < 0.012
assert counted[1] > 1e7 * true[1]
field = plate.getB((0.3, 0.2, 0.1))
assert abs(np.cross(plate.polarization, field)[1]) > 0.1  # the origin of it
straight = magpylib.magnet.Cuboid(dimension=(4, 2, 0.5), polarization=(1, 0, 0))
assert np.abs(magpylib.getFT(straight, straight, **cells)[1]).max() < 1e-3
PROGRAM
