#!/usr/bin/env bash
# Expected: `linearize` at rest gives the slope of the friction law, as automatic or central differences do.
# What happens: it takes the chord over eps=1e-6, forwards, in each state's own unit: of tanh(v / vs) with vs = 1 um/s
#   the damping is 0.76 of the right one, with 0.1 um/s 0.10; a magnet over a gap of 10 um has 0.87 of its negative
#   stiffness, over 1 um 0.38. All signs are right. No warning.
# Package: control 0.10.2, numpy 2.4.6. Source: eps=1e-6 is documented.
# Who is hurt: whoever designs a controller about rest, or about a gap, of a small machine in SI units.
# Instead: eps=1e-5 of the scale (tried), or states in scaled units (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 control==0.10.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import control
import numpy as np

warnings.simplefilter("error")
print("control", control.__version__, "numpy", np.__version__)


def damping(sharp, unit=1.0, **options):
    """The slope of dry friction at rest over the right one, with the velocity in `unit` m/s."""
    def motion(t, state, push, parameters):
        return [(-np.tanh(state[0] * unit / sharp) + push[0]) / unit]

    block = control.nlsys(motion, None, inputs=1, outputs=1, states=1)
    return float(-block.linearize([0.0], [0.0], **options).A[0, 0] * sharp)


def stiffness(gap, **options):
    """The slope of a magnet's force 1 / gap^2 at a gap over the right one."""
    plate = control.nlsys(lambda t, x, u, p: [(gap / x[0]) ** 2 + u[0]], None, inputs=1, outputs=1, states=1)
    return float(-plate.linearize([gap], [0.0], **options).A[0, 0] * gap / 2)


for sharp, right in ((1e-3, 1.0), (1e-5, 1.0), (1e-6, np.tanh(1.0)), (1e-7, 0.1)):
    row = damping(sharp), damping(sharp, eps=1e-5 * sharp), damping(sharp, unit=1e-3 * sharp)
    print(f"friction sharp at {sharp:g} m/s: damping {row[0]:.3f} of the right one, with eps {row[1]:.3f}, "
          f"scaled {row[2]:.3f}")
    assert abs(row[0] - right) < 0.01 and abs(row[1] - 1.0) < 1e-3 and abs(row[2] - 1.0) < 1e-3
for gap, right in ((1e-3, 1.0), (1e-5, 0.868), (1e-6, 0.375)):
    row = stiffness(gap), stiffness(gap, eps=1e-5 * gap)
    print(f"gap of {gap:g} m: stiffness {row[0]:.3f} of the right one, with eps {row[1]:.3f}")
    assert abs(row[0] - right) < 0.01 and abs(row[1] - 1.0) < 1e-3
PROGRAM
