#!/usr/bin/env bash
# Expected: mjd_transitionFD of two slides on springs gives A with rows near (1, 0.001), whether or not one spring may
#   yield (springyield, new in 4.0) one day; its step eps changes the last digits.
# What happens: with springyield on one joint, not yet reached, the row of its position holds numbers of 1e4 that grow
#   as 1 / eps; the other rows are right. Differences of mj_step by hand are right.
# Package: mujoco-core 4.0.0. Source: found by trying; the state vector has a new part, mjSTATE_PLASTIC, since 4.0.
# Who is hurt: LQR, iLQR and MPC on a model with a plastic joint: gains from noise, without a warning.
# Instead: differences of your own, with mj_getState and mj_setState of mjSTATE_INTEGRATION (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 mujoco-core==4.0.0
"$folder/venv/bin/python" - <<'PROGRAM'
import mujoco
import numpy as np


def matrices(springyield, eps):
    limit = f'springyield="{springyield}"' if springyield else ""
    model = mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <option timestep="0.001" gravity="0 0 0"/>
      <worldbody>
        <body><joint type="slide" axis="1 0 0" stiffness="100" {limit}/><geom size="0.1" mass="1"/></body>
        <body pos="0 9 0"><joint type="slide" axis="1 0 0" stiffness="100"/><geom size="0.1" mass="1"/></body>
      </worldbody>
    </mujoco>""")
    data = mujoco.MjData(model)
    data.qvel[:] = 1.0, 2.0
    for _ in range(20):
        mujoco.mj_step(model, data)
    n = 2 * model.nv
    given = np.zeros((n, n))
    mujoco.mjd_transitionFD(model, data, eps, True, given, None, None, None)
    part = mujoco.mjtState.mjSTATE_INTEGRATION
    state = np.zeros(mujoco.mj_stateSize(model, part))
    mujoco.mj_getState(model, data, state, part)
    own = np.zeros((n, n))
    for column in range(n):
        ends = []
        for sign in (1, -1):
            mujoco.mj_setState(model, data, state, part)
            moved = data.qpos if column < model.nv else data.qvel
            moved[column % model.nv] += sign * eps
            mujoco.mj_step(model, data)
            ends.append(np.concatenate([data.qpos, data.qvel]))
        own[:, column] = (ends[0] - ends[1]) / (2 * eps)
    return given, own


print("mujoco", mujoco.__version__, "numpy", np.__version__)
for springyield in (None, 0.1):
    for eps in (1e-4, 1e-6):
        given, own = matrices(springyield, eps)
        worst = np.abs(given - own).max(axis=1)
        print(f"springyield {springyield}, eps {eps:g}: largest error of each row",
              *(f"{value:.0e}" for value in worst))
        if springyield is None:
            assert worst.max() < 1e-6
        else:
            assert worst[0] > 0.001 / eps and worst[1:].max() < 1e-6
        assert np.allclose(own[0], (0.9999, 0, 0.001, 0), atol=1e-6)
PROGRAM
