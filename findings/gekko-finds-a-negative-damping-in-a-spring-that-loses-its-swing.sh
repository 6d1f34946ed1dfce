#!/usr/bin/env bash
# Expected: gekko integrates a differential equation to a tolerance between the points of `m.time`, or at least to
#   second order: an undamped spring keeps its swing, and a fit to exact readings finds its damping.
# What happens: by default it makes implicit Euler steps from point to point. With 100 points a turn an undamped spring
#   has 0.67 of its swing after two turns, with 20 0.15. A fit (IMODE 5) of readings with a damping of 0.05 finds
#   0.019, with 50 points a turn -0.012, with 20 -0.10, with a fit that looks right. APPSTATUS is 1.
# Package: gekko 1.3.3, solved locally. Source: NODES and its default are documented; what it does was found by trying.
# Who is hurt: whoever identifies or controls anything that swings.
# Instead: m.options.NODES = 5 (tried: right to 1e-4).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 gekko==1.3.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from gekko import GEKKO

warnings.simplefilter("error")
print("gekko", version("gekko"), "numpy", np.__version__)
turn = 2.0 * np.pi


def swing(points, nodes=None):
    model = GEKKO(remote=False)
    model.time = np.linspace(0.0, 2 * turn, 2 * points + 1)
    place, speed = model.Var(1.0), model.Var(0.0)
    model.Equations([place.dt() == speed, speed.dt() == -place])
    model.options.IMODE = 4
    if nodes:
        model.options.NODES = nodes
    model.solve(disp=False)
    assert model.options.APPSTATUS == 1
    return np.hypot(place.value[-1], speed.value[-1])


def fit(points, share=0.05, nodes=None):
    time = np.linspace(0.0, 3 * turn, 3 * points + 1)
    own = np.sqrt(1.0 - share**2)
    readings = np.exp(-share * time) * (np.cos(own * time) + share / own * np.sin(own * time))
    model = GEKKO(remote=False)
    model.time = time
    damping, stiffness = model.FV(0.02, lb=-1.0, ub=2.0), model.FV(1.1, lb=0.1, ub=5.0)
    damping.STATUS = stiffness.STATUS = 1
    place, speed = model.CV(readings), model.Var(0.0)
    place.FSTATUS = 1
    model.Equations([place.dt() == speed, speed.dt() == -stiffness * place - 2.0 * damping * speed])
    model.options.IMODE, model.options.EV_TYPE = 5, 2
    if nodes:
        model.options.NODES = nodes
    model.solve(disp=False)
    assert model.options.APPSTATUS == 1
    return damping.NEWVAL, stiffness.NEWVAL


for points, left, found in ((20, 0.152, -0.102), (50, None, -0.012), (100, 0.674, 0.019)):
    size, (damping, stiffness) = swing(points), fit(points)
    print(f"{points} points a turn: undamped spring after two turns {size:.3f}; damping found {damping:.3f} for 0.05, "
          f"stiffness {stiffness:.3f} for 1")
    assert left is None or abs(size - left) < 0.002
    assert abs(damping - found) < 0.002 and abs(stiffness - 1.0) < 0.03
    # instead
    again = fit(points, nodes=5)
    assert abs(again[0] - 0.05) < 1e-4 and abs(swing(points, nodes=5) - 1.0) < 1e-3
PROGRAM
