#!/usr/bin/env bash
# Expected: a random surface with a stated variance has about that variance, in any unit.
# What happens: a variance up to 1e-8 counts as none. A surface with a scatter of 0.2 mm in metres is right; with 0.1 mm or
#   less each place has the mean, exactly, while the model's own variogram is the stated one. In mm and um it is right. A
#   surface that is drawn through measured places keeps the kriged line and loses the scatter beside it: 0.041 mm for
#   0.083. No warning.
# Package: gstools 1.7.0, numpy 2.4.6, scipy 1.17.1. Source: found by trying; `zero_var` compares with 0 by
#   numpy's absolute tolerance.
# Who is hurt: whoever draws a rough surface, a film or an uneven friction for a simulation in SI units.
# Instead: lengths in mm, or a field with a variance of 1 times the standard deviation (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 gstools==1.7.0
cd "$folder"
"$folder/venv/bin/python" -W error - <<'PROGRAM'
from importlib.metadata import version

import gstools as gs
import numpy as np

print(*(f"{name} {version(name)}" for name in ("gstools", "numpy", "scipy")))
PLACES = np.linspace(0, 1e-2, 400)  # of a surface of 10 mm
MEASURED, SIGNS = PLACES[::100], np.array([1.0, -1.0, 1.0, -1.0])


def scatters(sd, per_metre):
    """Standard deviations of a free surface and of one through four places, in the stated one."""
    model = gs.Exponential(dim=1, var=(sd * per_metre) ** 2, len_scale=5e-4 * per_metre)
    assert np.isclose(model.variogram(0.1 * per_metre), (sd * per_metre) ** 2)
    free = gs.SRF(model, mean=3e-3 * per_metre, seed=7)(PLACES * per_metre)
    kriged = gs.krige.Ordinary(model, [MEASURED * per_metre], SIGNS * sd * per_metre)
    through = gs.CondSRF(kriged)(PLACES * per_metre, seed=7)
    return np.std(free) / sd / per_metre, np.std(through) / sd / per_metre


for sd in (2e-4, 1e-4, 5e-6):
    metres, *others = [scatters(sd, per_metre) for per_metre in (1.0, 1e3, 1e6)]
    print(f"scatter {sd:g} m: in metres {metres[0]:.3f} and {metres[1]:.3f} of it, in mm {others[0][0]:.3f} and {others[0][1]:.3f}")
    assert np.allclose(others, [0.854, 0.834], atol=0.001)
    assert np.allclose(metres, [0.854, 0.834] if sd > 1e-4 else [0.0, 0.407], atol=0.001)
    assert metres[0] == 0.0 or sd > 1e-4
unit = gs.SRF(gs.Exponential(dim=1, var=1.0, len_scale=5e-4), seed=7)(PLACES)
assert np.isclose(np.std(5e-6 * unit), 0.854 * 5e-6, rtol=1e-3)
PROGRAM
