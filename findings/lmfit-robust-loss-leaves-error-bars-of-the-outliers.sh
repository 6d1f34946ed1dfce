#!/usr/bin/env bash
# Expected: minimize(method="least_squares", loss="soft_l1") is robust in what it reports: with five gross outliers
#   among fifty points the values are nearly those of the clean points, and so are the error bars.
# What happens: the values are, but the error bars are about 100 times too wide, wider than those of the plain fit. They
#   take the Jacobian weighted by the loss, and then multiply by the squared residuals without it, outliers included;
#   chisqr, redchi and bic are of the plain residuals, too.
# Packages: lmfit 1.3.4, scipy 1.17.1, numpy 2.3.5. Source: found by trying.
# Who is hurt: whoever takes a robust loss against a tracker's jumps and reads stderr, or compares models by bic.
# Instead: use the robust fit to find the outliers, drop them and fit again without loss (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 lmfit==1.3.4
"$folder/venv/bin/python" - <<'PROGRAM'
import lmfit
import numpy as np
import scipy

t = np.linspace(0.0, 1.0, 50)
clean = 3.0 * np.exp(-2.0 * t) + 0.5 + np.random.default_rng(1).normal(0.0, 0.02, t.size)
hit = np.zeros(t.size, dtype=bool)
hit[::10] = True
seen = clean + 5.0 * hit


def fit(keep, **options):
    def residual(p):
        return (p["a"] * np.exp(-p["k"] * t) + p["c"] - seen)[keep]

    p = lmfit.create_params(a=1.0, k=1.0, c=0.1)
    return lmfit.minimize(residual, p, method="least_squares", **options), residual


every = np.ones(t.size, dtype=bool)
good, _ = fit(~hit)
plain, _ = fit(every)
print("lmfit", lmfit.__version__, "scipy", scipy.__version__, "numpy", np.__version__)
for name, result in (("clean points", good), ("plain, all points", plain)):
    k = result.params["k"]
    print(f"{name:18s} k = {k.value:.3f} +- {k.stderr:.3f}  bic {result.bic:.0f}")
for loss in ("soft_l1", "huber", "cauchy", "arctan"):
    robust, residual = fit(every, loss=loss, f_scale=0.05)
    k = robust.params["k"]
    print(f"{loss:18s} k = {k.value:.3f} +- {k.stderr:.3f}  bic {robust.bic:.0f}")
    assert abs(k.value - good.params["k"].value) < good.params["k"].stderr
    assert 70 < k.stderr / good.params["k"].stderr < 140
    assert k.stderr > plain.params["k"].stderr
    assert robust.bic > plain.bic and robust.chisqr > plain.chisqr
    away = np.abs(residual(robust.params)) < 0.2
    again, _ = fit(away)
    assert np.array_equal(away, ~hit)
    assert abs(again.params["k"].stderr / good.params["k"].stderr - 1) < 1e-6
PROGRAM
