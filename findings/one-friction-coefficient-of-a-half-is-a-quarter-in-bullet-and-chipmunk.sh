#!/usr/bin/env bash
# Expected: a block and a floor that both have a friction of 0.5 slide with 0.5 in each engine.
# What happens: Bullet and Chipmunk (pymunk) multiply: 0.25 and 0.1; MuJoCo takes the larger: 0.5 and 0.5. A block that
#   rests on a slope of 0.4 in MuJoCo slides in the others. A floor with no friction given has 0.5 in Bullet.
# Packages: pybullet 3.2.7, pymunk 7.3.1, mujoco 4.0.0. Source: two document their rule; tried.
# Who is hurt: whoever carries a measured coefficient of a pair over. Instead: in Bullet and pymunk it on one body and 1
#   on the other, in MuJoCo on both (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pybullet==3.2.7 pymunk==7.3.1 mujoco==4.0.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import math

import mujoco
import numpy as np
import pybullet as bullet
import pymunk

G, DT, STEPS, SLOPE = 9.81, 1e-3, 1000, 1.5
ALONG, DOWN = (G * math.sin(math.atan(SLOPE)), G * math.cos(math.atan(SLOPE)))


def seen(velocity):
    """Friction coefficient by the velocity after one second."""
    return (ALONG - velocity / (STEPS * DT)) / DOWN


def by_pymunk(block, floor):
    space = pymunk.Space()
    space.gravity = ALONG, -DOWN
    ground = pymunk.Segment(space.static_body, (-1000, 0), (1000, 0), 0)
    body = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (4, 1)))
    shape = pymunk.Poly.create_box(body, (4, 1))
    body.position = 0, 0.5
    ground.friction, shape.friction = floor, block
    space.add(ground, body, shape)
    for _ in range(STEPS):
        space.step(DT)
    return seen(body.velocity.x)


def by_bullet(block, floor=None):
    bullet.resetSimulation()
    bullet.setGravity(ALONG, 0, -DOWN)
    bullet.setTimeStep(DT)
    made = [bullet.createMultiBody(mass, bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=size),
                                   basePosition=[0, 0, z])
            for mass, size, z in ((0.0, [500, 500, 1], -1.0), (1.0, [2, 2, 0.5], 0.5))]
    bullet.changeDynamics(made[1], -1, lateralFriction=block, linearDamping=0, angularDamping=0)
    if floor is not None:
        bullet.changeDynamics(made[0], -1, lateralFriction=floor)
    for _ in range(STEPS):
        bullet.stepSimulation()
    return seen(bullet.getBaseVelocity(made[1])[0][0])


def by_mujoco(block, floor):
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><option timestep="{DT}" gravity="{ALONG} 0 {-DOWN}"
        cone="elliptic" impratio="100"/><worldbody><geom type="plane" size="500 500 1" friction="{floor}"/><body
        pos="0 0 0.5"><freejoint/><geom type="box" size="2 2 0.5" mass="1" friction="{block}"/></body></worldbody>
        </mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, STEPS)
    return seen(data.qvel[0])


bullet.connect(bullet.DIRECT)
print("pybullet", bullet.getAPIVersion(), "pymunk", pymunk.version, "mujoco", mujoco.__version__)
print("numpy", np.__version__)
for block, floor in ((0.5, 0.5), (0.5, 0.2), (0.4, 1.0)):
    found = [engine(block, floor) for engine in (by_bullet, by_pymunk, by_mujoco)]
    print(f"{block} on {floor}: Bullet {found[0]:.3f}, pymunk {found[1]:.3f}, MuJoCo {found[2]:.3f}")
    assert np.allclose(found[:2], block * floor, atol=0.01)
    assert abs(found[2] - max(block, floor)) < 0.02
alone = by_bullet(0.4)
print(f"Bullet, 0.4 on a floor that has none given: {alone:.3f}")
assert abs(alone - 0.2) < 0.01
# instead
assert abs(by_mujoco(0.4, 0.4) - 0.4) < 0.02
PROGRAM
