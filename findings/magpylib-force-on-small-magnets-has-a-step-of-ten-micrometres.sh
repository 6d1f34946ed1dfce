#!/usr/bin/env bash
# Expected: the force between two magnets goes with the square of their size when all lengths shrink alike, and a
#   library in SI that asks for no step gets this right at every size.
# What happens: the gradient is a difference over eps = 1e-5 m, absolute. The pull of two cubes at a gap of a tenth of
#   their side is 4 % too strong at 0.1 mm and 23 % at 0.01 mm; on a dipole it is 60 % too weak, without a warning.
# Packages: magpylib 6.3.0, scipy 1.17.1, numpy 2.3.5. Source: the docstring of getFT recommends that eps; the default
#   is for magnets of a metre.
# Who is hurt: whoever computes forces on magnetic micro-robots, beads or thin films.
# Instead: eps = 1e-5 times the size of the magnet (tried: equal at all sizes to eight digits).
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


def pull(size, target, **options):
    source = magpylib.magnet.Cuboid(dimension=(size,) * 3, polarization=(0, 0, 1))
    if target == "cube":
        body = magpylib.magnet.Cuboid(
            dimension=(size,) * 3, polarization=(0, 0, 1), position=(0, 0, 1.1 * size)
        )
        force, _ = magpylib.getFT(source, body, meshing=(6, 6, 6), **options)
    else:
        body = magpylib.misc.Dipole(
            moment=(0, 0, size**3 / magpylib.mu_0), position=(0, 0, 0.7 * size)
        )
        force, _ = magpylib.getFT(source, body, **options)
    return force[2] / size**2


print("magpylib", magpylib.__version__, "scipy", scipy.__version__, "numpy", np.__version__)
seen = {}
for target in ("cube", "dipole"):
    true = pull(1.0, target)
    for size in (1e-2, 1e-3, 1e-4, 1e-5):
        seen[target, size] = pull(size, target) / true - 1
        assert abs(pull(size, target, eps=1e-5 * size) / true - 1) < 1e-6
        print(f"{target:6s} {size * 1e3:g} mm: off by {seen[target, size]:+.1e}")
assert abs(seen["cube", 1e-4] - 0.040) < 0.001 and abs(seen["cube", 1e-5] - 0.23) < 0.01
assert abs(seen["dipole", 1e-5] + 0.60) < 0.01
assert abs(seen["cube", 1e-2]) < 1e-5
PROGRAM
