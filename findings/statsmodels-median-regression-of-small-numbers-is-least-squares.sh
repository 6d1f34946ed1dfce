#!/usr/bin/env bash
# Expected: `QuantReg`, a regression to the median, is not moved by one outlier in ten, in any unit.
# What happens: residuals below 1e-6 count as 1e-6, and it stops once the parameters move by less than 1e-6. Of readings
#   of 50 nm in metres the result is the least-squares line, slope 82 for 50, after two rounds; its errors are nan (a
#   RuntimeWarning). Of 50 um the intercept is 0.8 for 0.3. RLM is right.
# Package: statsmodels 0.15.0. Source: `p_tol` is documented; the floor of residuals stands in the code, the rest was
#   found by trying.
# Who is hurt: whoever fits displacements, masses or currents in SI units by their median.
# Instead: scale the readings to about 1 first (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 patsy==1.0.2 statsmodels==0.15.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import statsmodels
import statsmodels.api as sm

warnings.simplefilter("error", UserWarning)
warnings.simplefilter("ignore", RuntimeWarning)
random = np.random.default_rng(0)
t = np.linspace(0.0, 1.0, 100)
readings = 50.0 * t + 2.0 * random.normal(size=100)
readings[::10] += 100.0 * (1.0 + 5.0 * t[::10])
design = sm.add_constant(t)
plain = sm.OLS(readings, design).fit().params
print("statsmodels", statsmodels.__version__, "numpy", np.__version__)
print("least squares:", plain.round(2).tolist(), "; true: [0, 50]")
for unit, scale in (("1", 1.0), ("1e-3", 1e-3), ("1e-6", 1e-6), ("1e-9", 1e-9)):
    fit = sm.QuantReg(readings * scale, design).fit(q=0.5)
    seen, stated = fit.params / scale, fit.bse / scale
    robust = sm.RLM(readings * scale, design).fit().params / scale
    print(f"readings of 50 times {unit}: median {seen.round(2).tolist()} +- {stated.round(2).tolist()} after "
          f"{fit.iterations} rounds, RLM {robust.round(2).tolist()}")
    assert abs(robust[1] - 50.0) < 3.0
    if scale == 1e-9:
        assert np.allclose(seen, plain, rtol=1e-6) and seen[1] > 80.0 and np.isnan(stated).all()
    else:
        assert abs(seen[1] - 50.0) < 3.0 and (seen[0] > 0.7) == (scale == 1e-6)
# instead
again = sm.QuantReg(readings * 1e-9 / 1e-9, design).fit(q=0.5).params
assert abs(again[1] - 50.0) < 3.0
PROGRAM
