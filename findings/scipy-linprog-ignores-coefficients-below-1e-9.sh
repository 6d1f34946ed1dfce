#!/usr/bin/env bash
# Expected: `linprog` and `milp` respect each constraint, or say that they could not: 5e-10 F <= 5e-10 means F <= 1.
# What happens: HiGHS takes coefficients below 1e-9 as zero. A compliance of 5e-10 m/N drops out, and of a force with
#   an upper bound of 5 N the largest is 5 N, with status 0 and a slack that is negative in truth; 2e-9 gives 1 N. So
#   do highs-ds, highs-ipm and milp.
# Package: scipy 1.17.1. Source: HiGHS documents its option `small_matrix_value`, scipy does not offer it; found by
#   trying.
# Who is hurt: whoever bounds displacements, charges or masses in SI units, or fits with least largest error.
# Instead: scale each row so that its largest coefficient is 1 (tried), and check A @ x <= b afterwards (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import scipy
from scipy.optimize import Bounds, LinearConstraint, linprog, milp

warnings.simplefilter("error")
print("scipy", scipy.__version__, "numpy", np.__version__)
for compliance, right in ((2e-9, True), (5e-10, False), (1e-11, False)):
    rows, limit = np.array([[compliance]]), np.array([compliance * 1.0])
    seen = {}
    for method in ("highs", "highs-ds", "highs-ipm"):
        result = linprog([-1.0], A_ub=rows, b_ub=limit, bounds=[(0.0, 5.0)], method=method)
        assert result.status == 0 and result.success
        seen[method] = float(result.x[0])
    result = milp([-1.0], constraints=LinearConstraint(rows, -np.inf, limit), bounds=Bounds(0.0, 5.0))
    assert result.status == 0 and result.success
    seen["milp"] = float(result.x[0])
    print(f"{compliance:g} m/N: largest force {seen}")
    assert np.allclose(list(seen.values()), 1.0 if right else 5.0)
    # instead
    scaled = linprog([-1.0], A_ub=rows / rows.max(), b_ub=limit / rows.max(), bounds=[(0.0, 5.0)])
    assert np.isclose(scaled.x[0], 1.0)
    assert np.all(rows @ [seen["highs"]] <= limit * (1.0 + 1e-6)) == right
PROGRAM
