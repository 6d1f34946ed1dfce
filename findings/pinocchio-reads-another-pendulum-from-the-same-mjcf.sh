#!/usr/bin/env bash
# Expected: a file that MuJoCo compiles and Pinocchio reads without a word is one machine in both: same mass matrix, and
#   without friction and springs the same acceleration.
# What happens: five things are read differently, silently: gravity of `option` (always 9.81), masses of geoms that do
#   not collide (left out), `inertiagrouprange` (ignored), an `axisangle` that is no unit vector (a matrix that is no
#   rotation; the pendulum falls 9 times as fast), an `eulerseq` in capitals (as if small).
# Packages: pin 4.1.0, mujoco-core 4.0.0, numpy 2.3.5. Source: found by trying.
# Who is hurt: whoever designs a controller on Pinocchio's model of a robot that is simulated in MuJoCo.
# Instead: compare mass matrices and accelerations once, as below; set model.gravity (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 pin==4.1.0 mujoco-core==4.0.0
"$folder/venv/bin/python" - <<'PROGRAM'
import tempfile

import mujoco
import numpy as np
import pinocchio

ROD = '<geom type="capsule" fromto="0 0 0 0 0 -1" size="0.05" mass="1"/>'
COVER = '<geom type="box" pos="0.3 0 -0.5" size="0.1 0.1 0.1" mass="2" {}/>'


def pendulum(option="", compiler="", body="", more=""):
    return f"""
    <mujoco>
      <compiler angle="radian" {compiler}/>
      <option {option}/>
      <worldbody>
        <body name="rod" pos="0 0 0" {body}>
          <joint name="pivot" type="hinge" axis="0 1 0"/>{ROD}{more}
        </body>
      </worldbody>
    </mujoco>"""


def of_mujoco(text):
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[:] = 0.3
    mujoco.mj_forward(model, data)
    return data.qM[0] if hasattr(data, "qM") else data.M[0], data.qacc[0]


def of_pinocchio(text, gravity=None):
    with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
        file.write(text)
        file.flush()
        model = pinocchio.buildModelFromMJCF(file.name)
    if gravity is not None:
        model.gravity.linear = np.array(gravity)
    data = model.createData()
    angle = np.full(model.nq, 0.3)
    zero = np.zeros(model.nv)
    inertia = pinocchio.crba(model, data, angle)[0, 0]
    return inertia, pinocchio.aba(model, data, angle, zero, zero)[0], model


agree = {
    "plain": pendulum(),
    "a second geom": pendulum(more=COVER.format("")),
    "unit axisangle": pendulum(body='axisangle="0.6 0 0.8 0.5"'),
    "eulerseq zyx": pendulum(compiler='eulerseq="zyx"', body='euler="0.1 0.4 0.3"'),
}
differ = {
    "gravity of the moon": pendulum(option='gravity="0 0 -1.62"'),
    "a cover that does not collide": pendulum(more=COVER.format('contype="0" conaffinity="0"')),
    "inertiagrouprange": pendulum(compiler='inertiagrouprange="0 1"', more=COVER.format('group="2"')),
    "axisangle of length 3.7": pendulum(body='axisangle="1 2 3 0.5"'),
    "eulerseq XYZ": pendulum(compiler='eulerseq="XYZ"', body='euler="0.1 0.4 0.3"'),
}
print("pinocchio", pinocchio.__version__, "mujoco", mujoco.__version__, "numpy", np.__version__)
for name, text in (agree | differ).items():
    one, other = of_mujoco(text), of_pinocchio(text)
    same = np.allclose(one, other[:2], rtol=1e-6)
    print(f"{name:30s} MuJoCo {one[0]:.3f} kg m^2, {one[1]:+.3f} rad/s^2;",
          f"Pinocchio {other[0]:.3f}, {other[1]:+.3f}")
    assert same == (name in agree), name
turned = of_pinocchio(differ["axisangle of length 3.7"])[2].jointPlacements[1].rotation
assert np.abs(turned @ turned.T - np.eye(3)).max() > 1
moon = differ["gravity of the moon"]
assert np.allclose(of_mujoco(moon), of_pinocchio(moon, (0, 0, -1.62))[:2])
PROGRAM
