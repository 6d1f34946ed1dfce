#!/usr/bin/env bash
# Expected: a parameter whose first value lies on its bound (an offset of 0 with min=0) is moved off it where the data
#   ask for it, or the fit says that it could not; the method only changes how fast.
# What happens: lmfit maps a bounded parameter to a free one by a function that is flat on the bound. With min alone
#   leastsq gets away, while nelder, lbfgsb, bfgs, slsqp and cg stay there. With min and max leastsq goes to a wrong
#   place. All report success.
# Packages: lmfit 1.3.4, scipy 1.17.1, numpy 2.3.5. Source: found by trying; lmfit's page on bounds gives the mapping.
# Who is hurt: whoever starts an offset, a friction or a drag at zero with min=0.
# Instead: start inside the bounds, or take method="least_squares", whose bounds are its own (both tried).
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
seen = 3.0 * np.exp(-2.0 * t) + 0.5 + np.random.default_rng(1).normal(0.0, 0.02, t.size)


def residual(p):
    return p["a"] * np.exp(-p["k"] * t) + p["c"] - seen


def offset(method, start=0.0, top=np.inf):
    p = lmfit.Parameters()
    p.add("a", 1.0)
    p.add("k", 1.0, min=0.0)
    p.add("c", start, min=0.0, max=top)
    result = lmfit.minimize(residual, p, method=method)
    assert result.success, method
    return result.params["c"].value, result.chisqr


best, least = offset("leastsq", 0.3)
assert abs(best - 0.508) < 0.01
stuck = {m: offset(m) for m in ("nelder", "lbfgsb", "bfgs", "slsqp", "cg")}
for method, (value, chisqr) in stuck.items():
    assert value < 1e-4 and chisqr > 3 * least, (method, value, chisqr)
assert abs(offset("leastsq")[0] - best) < 1e-3
wrong, chisqr = offset("leastsq", top=1.0)
assert abs(wrong - best) > 0.3 and chisqr > 100 * least
for top in (np.inf, 1.0):
    assert abs(offset("least_squares", top=top)[0] - best) < 1e-3
    assert abs(offset("lbfgsb", 0.1, top)[0] - best) < 1e-2
print("lmfit", lmfit.__version__, "scipy", scipy.__version__, "numpy", np.__version__)
print(f"best offset {best:.3f}, chi-square {least:.4f}")
for method, (value, chi) in stuck.items():
    print(f"{method:8s} from 0 with min=0: {value:.1e}, chi-square {chi:.4f}, success")
print(f"leastsq  from 0 with min=0, max=1: {wrong:.3f}, chi-square {chisqr:.2f}, success")
PROGRAM
