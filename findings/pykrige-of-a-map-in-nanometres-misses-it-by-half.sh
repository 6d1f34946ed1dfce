#!/usr/bin/env bash
# Expected: `OrdinaryKriging` of 100 readings of a smooth map gives the map and its error in the readings' own unit.
# What happens: the variogram is fitted by a loss with an absolute size of 1, from starts that large or small numbers do
#   not leave. Readings around 1 are mapped to 0.013 of their size. The same times 1000 or a million are mapped to 0.45,
#   their own scatter: the map is flat. Thousandths are mapped to 0.07 and millionths to 0.05, with errors stated as 2
#   and 4 times the right ones. A warning comes for the million alone.
# Package: pykrige 1.7.3, scipy 1.17.1, numpy 2.3.5. Source: found by trying.
# Who is hurt: whoever maps heights in nm or in m, fields in uT or in T.
# Instead: divide the readings by their standard deviation, and multiply the map and its error by it (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 pykrige==1.7.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from pykrige.ok import OrdinaryKriging

print(*(f"{name} {version(name)}" for name in ("pykrige", "scipy", "numpy")))


def height(x, y):
    return np.sin(x / 2.0) * np.cos(y / 2.0)


def miss(unit, seed, scaled=False):
    """The error of the map at 50 places and the stated one, as shares of the readings' unit."""
    rng = np.random.default_rng(seed)
    (x, y), places = rng.uniform(0.0, 10.0, (2, 100)), rng.uniform(2.0, 8.0, (2, 50))
    readings = unit * height(x, y)
    by = readings.std() if scaled else 1.0
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        kriging = OrdinaryKriging(x, y, readings / by, variogram_model="spherical")
        found, variance = kriging.execute("points", *places)
    stated = by * np.sqrt(np.mean(variance)) / unit
    return np.array([np.std(by * found / unit - height(*places)), stated, len(caught)])


for unit in (1e6, 1e3, 1.0, 1e-3, 1e-6):
    plain = np.median([miss(unit, seed) for seed in range(5)], axis=0)
    mended = np.median([miss(unit, seed, scaled=True) for seed in range(5)], axis=0)
    print(f"readings of about {unit:g}: the map is off by {plain[0]:.3f}, stated {plain[1]:.2f}; "
          f"warnings {plain[2]:g}; divided by their scatter {mended[0]:.3f}, stated {mended[1]:.2f}")
    assert mended[0] < 0.03
    if unit == 1.0:
        assert plain[0] < 0.03 and plain[1] < 0.25
    elif unit > 1.0:
        assert plain[0] > 0.4
    else:
        assert plain[0] > 0.04 and plain[1] > 0.35
PROGRAM
