#!/usr/bin/env bash
# Expected: a block on a plane with a friction of 0.5 slides once it is pushed by more than 0.5 of its weight, whatever
#   the direction; two bodies with a restitution of 0.9 bounce with 0.9.
# What happens: friction is a box of two axes of the world: along x the limit is right, along a diagonal 1.41 times as
#   large: a push of 1.3 times the limit holds, and a block thrown along it stops after 0.70 of the way. Friction is the
#   smaller of the two bodies', but restitution their product: from 1 m it is back at 0.66 m for 0.81 m. No warning.
# Package: dartpy 6.20.0, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever steers a sliding robot in the plane, or fits a friction from a path that turns.
# Instead: the root of the restitution (tried); for friction an engine with a round cone, as MuJoCo's elliptic one.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 dartpy==6.20.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import dartpy
import numpy as np

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("dartpy", "numpy")))
WEIGHT, SIZE, STEP = 9.81, 0.1, 1e-3


def body(world, joint, size, height, friction, restitution):
    skeleton = dartpy.dynamics.Skeleton(str(size))
    joint, node = getattr(skeleton, joint)()
    shape = node.createShapeNode(dartpy.dynamics.BoxShape(size))
    shape.createCollisionAspect()
    surface = shape.createDynamicsAspect()
    surface.setFrictionCoeff(friction)
    surface.setRestitutionCoeff(restitution)
    inertia = dartpy.dynamics.Inertia()
    inertia.setMass(1.0)
    inertia.setMoment(np.eye(3) * SIZE**2 / 6)
    node.setInertia(inertia)
    place = dartpy.math.Isometry3()
    place.set_translation([0.0, 0.0, height])
    joint.setTransformFromParentBodyNode(place)
    world.addSkeleton(skeleton)
    return skeleton, node


def run(seconds, push=(0.0, 0.0), speed=(0.0, 0.0), height=0.0, friction=(0.5, 0.5), restitution=0.0):
    """Positions over ground and heights of a block of 1 kg."""
    world = dartpy.simulation.World()
    world.setTimeStep(STEP)
    world.setGravity([0.0, 0.0, -WEIGHT])
    body(world, "createWeldJointAndBodyNodePair", [10.0, 10.0, SIZE], -SIZE / 2, friction[0], restitution)
    block, node = body(world, "createFreeJointAndBodyNodePair", [SIZE] * 3, SIZE / 2 + height, friction[1], restitution)
    block.setVelocities([0.0, 0.0, 0.0, *speed, 0.0])
    places = []
    for _ in range(round(seconds / STEP)):
        node.setExtForce([*push, 0.0])
        world.step()
        places.append(block.getPositions()[3:])
    return np.array(places)


def way(angle, size, **options):
    name = next(iter(options))
    along = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    return float(run(1.0, **{name: options[name] * along}, **size)[-1, :2] @ along)


for share, angle, slides in ((0.9, 0, False), (1.1, 0, True), (1.1, 45, False), (1.3, 45, False), (1.5, 45, True)):
    found = way(angle, {}, push=share * 0.5 * WEIGHT)
    print(f"pushed with {share:g} of the limit at {angle} degrees: {1e3 * found:.4g} mm in 1 s")
    assert (found > 0.01) == slides and (slides or found < 1e-6)
right = 1.0 / (2 * 0.5 * WEIGHT)
for angle, share in ((0, 1.0), (45, 0.71)):
    found = way(angle, {}, speed=1.0)
    print(f"thrown with 1 m/s at {angle} degrees: {1e3 * found:.1f} mm for {1e3 * right:.1f} mm")
    assert abs(found / right - share) < 0.02
least = way(0, {"friction": (0.2, 0.8)}, speed=1.0)
print(f"friction of 0.2 and 0.8 is {1.0 / (2 * least * WEIGHT):.2f}")
assert abs(1.0 / (2 * least * WEIGHT) - 0.2) < 0.01
for restitution, expected in ((0.9, 0.66), (0.9**0.5, 0.81)):
    heights = run(1.1, height=1.0, restitution=restitution)[:, 2]
    back = heights[np.argmin(heights):].max() + 1.0
    print(f"restitution of both {restitution:.3f}: from 1 m back to {back:.2f} m")
    assert abs(back - expected) < 0.01
PROGRAM
