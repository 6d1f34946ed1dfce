#!/usr/bin/env bash
# Expected: `points.interpolate(map)` of a measured field map gives about the field of the nearest nodes at each point,
#   and none outside of it; metres or millimetres make no difference.
# What happens: it is a mean with Gauss's weights within a radius of 1.0, whatever the unit. In a map in metres (11^3
#   nodes 1 mm apart) all nodes count: 2.5 mT a quarter way between nodes is read as 0.0002 mT; on nodes it is exact, so
#   a check there passes. In millimetres it is 1.19 mT; of nodes 2.5 mm apart 0. `sample`, linear, is 0 outside. No
#   warning.
# Package: pyvista 0.49.1 (vtk 9.7.2). Source: the radius is documented. Who is hurt: users of measured field maps.
# Instead: `sample`, and NaN where vtkValidPointMask is 0 (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 vtk==9.7.2 pyvista==0.49.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import pyvista as pv
import vtk

warnings.simplefilter("error", UserWarning)
GRADIENT = 10.0  # T/m
POINTS = np.array([[4e-3, 0.0, 0.0], [0.25e-3, 0.0, 0.0], [2.5e-3, 0.5e-3, 0.0], [9e-3, 0.0, 0.0]])  # m
TRUE = 1e3 * GRADIENT * POINTS[:, 0]  # mT; the last is outside


def field_map(step, unit):
    """Map of 10 mm each way, in units of `unit` metres."""
    n = round(10e-3 / step) + 1
    grid = pv.ImageData(dimensions=(n, n, n), spacing=(step / unit,) * 3, origin=(-5e-3 / unit,) * 3)
    grid["B"] = 1e3 * GRADIENT * unit * grid.points[:, 0]
    return grid


metres, millimetres, coarse = field_map(1e-3, 1.0), field_map(1e-3, 1e-3), field_map(2.5e-3, 1e-3)
seen = {
    "interpolate, m": pv.PolyData(POINTS).interpolate(metres)["B"],
    "interpolate, mm": pv.PolyData(POINTS * 1e3).interpolate(millimetres)["B"],
    "interpolate, mm, nodes 2.5 mm apart": pv.PolyData(POINTS * 1e3 + [0.0, 1.25, 1.25]).interpolate(coarse)["B"],
    "sample, m": pv.PolyData(POINTS).sample(metres)["B"],
}
print("pyvista", pv.__version__, "vtk", vtk.vtkVersion.GetVTKVersion(), "numpy", np.__version__)
print("true, mT:", TRUE.round(4).tolist())
for name, field in seen.items():
    print(f"{name}: {np.round(field, 4).tolist()}")
bare = seen["interpolate, m"]
assert abs(bare[0] - TRUE[0]) < 1e-3  # on a node
assert abs(bare[1]) < 1e-3 and abs(bare[2]) < 1e-2 and abs(bare[3]) < 0.1
assert abs(seen["interpolate, mm"][1] - 1.19) < 0.02
assert np.all(seen["interpolate, mm, nodes 2.5 mm apart"] == 0.0)
assert np.allclose(seen["sample, m"][:3], TRUE[:3]) and seen["sample, m"][3] == 0.0
# instead
linear = pv.PolyData(POINTS).sample(metres)
field = np.where(linear["vtkValidPointMask"] == 1, linear["B"], np.nan)
assert np.allclose(field[:3], TRUE[:3]) and np.isnan(field[3])
PROGRAM
