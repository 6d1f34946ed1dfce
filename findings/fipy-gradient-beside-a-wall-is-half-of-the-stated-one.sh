#!/usr/bin/env bash
# Expected: where the slope at a wall is stated by `faceGrad.constrain`, `grad` of the cell beside it follows it.
# What happens: `grad` takes the value at the wall as that of the cell, stated slope or not: of a field that rises by 3
#   per metre everywhere it is 3 in all cells and 1.5 in the first and the last, after a solve with a flux stated as
#   well, which itself is right; `faceGrad` is 3 there. `leastSquaresGrad` is 2.4 beside walls, also where their values
#   are stated, where `grad` is right. With finer cells the wrong cells get smaller, not better: on 1000 as on 10.
# Package: fipy 4.0.3, numpy 2.4.6, scipy 1.17.1. Source: found by trying; the page of `grad` says first order.
# Who is hurt: whoever takes a field, a flux or a heating rate from a potential beside an electrode or an isolated wall.
# Instead: `faceGrad` at the wall, or the mean of the faces' slopes of a cell (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 fipy==4.0.3
cd "$folder"
FIPY_SOLVERS=scipy "$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
from fipy import CellVariable, DiffusionTerm, Grid1D

print(*(f"{name} {version(name)}" for name in ("fipy", "numpy", "scipy")))


def slopes(field):
    cell, face = field.grad.value[0], field.faceGrad.value[0]
    return cell, face, field.leastSquaresGrad.value[0]


for number in (10, 1000):
    mesh = Grid1D(nx=number, dx=1.0 / number)
    place = mesh.cellCenters.value[0]
    given = CellVariable(mesh=mesh, value=3.0 * place)
    given.faceGrad.constrain([3.0], mesh.facesLeft)
    given.faceGrad.constrain([3.0], mesh.facesRight)
    solved = CellVariable(mesh=mesh, value=0.0)
    solved.faceGrad.constrain([3.0], mesh.facesLeft)
    solved.constrain(3.0, mesh.facesRight)
    DiffusionTerm(coeff=1.0).solve(var=solved)
    held = CellVariable(mesh=mesh, value=3.0 * place)
    held.constrain(0.0, mesh.facesLeft)
    held.constrain(3.0, mesh.facesRight)
    for name, field in (("slopes stated", given), ("one solved", solved), ("values stated", held)):
        assert np.allclose(field.value, 3.0 * place)
        cell, face, least = slopes(field)
        ends = [0, 1, -2, -1]
        print(f"{number} cells, {name}: grad {cell[ends].round(3)}, faceGrad {face[ends].round(3)}, least {least[ends].round(3)}")
        mean = (face[1:] + face[:-1]) / 2
        assert np.allclose(face, 3.0) and np.allclose(mean, 3.0) and np.allclose(cell[1:-1], 3.0)
        assert np.allclose(least[[0, -1]], 2.4) and np.allclose(least[1:-1], 3.0)
    assert np.allclose(given.grad.value[0][[0, -1]], 1.5)
    assert np.allclose(solved.grad.value[0][[0, -1]], [1.5, 3.0]) and np.allclose(held.grad.value[0], 3.0)
PROGRAM
