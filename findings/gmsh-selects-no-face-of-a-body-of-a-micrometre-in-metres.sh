#!/usr/bin/env bash
# Expected: the bounding box of a cube is the cube, and a box that holds a face with a margin of 1 % selects it, in any unit.
# What happens: with the OpenCASCADE kernel bounding boxes are wider by an absolute 1e-7 on each side: of a cube of 1 um in
#   metres the box is 1.2 um wide, and `getEntitiesInBoundingBox`, which compares boxes, finds neither the face at z = 0
#   nor the body itself with a margin of 1 %; in millimetres and in micrometres it finds them. A boundary condition then
#   has an empty group. Volumes are right. No warning.
# Package: gmsh 4.15.2, numpy 2.4.6. Source: found by trying; the API's page of both functions names no margin.
# Who is hurt: whoever meshes a small gripper, a gap or a coating in SI and names its faces by their place.
# Instead: model in micrometres, or take a margin above 1e-7 (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check numpy==2.4.6 gmsh==4.15.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import gmsh
import numpy as np

print(*(f"{name} {version(name)}" for name in ("gmsh", "numpy")))
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)


def selected(side, margin):
    """A cube: its volume and width, in sides, and how many faces at z = 0 and bodies a box with a margin holds."""
    gmsh.clear()
    body = gmsh.model.occ.addBox(0, 0, 0, side, side, side)
    gmsh.model.occ.synchronize()
    box = np.array(gmsh.model.getBoundingBox(3, body)) / side
    low, high = -margin, side + margin
    faces = gmsh.model.getEntitiesInBoundingBox(low, low, low, high, high, margin, 2)
    bodies = gmsh.model.getEntitiesInBoundingBox(low, low, low, high, high, high, 3)
    return gmsh.model.occ.getMass(3, body) / side**3, box[3] - box[0], len(faces), len(bodies)


for side, name in ((1.0, "um"), (1e-3, "mm"), (1e-6, "m")):
    volume, width, faces, bodies = selected(side, 0.01 * side)
    print(f"1 um in {name}: volume {volume:.6f}, box {width:.4f} wide, faces {faces}, bodies {bodies}")
    assert abs(volume - 1) < 1e-6 and abs((width - 1) * side - 2e-7) < 1e-9
    assert (faces, bodies) == ((0, 0) if side == 1e-6 else (1, 1))
wide = selected(1e-6, 1.1e-7)
print("in m with a margin of 1.1e-7: faces and bodies", wide[2:])
assert wide[2:] == (1, 1)
gmsh.finalize()
PROGRAM
