#!/usr/bin/env bash
# Expected: a program in double precision takes a steel plate of 0.4 x 0.2 x 0.05 mm in SI units. Its mass of 3e-8 kg is
#   no trouble in floating point.
# What happens: the model does not compile: the least moment of inertia is 1e-15 in whatever units, and the plate has
#   1e-16 to 5e-16 kg m^2. In mm, mg and ms (gravity 0.00981) it compiles and falls as it should.
# Package: mujoco-core 4.0.0. Source: found by trying; the XML reference gives the limit as
#   1e-14, the header as 1e-15.
# Who is hurt: whoever simulates bodies below about half a millimetre "in SI throughout".
# Instead: mm, mg, ms (tried); forces are then in mN, and time constants of contacts in ms, too.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 mujoco-core==4.0.0
"$folder/venv/bin/python" - <<'PROGRAM'
import mujoco
import numpy as np


def model(length, mass, gravity, step):
    size = [half * length for half in (0.2e-3, 0.1e-3, 0.025e-3)]
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <option timestep="{step}" gravity="0 0 {-gravity}"/>
      <worldbody>
        <body><freejoint/><geom type="box" size="{size[0]} {size[1]} {size[2]}"
          density="{7800 * mass / length ** 3}"/></body>
      </worldbody>
    </mujoco>""")


try:
    model(1.0, 1.0, 9.81, 1e-5)
except ValueError as error:
    said = str(error)
else:
    raise SystemExit("it compiles in SI now")
small = model(1e3, 1e6, 9.81e-3, 1e-2)  # mm, mg, mm/ms^2, ms
data = mujoco.MjData(small)
for _ in range(100):
    mujoco.mj_step(small, data)
fallen = -data.qpos[2] * 1e-3  # m in 1 ms
assert abs(fallen / (0.5 * 9.81 * 1e-3**2) - 1) < 0.02
print("mujoco", mujoco.__version__, "numpy", np.__version__, "mjMINVAL", mujoco.mjMINVAL)
print("in SI:", said.splitlines()[0])
inertia = small.body_inertia[1] * 1e-12
print("in mm, mg, ms: compiles; the inertia in SI is", *(f"{value:.1e}" for value in inertia), "kg m^2")
PROGRAM
