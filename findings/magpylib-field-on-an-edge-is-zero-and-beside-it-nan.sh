#!/usr/bin/env bash
# Expected: on the edge of a magnet the field is large, infinite or nan, and one rounding beside it large.
# What happens: on an edge or a corner B is exactly (0, 0, 0), though edges count as inside, so H is minus the
#   magnetization. A last bit beside the edge B is nan. On a wire B is 0, too, and 2e5 T at 1e-12 m from a 1 m loop of 1
#   A. On a face B is that of the inner side: the tangential part jumps across.
# Packages: magpylib 6.3.0, scipy 1.17.1, numpy 2.3.5. Source: found by trying.
# Who is hurt: whoever lays a regular grid over a magnet: zeros pass every check for finite values, and leave holes in a
#   map.
# Instead: shift the grid by a part of its spacing (tried), or mask points within that of a face or edge.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 magpylib==6.3.0
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import magpylib
import numpy as np
import scipy

warnings.simplefilter("ignore")
magnet = magpylib.magnet.Cuboid(dimension=(2, 2, 2), polarization=(0.3, 0.2, 1))
mu0 = magpylib.mu_0
for place in ((1, 1, 0), (1, -1, 0.3), (1, 1, 1), (-1, -1, -1)):
    assert np.all(magnet.getB(place) == 0)
    assert np.allclose(magnet.getH(place) * mu0, (-0.3, -0.2, -1))
beside = magnet.getB((1, 0.999999999999, 0))
assert np.all(np.isnan(beside))
near = magnet.getB((1.001, 0.999, 0))
assert np.all(np.isfinite(near)) and np.linalg.norm(near) > 0.3
face = [magnet.getB((0, 0, 1 + shift)) for shift in (-1e-9, 0, 1e-9)]
assert np.allclose(face[1], face[0], atol=1e-6)
assert abs(face[1][0] - face[2][0]) > 0.25
loop = magpylib.current.Circle(diameter=1, current=1)
assert np.all(loop.getB((0.5, 0, 0)) == 0)
assert np.linalg.norm(loop.getB((0.5, 0, 1e-12))) > 1e5
grid = np.array(np.meshgrid(*[np.linspace(-2, 2, 17)] * 3)).T.reshape(-1, 3)
zeros = np.all(magnet.getB(grid) == 0, axis=1).sum()
shifted = magnet.getB(grid + 0.0371)
assert zeros > 90 and np.all(np.linalg.norm(shifted, axis=1) > 0)
print("magpylib", magpylib.__version__, "scipy", scipy.__version__, "numpy", np.__version__)
print("on an edge:", magnet.getB((1, 1, 0)), "beside it:", beside, "1 mm off:", near.round(3))
print("across a face:", *(field.round(3) for field in face))
print(f"a grid of 17^3 over the magnet has {zeros} points of exactly zero field")
PROGRAM
