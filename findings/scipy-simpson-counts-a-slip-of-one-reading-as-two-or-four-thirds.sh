#!/usr/bin/env bash
# Expected: the way of a walker from its speeds is as good by Simpson's rule as by trapezoids, and never falls while no
#   speed is below 0.
# What happens: Simpson's weights go 2/3, 4/3 from reading to reading: a slip of one reading is 0.67 or 1.33 by the
#   parity of its place. A slip each 50 readings falls on even places alone: 13 for 20, moved by one reading 25.7. The
#   way by `cumulative_simpson` goes back at each slip. Trapezoids give 1. No warning.
# Package: scipy 1.17.1. Source: the rule is known; what it does to slips was found by trying.
# Who is hurt: whoever adds up short slips, shocks or pulses of current from samples.
# Instead: trapezoid and cumulative_trapezoid (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import scipy
from scipy.integrate import cumulative_simpson, cumulative_trapezoid, simpson

warnings.simplefilter("error")
print("scipy", scipy.__version__, "numpy", np.__version__)
for at in (49, 50, 51):
    speed = np.zeros(101)
    speed[at] = 1.0
    print(f"a slip of one reading at {at}: simpson {simpson(speed, dx=1.0):.3f}, trapezoid {np.trapezoid(speed):.3f}")
    assert np.isclose(simpson(speed, dx=1.0), 4 / 3 if at % 2 else 2 / 3) and np.isclose(np.trapezoid(speed), 1.0)
slips = np.zeros(1001)
slips[50::50] = 1.0  # a walker that slips each 50 readings, for 20 of them; the last stands at the end
later = np.roll(slips, 1)
seen = simpson(slips, dx=1.0), simpson(later, dx=1.0)
print(f"20 slips, one each 50 readings: {seen[0]:.2f}, one reading later {seen[1]:.2f}; trapezoid "
      f"{np.trapezoid(slips):.2f} and {np.trapezoid(later):.2f}")
assert np.isclose(seen[0], 13.0) and seen[1] > 25.0 and 19.0 < np.trapezoid(slips) < 20.0
way = cumulative_simpson(slips, dx=1.0, initial=0.0)
print(f"way from these speeds: least step {np.diff(way).min():.3f}, {np.sum(np.diff(way) < 0)} steps back")
assert np.diff(way).min() < -0.08 and np.sum(np.diff(way) < 0) == 39
# instead
assert np.diff(cumulative_trapezoid(slips, dx=1.0, initial=0.0)).min() >= 0.0
PROGRAM
