#!/usr/bin/env bash
# Expected: a ball with a restitution of 0.9 bounces to 0.81 of the height it fell from, whatever that is.
# What happens: Box2D takes each impact slower than 1 m/s as one without bounce, PhysX of SAPIEN slower than 2 m/s, which
#   are falls of 5 and 20 cm: the ball stays where it lands, or creeps out of the floor by a millimetre. From 0.5 and 1 m it is
#   right in both. Restitution is kept and read back as 0.9, no warning.
# Package: Box2D 2.3.10, sapien 3.0.3. Source: a constant of Box2D 2, `bounce_threshold` of SAPIEN, both in m/s.
# Who is hurt: whoever simulates hopping, shaking or tapping robots of centimetres in metres.
# Instead: PhysX: physx.set_scene_config(bounce_threshold=0.01) before the scene (tried); Box2D: lengths in mm (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check --only-binary :all: \
    numpy==2.4.6 Box2D==2.3.10 sapien==3.0.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

from Box2D import b2World

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import sapien
print("Box2D", version("Box2D"), "sapien", version("sapien"))


def box2d(height, unit=1.0):
    """How high a ball of 2 cm bounces at its first impact, in metres; `unit` is the length of the world in metres."""
    world = b2World(gravity=(0.0, -9.81 / unit))
    floor = world.CreateStaticBody().CreateEdgeFixture(vertices=[(-10 / unit, 0.0), (10 / unit, 0.0)], restitution=0.9)
    ball = world.CreateDynamicBody(position=(0.0, (0.02 + height) / unit))
    ball.CreateCircleFixture(radius=0.02 / unit, density=1.0, restitution=0.9)
    assert abs(floor.restitution - 0.9) < 1e-6
    start, rising, top = (2 * height / 9.81) ** 0.5, False, 0.0
    for count in range(int(2.8 * start / 1e-4)):
        world.Step(1e-4, 8, 3)
        rising = rising or ball.linearVelocity.y > 0.05 / unit
        if rising:
            top = max(top, ball.position.y * unit - 0.02)
    return top


def physx(height):
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(1e-4)
    surface = sapien.physx.PhysxMaterial(0.5, 0.5, 0.9)
    scene.add_ground(0.0, render=False, material=surface)
    builder = scene.create_actor_builder()
    builder.add_sphere_collision(radius=0.02, material=surface)
    ball = builder.build()
    ball.set_pose(sapien.Pose([0.0, 0.0, 0.02 + height]))
    body = ball.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
    start, rising, top = (2 * height / 9.81) ** 0.5, False, 0.0
    for count in range(int(2.8 * start / 1e-4)):
        scene.step()
        rising = rising or body.linear_velocity[2] > 0.05
        if rising:
            top = max(top, float(ball.pose.p[2]) - 0.02)
    return top


heights = (0.01, 0.04, 0.1, 0.5, 1.0)
ratio = {}
for name, engine in (("Box2D in m", box2d), ("Box2D in mm", lambda height: box2d(height, 1e-3)), ("PhysX", physx)):
    for height in heights:
        ratio[name, height] = engine(height) / height
sapien.physx.set_scene_config(bounce_threshold=0.01)
for height in heights:
    ratio["PhysX, threshold 0.01", height] = physx(height) / height
for name in dict.fromkeys(name for name, _ in ratio):
    print(f"{name}:", ", ".join(f"{height:g} m: {ratio[name, height]:.2f}" for height in heights), "of the fall")
for height in heights:
    assert all(abs(ratio[name, height] - 0.81) < 0.05 for name in ("Box2D in mm", "PhysX, threshold 0.01")), height
    assert ratio["Box2D in m", height] < 0.05 if height < 0.05 else ratio["Box2D in m", height] > 0.75
    assert ratio["PhysX", height] < 0.05 if height < 0.2 else ratio["PhysX", height] > 0.75
PROGRAM
