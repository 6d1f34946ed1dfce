#!/usr/bin/env bash
# Expected: STLSQ finds x'' = -4 x - 0.3 x' from clean data in millimetres and in metres alike: a linear law has no
#   length in it.
# What happens: a ridge penalty of 0.05, in units of the data squared, shrinks the coefficients before the threshold
#   looks at them. With an amplitude of 1 (or 10 mm) the law is right; with 0.01 (the same in m) the damping is dropped
#   without a word; with 0.001 every term is, with a warning.
# Packages: pysindy 2.1.0, scikit-learn 1.9.1, numpy 2.3.5, scipy 1.17.1. Source: found by trying.
# Who is hurt: whoever identifies a law from data in SI, smaller than one.
# Instead: alpha=0, or data divided by their standard deviation (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 scikit-learn==1.9.1 pysindy==2.1.0
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import pysindy
import scipy
import sklearn
from scipy.integrate import solve_ivp

t = np.linspace(0.0, 20.0, 2000)
clean = solve_ivp(
    lambda t, y: [y[1], -4 * y[0] - 0.3 * y[1]], (0, 20), [1, 0], t_eval=t, rtol=1e-10, atol=1e-12
).y.T


def law(scale, **options):
    """The coefficients of x and of x' in the law for x'', and the number of warnings."""
    model = pysindy.SINDy(
        feature_library=pysindy.PolynomialLibrary(1), optimizer=pysindy.STLSQ(**options)
    )
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        model.fit(clean * scale, t=t)
    return model.coefficients()[1][1:], len([w for w in said if "too big" in str(w.message)])


print("pysindy", pysindy.__version__, "scikit-learn", sklearn.__version__, "numpy", np.__version__,
      "scipy", scipy.__version__)
for scale in (10.0, 1.0, 0.1, 0.03, 0.01, 1e-3):
    found, warned = law(scale, threshold=0.05)
    print(f"amplitude {scale:g}: x'' = {found[0]:+.3f} x {found[1]:+.3f} x'", "(warned)" * (warned > 0))
assert np.allclose(law(10.0, threshold=0.05)[0], (-4, -0.3), atol=1e-3)
found, warned = law(0.01, threshold=0.05)
assert abs(found[0] + 4) < 0.2 and found[1] == 0 and warned == 0
found, warned = law(1e-3, threshold=0.05)
assert not found.any() and warned > 0
for scale in (1.0, 0.03, 1e-3, 1e-6):
    assert np.allclose(law(scale, threshold=0.05, alpha=0)[0], (-4, -0.3), atol=1e-3)
PROGRAM
