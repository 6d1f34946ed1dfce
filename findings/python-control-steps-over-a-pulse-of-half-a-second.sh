#!/usr/bin/env bash
# Expected: `input_output_response(system, t, u)` simulates a system under the drive u, given at every millisecond; a
#   push that holds for hundreds of these points moves the system.
# What happens: u is handed to `solve_ivp`, which chooses its steps without knowing it. A block at rest makes them grow
#   to a second and more: a push of 1 N s that lasts 0.02, 0.1 or 0.5 s after five seconds is stepped over, and the way
#   is exactly 0 (right: 0.7 m), at rtol 1e-9 too. `forced_response` of the same linear system is right.
# Package: control 0.10.2 (solve_ivp of scipy 1.17.1). Who is hurt: whoever drives a model by a pulsed record.
# Instead: solve_ivp_kwargs={"max_step": half the shortest pulse} (tried). Source: found by trying; the documentation
#   names max_step as a way to more accurate results.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 control==0.10.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import control as ct
import numpy as np
import scipy

t = np.arange(0.0, 10.0, 0.001)  # s


def block(t, x, u, p):
    """Motion of a block on a spring that stiffens by 0.1 at 1 m, mass 1 kg, stiffness 1 N/m, viscous 0.4 N s/m."""
    return np.array([x[1], -x[0] - 0.1 * x[0] ** 3 - 0.4 * x[1] + u[0]])


system = ct.nlsys(block, lambda t, x, u, p: x[0], inputs=1, outputs=1, states=2)
linear = ct.ss([[0, 1], [-1, -0.4]], [[0], [1]], [[1, 0]], [[0]])


def largest(of, pulse, by=ct.input_output_response, **options):
    """Largest way after a push of 1 N s that begins at 5 s and lasts `pulse` s."""
    push = np.where((t >= 5.0) & (t < 5.0 + pulse), 1.0 / pulse, 0.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        answer = by(of, t, push, **options)
    return float(np.abs(answer.outputs).max())


print("control", ct.__version__, "scipy", scipy.__version__, "numpy", np.__version__)
for pulse in (0.02, 0.1, 0.5):
    lost, also, right = largest(system, pulse), largest(linear, pulse), largest(linear, pulse, ct.forced_response)
    bounded = largest(system, pulse, solve_ivp_kwargs={"max_step": 0.5 * pulse})
    print(f"pulse of {pulse} s: way {lost:.3f} m, with max_step {bounded:.3f} m; "
          f"linear system {also:.3f} m, by forced_response {right:.3f} m")
    assert lost == also == 0.0
    assert 0.7 < right < 0.8
    assert 0.7 < bounded < 0.8
tight = largest(system, 0.1, solve_ivp_kwargs={"rtol": 1e-9, "atol": 1e-12})
print(f"pulse of 0.1 s with rtol 1e-9, without max_step: {tight:.3f} m")
assert tight == 0.0
PROGRAM
