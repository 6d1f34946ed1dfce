#!/usr/bin/env bash
# Expected: a solver that says "found" has the two contact forces of a block, a well conditioned problem, to some
#   digits.
# What happens: tolerances are absolute, and HiGHS adds 1e-7 to the diagonal. With compliances of 2 um/N OSQP and SCS
#   give no force, ProxQP 0.72 and HiGHS 0.96 of it; as impulses of 2 mg Clarabel gives six times the right ones. All
#   report success. quadprog and DAQP are right in both.
# Packages: the pins, by way of qpsolvers 4.13.0. Source: tolerances are documented, their effect was found by trying.
# Who is hurt: whoever solves contacts, complementarity problems or controllers of small machines in SI.
# Instead: divide matrix and vector by their largest entries, scale the unknown back (tried: all within 1 %).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 qpsolvers==4.13.0 clarabel==0.11.1 daqp==0.11.0 highspy==1.16.0 osqp==1.1.3 \
    proxsuite==0.8.0 quadprog==0.1.14 scs==3.3.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from qpsolvers import Problem, solve_problem

warnings.simplefilter("ignore", UserWarning)
warnings.simplefilter("ignore", PendingDeprecationWarning)
names = ("qpsolvers", "clarabel", "daqp", "highspy", "osqp", "proxsuite", "quadprog", "scs")
print(*(f"{name} {version(name)}" for name in names))
shape = np.array([[1.0, 0.3], [0.3, 1.0]])
forms = {"compliance": (2e-6 * shape, -2e-6 * np.ones(2)),
         "impulse": (np.array([[5e5, 2e5], [2e5, 5e5]]), -9.81e-3 * np.ones(2))}
seen = {}
for form, (matrix, vector) in forms.items():
    true = np.linalg.solve(matrix, -vector)
    assert np.linalg.cond(matrix) < 2.5 and true.min() > 0.0
    for solver in ("clarabel", "daqp", "highs", "osqp", "proxqp", "quadprog", "scs"):
        result = solve_problem(Problem(matrix, vector, -np.eye(2), np.zeros(2)), solver)
        assert result.found
        seen[form, solver] = result.x / true
        # instead
        high, size = np.abs(matrix).max(), np.abs(vector).max()
        scaled = solve_problem(Problem(matrix / high, vector / size, -np.eye(2), np.zeros(2)), solver)
        assert scaled.found and np.allclose(scaled.x * size / high / true, 1.0, atol=0.01)
for (form, solver), share in seen.items():
    print(f"{form}, {solver}: found, {share.round(4).tolist()} of the right force")
    if solver in ("quadprog", "daqp"):
        assert np.allclose(share, 1.0, rtol=1e-6)
for solver, share in (("osqp", 0.0), ("scs", 0.0), ("proxqp", 0.72), ("highs", 0.963)):
    assert np.allclose(seen["compliance", solver], share, atol=0.01)
assert np.all(seen["impulse", "clarabel"] > 4.0)
PROGRAM
