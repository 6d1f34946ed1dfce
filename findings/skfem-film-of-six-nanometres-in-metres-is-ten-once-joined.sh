#!/usr/bin/env bash
# Expected: the sum of two meshes has the points of both, and those that coincide, to rounding of floats, once.
# What happens: all coordinates of both are rounded to eight decimals, in any unit: a film of 6 nm on a plate of 200 nm in
#   metres is 10 nm thick once it is joined, and the flow of heat through both 0.80 of the right one; one of 14 nm is
#   10 nm, too, with a flow of 1.20; of two plates with steps of 15 nm the nodes move by a third of a step. In micrometres
#   and millimetres all is right, and so is the film before it is joined. No warning.
# Package: scikit-fem 12.0.2, numpy 2.4.6, scipy 1.17.1. Source: found by trying; the page of meshes says that duplicate
#   nodes are removed.
# Who is hurt: whoever models coatings, gaps and small grippers in SI.
# Instead: the mesh in micrometres, or one tensor mesh with a subdomain for the film (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 meshio==5.3.5 scikit-fem==12.0.2
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PROGRAM'
import logging
from importlib.metadata import version

import numpy as np
import skfem
from skfem.helpers import dot, grad

logging.disable(logging.WARNING)
print(*(f"{name} {version(name)}" for name in ("scikit-fem", "numpy", "scipy")))
CONDUCTS = {"plate": 1.0, "film": 0.05}


def layers(film, unit):
    """A plate of 200 nm and a film on it, in some unit of so many micrometres."""
    wide = np.linspace(0, 0.1, 6) / unit
    plate = skfem.MeshQuad.init_tensor(wide, np.linspace(0, 0.2, 11) / unit)
    return plate, skfem.MeshQuad.init_tensor(wide, np.array([0.2, 0.2 + film]) / unit)


def flow(mesh, is_film):
    """The heat that goes through for one degree, by the law of heat conduction."""
    basis = skfem.Basis(mesh, skfem.ElementQuad1())
    conductivity = np.where(is_film, CONDUCTS["film"], CONDUCTS["plate"])[:, None]
    form = skfem.BilinearForm(lambda u, v, w: w.conductivity * dot(grad(u), grad(v)))
    matrix = form.assemble(basis, conductivity=np.broadcast_to(conductivity, basis.dx.shape))
    height = mesh.p[1].max()
    ends = basis.get_dofs({"top", "bottom"})
    guess = np.where(basis.doflocs[1] == height, 1.0, 0.0)
    heat = skfem.solve(*skfem.condense(matrix, x=guess, D=ends))
    return heat @ matrix @ heat


def joined(film, unit):
    plate, top = layers(film, unit)
    mesh = (plate + top).with_defaults()
    is_film = np.arange(mesh.nelements) >= plate.nelements
    thick = skfem.Basis(mesh, skfem.ElementQuad1()).dx[is_film].sum() / (0.1 / unit) * unit
    alone = skfem.Basis(top, skfem.ElementQuad1()).dx.sum() / (0.1 / unit) * unit
    right = 0.1 / (0.2 / CONDUCTS["plate"] + film / CONDUCTS["film"])
    return thick * 1e3, alone * 1e3, flow(mesh, is_film) / right


for film, expected in ((0.006, 10), (0.014, 10), (0.020, 20)):
    for unit, name in ((1.0, "um"), (1e3, "mm"), (1e6, "m")):
        thick, alone, share = joined(film, unit)
        print(f"film of {film * 1e3:.0f} nm in {name}: alone {alone:.3f} nm, joined {thick:.3f} nm, flow {share:.3f} of the right one")
        assert abs(alone / film / 1e3 - 1) < 1e-6
        if unit == 1e6:
            assert abs(thick - expected) < 1e-3
            assert abs(share - (0.2 + film / 0.05) / (0.2 + expected / 50)) < 1e-3
        else:
            assert abs(thick / film / 1e3 - 1) < 0.003 and abs(share - 1) < 0.003
moved = {}
for step in (20e-9, 15e-9):
    part = skfem.MeshQuad.init_tensor(np.arange(9) * step, np.arange(3) * step)
    both = part + part.translated((8 * step, 0))
    moved[step] = abs(both.p / step - np.round(both.p / step)).max()
assert moved[20e-9] < 1e-6 and abs(moved[15e-9] - 1 / 3) < 0.01
print("nodes moved, in steps of 20 and 15 nm:", *(f"{share:.2f}" for share in moved.values()))
tensor = skfem.MeshQuad.init_tensor(np.linspace(0, 0.1e-6, 6), np.append(np.linspace(0, 0.2e-6, 11), 0.206e-6)).with_defaults()
share = flow(tensor, tensor.p[1][tensor.t].mean(axis=0) > 0.2e-6) * (0.2 + 0.006 / 0.05) / 0.1
print(f"one tensor mesh in m: flow {share:.6f} of the right one")
assert abs(share - 1) < 1e-6
PROGRAM
