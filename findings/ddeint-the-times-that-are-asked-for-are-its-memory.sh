#!/usr/bin/env bash
# Expected: as with `odeint`, the times of a result say where it is read, and steps inside follow the tolerance.
# What happens: the delayed state is a straight line between the times that are asked for, and before the first of them
#   is reached the last value. Of x' = -x(t - 1), x = 1 before 0, the value at 10 is 0.0202; asked every 0.01 it is
#   right to 2e-4 of itself, every 0.1 to 2 %, every 0.5 it is 2.7 times too large. Nothing is said.
# Package: ddeint 0.3.0.
# Who is hurt: whoever simulates a loop with a late sensor and stores every hundredth value to save memory.
# Instead: ask for steps far below the delay and drop what is not needed; compare with half the step (tried below: the
#   exact value by the method of steps). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 ddeint==0.3.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version
from math import factorial

import numpy as np
from ddeint import ddeint

END = 10.0
exact = sum((-1) ** k * (END - k + 1) ** k / factorial(k) for k in range(int(END) + 2))


def at_the_end(step):
    """x at 10, of a result that has a value every `step`."""
    t = np.linspace(0.0, END, round(END / step) + 1)
    return float(np.ravel(ddeint(lambda x, t: -x(t - 1.0), lambda t: 1.0, t))[-1])


seen = {step: at_the_end(step) for step in (0.5, 0.1, 0.01)}
off = {step: abs(x / exact - 1.0) for step, x in seen.items()}
assert off[0.5] > 1.0, off
assert 5e-3 < off[0.1] < 5e-2, off
# instead
assert off[0.01] < 1e-3, off
print("ddeint", version("ddeint"), "numpy", np.__version__)
print(f"x at 10, exact: {exact:.6f}")
for step, x in seen.items():
    print(f"a value every {step}: {x:.6f}, off by {off[step]:.1%}")
PROGRAM
