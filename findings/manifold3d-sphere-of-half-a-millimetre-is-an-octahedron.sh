#!/usr/bin/env bash
# Expected: `Manifold.sphere`, `cylinder`, `CrossSection.circle` and `revolve` are as round for a radius of 0.5 as of
#   50, or at least of the volume asked for.
# What happens: without a number of segments an edge is at least 1.0 long, in whatever unit: a sphere up to a radius of
#   0.79 is an octahedron with 0.32 of the volume, a cylinder a square bar with 0.64; at 1.0 it is 0.70 and 0.90, at 5
#   0.98 and 0.99. Rounded corners of `offset` are cut straight. A body of 0.5 mm is hurt in mm and in m. No warning.
# Package: manifold3d 3.5.4, numpy 2.4.6. Source: the least edge is documented at `set_min_circular_edge_length`.
# Who is hurt: whoever builds a small robot or its tools for a mass, a buoyancy or a contact.
# Instead: circular_segments for each body, or set_min_circular_edge_length once (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 manifold3d==3.5.4
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from manifold3d import CrossSection, JoinType, Manifold, set_min_circular_edge_length

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("manifold3d", "numpy")))


def shares(radius, *segments):
    """Volume or area of a sphere, a cylinder, a circle and a ring, over the right one."""
    ring = CrossSection.square((radius, radius)).revolve(*segments)
    return np.array([
        Manifold.sphere(radius, *segments).volume() / (4 / 3 * np.pi * radius**3),
        Manifold.cylinder(radius, radius, radius, *segments).volume() / (np.pi * radius**3),
        CrossSection.circle(radius, *segments).area() / (np.pi * radius**2),
        ring.volume() / (np.pi * radius**3)])


print("share of the right volume: sphere, cylinder, circle, body of revolution")
for radius, expected in ((0.0005, (0.32, 0.64)), (0.5, (0.32, 0.64)), (0.79, (0.32, 0.64)), (1.0, (0.70, 0.90)),
                         (5.0, (0.98, 0.99))):
    found = shares(radius)
    print(f"radius {radius:g}: {found.round(3)}")
    assert np.allclose(found[:2], expected, atol=0.006) and np.allclose(found[1:], found[1], atol=1e-6)
    assert Manifold.sphere(radius).num_tri() == 8 or radius >= 1.0
plate = CrossSection.square((4.0, 4.0)).offset(0.5, JoinType.Round).area() - 4.0**2 - 4 * 4.0 * 0.5
print(f"four corners rounded by 0.5: {plate:.3f} for {np.pi * 0.25:.3f}, a bevel is 0.5")
assert abs(plate - 0.5) < 1e-6

print(f"radius 0.5 with 64 segments: {shares(0.5, 64).round(3)}")
assert np.all(shares(0.5, 64) > 0.99)
set_min_circular_edge_length(1e-6)
print(f"radius 0.0005 after set_min_circular_edge_length(1e-6): {shares(0.0005).round(3)}")
assert np.all(shares(0.0005) > 0.98)
PROGRAM
