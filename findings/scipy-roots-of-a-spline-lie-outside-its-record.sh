#!/usr/bin/env bash
# Expected: `CubicSpline(t, y).roots()` are the crossings within the record, as InterpolatedUnivariateSpline gives
#   them.
# What happens: the end pieces go on without end, and their roots are listed as well: three crossings become six, some
#   before the start and 16 s after the end. A rest at 0 gives its start and nan for each interval. `integrate` beyond
#   the end goes on, where FITPACK's takes 0: 200 and 50. No warning; Akima1DInterpolator stays inside.
# Package: scipy 1.17.1. Source: `extrapolate` and its default are documented; found by trying.
# Who is hurt: whoever counts crossings or periods, or finds starts and stops by the roots of a spline.
# Instead: extrapolate=False in roots and integrate (tried).
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
from scipy.interpolate import Akima1DInterpolator, CubicSpline, InterpolatedUnivariateSpline, PchipInterpolator

warnings.simplefilter("error")
print("scipy", scipy.__version__, "numpy", np.__version__)
time = np.linspace(0.0, 10.0, 21)
readings = np.sin(time) + 0.2  # three times zero within the record
for curve, outside in ((CubicSpline, 3), (PchipInterpolator, 3), (Akima1DInterpolator, 0),
                       (InterpolatedUnivariateSpline, 0)):
    roots = curve(time, readings).roots()
    print(f"{curve.__name__}: roots {roots.round(2).tolist()}")
    assert np.sum((roots < 0.0) | (roots > 10.0)) == outside and np.sum((roots >= 0.0) & (roots <= 10.0)) == 3
    if outside:
        assert curve(time, readings).roots(extrapolate=False).size == 3  # instead
    assert np.isfinite(roots).all()
speed = np.where((time > 3.0) & (time < 6.0), 0.0, 1.0)  # a rest of five readings, two crossings
roots = PchipInterpolator(time, speed).roots(extrapolate=False)
print("a rest from 3.5 to 5.5 s:", roots.tolist())
assert np.isnan(roots).sum() == 4
ways = {curve.__name__: float(curve(time, time).integrate(0.0, 20.0)) for curve in (CubicSpline, PchipInterpolator)}
ways["InterpolatedUnivariateSpline"] = InterpolatedUnivariateSpline(time, time).integral(0.0, 20.0)
print("integral of t from 0 to 20 s by a record up to 10 s:", {name: round(way, 1) for name, way in ways.items()})
assert np.allclose(list(ways.values()), (200.0, 200.0, 50.0))
assert np.isnan(CubicSpline(time, time).integrate(0.0, 20.0, extrapolate=False))  # instead
PROGRAM
