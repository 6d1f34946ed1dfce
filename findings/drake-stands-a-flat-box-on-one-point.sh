#!/usr/bin/env bash
# Expected: a box that lies on a half-space with Drake's default contact has as many contacts as it needs (MuJoCo gives
#   four). Loaded to half its friction limit it stays, and a 4 mm box does as a 400 mm box does.
# What happens: one point contact, whose place jumps from corner to corner. The large box trembles at 1 mm/s and more
#   instead of creeping at 0.06 mm/s; the small one turns over the point and after a second its centre is 1.6 mm below
#   the floor. All four discrete contact models tremble.
# Package: drake 1.51.1. Source: found by trying.
# Who is hurt: whoever takes Drake for sliding, walking or stick-slip of flat bodies; the smaller, the more.
# Instead: small spheres at the corners: four contacts, creep of 0.06 mm/s at every size (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 drake==1.51.1
"$folder/venv/bin/python" - <<'PROGRAM'
import logging
from importlib.metadata import version

import numpy as np
from pydrake.all import (
    AddMultibodyPlantSceneGraph, Box, CoulombFriction, DiagramBuilder, DiscreteContactApproximation,
    HalfSpace, RigidTransform, Simulator, SpatialInertia, Sphere,
)

logging.getLogger("drake").setLevel(logging.ERROR)


def slide(half, corners=False, model=DiscreteContactApproximation.kLagged):
    """Height over the floor (in half heights), speed and contacts, after 1 s at half the limit."""
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, 1e-3)
    plant.set_discrete_contact_approximation(model)
    mass = 2000 * 8 * np.prod(half)
    body = plant.AddRigidBody("box", SpatialInertia.SolidBoxWithMass(mass, *(2 * half)))
    rough = CoulombFriction(0.5, 0.5)
    if corners:
        signs = np.array(np.meshgrid([1, -1], [1, -1], [1, -1])).T.reshape(-1, 3)
        for i, sign in enumerate(signs):
            place = RigidTransform(sign * half)
            plant.RegisterCollisionGeometry(body, place, Sphere(1e-7), f"corner{i}", rough)
    else:
        plant.RegisterCollisionGeometry(body, RigidTransform(), Box(*(2 * half)), "box", rough)
    floor = plant.world_body()
    plant.RegisterCollisionGeometry(floor, RigidTransform(), HalfSpace(), "floor", rough)
    angle = np.arctan(0.25)
    pull = [9.81 * np.sin(angle), 0, -9.81 * np.cos(angle)]
    plant.mutable_gravity_field().set_gravity_vector(pull)
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetFreeBodyPose(context, body, RigidTransform([0, 0, half[2]]))
    simulator.AdvanceTo(1.0)
    height = plant.EvalBodyPoseInWorld(context, body).translation()[2] / half[2]
    speed = np.linalg.norm(plant.EvalBodySpatialVelocityInWorld(context, body).translational())
    contacts = plant.get_contact_results_output_port().Eval(context).num_point_pair_contacts()
    return height, speed, contacts


large, small = np.array([0.2, 0.1, 0.05]), np.array([0.002, 0.001, 0.0005])
print("drake", version("drake"), "numpy", np.__version__)
for model in ("kTamsi", "kSap", "kSimilar", "kLagged"):
    height, speed, contacts = slide(large, model=getattr(DiscreteContactApproximation, model))
    print(f"{model:8s} 400 mm box: {contacts} contact, {speed * 1e3:.2f} mm/s, height {height:.3f}")
    assert contacts == 1 and speed > 5e-4
height, speed, contacts = slide(small)
print(f"kLagged    4 mm box: {contacts} contact, {speed * 1e3:.2f} mm/s, height {height:.3f}")
assert contacts == 1 and height < 0
for half in (large, small):
    height, speed, contacts = slide(half, corners=True)
    print(f"corners, {half[0] * 2e3:.0f} mm: {contacts} contacts, {speed * 1e3:.3f} mm/s, height {height:.3f}")
    assert contacts == 4 and abs(speed - 5.77e-5) < 1e-6 and abs(height - 1) < 0.01
PROGRAM
