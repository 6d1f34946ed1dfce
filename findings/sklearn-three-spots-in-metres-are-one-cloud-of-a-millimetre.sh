#!/usr/bin/env bash
# Expected: `GaussianMixture(3)` finds three spots of 20 um, 300 um apart, in metres as in um.
# What happens: 1e-6 is added to each variance, which is 1 mm squared in metres: all three have the same centre and 1.01
#   mm of spread, all readings go to one of them, BIC asks for one component, `converged_` is True, no warning.
#   ARDRegression finds the slope 0 for readings in metres. Millimetres are right.
# Package: scikit-learn 1.9.1. Source: `reg_covar` is documented; found by trying.
# Who is hurt: whoever clusters places, steps or stops of a small robot in SI units.
# Instead: data in units of about 1, or reg_covar=1e-20 (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-learn==1.9.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import sklearn
from sklearn.linear_model import ARDRegression
from sklearn.mixture import GaussianMixture

warnings.simplefilter("error")
random = np.random.default_rng(0)
spots = np.concatenate([random.normal(centre, 20.0, (200, 2)) for centre in ((0, 0), (300, 0), (150, 250))])
t = np.linspace(0.0, 1.0, 100)[:, None]
line = 50.0 * t[:, 0] + 2.0 * random.normal(size=100)


def found(scale, **options):
    """Widths, um, sizes of the clusters and the number of components that BIC asks for."""
    fits = {k: GaussianMixture(k, random_state=0, **options).fit(spots * scale) for k in (1, 2, 3, 4)}
    three = fits[3]
    assert three.converged_
    widths = np.sqrt(three.covariances_[:, 0, 0]) / scale
    sizes = sorted(np.bincount(three.predict(spots * scale), minlength=3).tolist())
    return widths, sizes, min(fits, key=lambda k: fits[k].bic(spots * scale))


def slope(scale):
    return float(ARDRegression().fit(t, line * scale).coef_[0] / scale)


print("scikit-learn", sklearn.__version__, "numpy", np.__version__)
for unit, scale in (("um", 1.0), ("mm", 1e-3), ("m", 1e-6)):
    widths, sizes, wanted = found(scale)
    print(f"in {unit}: widths {widths.round(1).tolist()} um, sizes {sizes}, BIC asks for {wanted}; "
          f"slope by ARDRegression {slope(scale):.2f} (true 50)")
    if unit == "m":
        assert (widths > 1000.0).all() and sizes[0] == 0 and wanted == 1 and slope(scale) == 0.0
    else:
        assert (abs(widths - 20.0) < 2.0).all() and sizes == [200, 200, 200] and wanted == 3
        assert abs(slope(scale) - 50.0) < 3.0
# instead
widths, sizes, wanted = found(1e-6, reg_covar=1e-20)
assert (abs(widths - 20.0) < 2.0).all() and sizes == [200, 200, 200] and wanted == 3
PROGRAM
