#!/usr/bin/env bash
# Expected: `trimesh.creation.cylinder(radius, height)` is a cylinder in any unit.
# What happens: faces whose area is below 1e-8 are left out. Of 0.1 mm by 0.5 mm in metres none is left: the volume is
#   0, the centre of mass nan, and `is_watertight` True. Of 0.3 mm by 1.5 mm the ends are gone. uv_sphere is empty at a
#   radius of 1 mm, capsules lose their caps at 1 mm, torus, cone and annulus go as well; box and icosphere stay. No
#   warning.
# Package: trimesh 5.2.0. Source: found by trying; the area is compared with a constant of its module for lengths.
# Who is hurt: whoever makes small robots' shapes, masses and inertias in SI units.
# Instead: make it in millimetres and apply_scale(1e-3): volume and inertia are then right (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 shapely==2.1.2 networkx==3.6.1 trimesh==5.2.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import trimesh
from trimesh.creation import box, capsule, cylinder, icosphere, uv_sphere

warnings.simplefilter("error", UserWarning)
warnings.simplefilter("ignore", RuntimeWarning)
shapes = {
    "cylinder": lambda s: cylinder(radius=0.1 * s, height=0.5 * s),
    "uv_sphere": lambda s: uv_sphere(radius=0.1 * s),
    "capsule": lambda s: capsule(radius=0.1 * s, height=0.3 * s),
    "box": lambda s: box((0.25 * s, 0.25 * s, 0.1 * s)),
    "icosphere": lambda s: icosphere(radius=0.1 * s),
}
right = {name: make(1.0) for name, make in shapes.items()}
print("trimesh", version("trimesh"), "numpy", np.__version__)
for scale in (1e-1, 1e-2, 1e-3):
    for name, make in shapes.items():
        seen = make(scale)
        share = seen.volume / scale**3 / right[name].volume
        print(f"{name} of radius {100 * scale:g} mm in metres: {len(seen.faces)} faces of {len(right[name].faces)}, "
              f"{share:.3f} of its volume, watertight {seen.is_watertight}")
        whole = scale == 1e-1 or name in ("box", "icosphere") or (name == "cylinder" and scale == 1e-2)
        assert (len(seen.faces) == len(right[name].faces)) == whole
        assert (abs(share - 1.0) < 1e-9) == whole
        if name == "cylinder" and scale == 1e-3:
            assert len(seen.faces) == 0 and seen.is_watertight and np.isnan(seen.center_mass).all()
        # instead
        scaled = make(1.0)
        scaled.apply_scale(scale)
        assert abs(scaled.volume / scale**3 / right[name].volume - 1.0) < 1e-9
        assert np.allclose(scaled.moment_inertia / scale**5, right[name].moment_inertia, rtol=1e-9, atol=1e-12)
PROGRAM
