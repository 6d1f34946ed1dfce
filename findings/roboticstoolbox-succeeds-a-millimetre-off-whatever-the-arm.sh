#!/usr/bin/env bash
# Expected: a solution of the inverse kinematics with success=True is right to micrometres, the more so on a small arm.
# What happens: `ikine_LM` ends where half of the summed squares of metres and radians is below tol=1e-6, that is within
#   1.4 mm or 1.4 mrad: arms with links of 1 m and of 5 mm are both up to 1.3 mm off, with success, 0.2 to 0.7 mm in the
#   middle; on the arm of 5 mm most searches return their start after no step. A Puma is up to 0.8 mm off. No warning.
# Package: roboticstoolbox-python 1.5.0, numpy 2.4.6. Source: tol is documented, its unit and its square are not.
# Who is hurt: whoever plans for arms of centimetres, or differences steps of an arm to velocities.
# Instead: tol=1e-14, one or two steps more, 0.15 um (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 spatialmath-python==1.1.18 spatialgeometry==1.4.2 robot_descriptions==2.0.0 \
    roboticstoolbox-python==1.5.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
from roboticstoolbox import DHRobot, RevoluteDH

print(*(f"{name} {version(name)}" for name in ("roboticstoolbox-python", "spatialmath-python", "numpy")))


def misses(link, tol, poses=30):
    """Distances of the tip from where it was sent, in um, and how many searches took no step at all."""
    arm = DHRobot([RevoluteDH(d=link, alpha=np.pi / 2), RevoluteDH(a=link), RevoluteDH(a=0.8 * link)])
    chance = np.random.default_rng(0)
    distances, still = [], 0
    for pose in range(poses):
        joints = chance.uniform(0.3, 1.0, 3)
        target = arm.fkine(joints)
        start = joints + chance.uniform(-0.2, 0.2, 3)
        found = arm.ikine_LM(target, q0=start, mask=[1, 1, 1, 0, 0, 0], tol=tol)
        assert found.success
        distances.append(1e6 * float(np.linalg.norm(arm.fkine(found.q).t - target.t)))
        still += bool(np.allclose(found.q, start))
    return max(distances), float(np.median(distances)), still


for link in (1.0, 0.1, 0.02, 0.005):
    (most, middle, still), (most_14, _, still_14) = misses(link, 1e-6), misses(link, 1e-14)
    print(f"links of {1e3 * link:g} mm: up to {most:.0f} um off, median {middle:.0f} um, {still} of 30 return their "
          f"start; tol=1e-14: {most_14:.3f} um, {still_14}")
    assert 900 < most < 1500 and 100 < middle < 1000
    assert most_14 < 0.2 and still_14 == 0
assert still > 15
PROGRAM
