#!/usr/bin/env bash
# Expected: `eigensys_realization(impulse_response(system))` gives the system back: the response holds its times, 0.1 s
#   apart, and both functions are of one package.
# What happens: the times of the response are not looked at, and the step of the result is True, an unknown one: the
#   poles of the map are right, the gain is 40 for 4 at 0.1 s, 4000 at 1 ms, and no frequency is in hertz. `markov`
#   does look: of a response its values are 1/step times those of the same two arrays. No warning.
# Package: control 0.10.2. Source: found by trying.
# Who is hurt: whoever identifies a mechanism from shocks or noise and uses its gain, or its frequencies.
# Instead: eigensys_realization(..., dt=step) (tried), for arrays as well.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 control==0.10.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import control
import numpy as np

warnings.simplefilter("error", UserWarning)
print("control", control.__version__, "numpy", np.__version__)
random = np.random.default_rng(0)
for step in (1.0, 0.1, 0.001):
    true = control.ss([[0.9, 0.2], [-0.2, 0.9]], [[0.0], [1.0]], [[1.0, 0.0]], 0.0, step)
    response = control.impulse_response(true, T=step * np.arange(60))
    assert np.isclose(response.time[1], step)
    found, _ = control.eigensys_realization(response, r=2)
    push = random.normal(size=400)
    seen = control.forced_response(true, step * np.arange(400), push)
    by_response, by_arrays = control.markov(seen, 40), control.markov(seen.outputs, push, 40)
    print(f"step {step} s: gain {float(true.dcgain()):.3f}, realised {float(found.dcgain()):.4g} with a step of "
          f"{found.dt}; markov of the response over markov of its arrays {np.max(by_response) / np.max(by_arrays):.4g}")
    assert np.isclose(true.dcgain(), 4.0) and np.isclose(found.dcgain(), 4.0 / step, rtol=1e-6) and found.dt is True
    assert np.isclose(np.max(by_response) / np.max(by_arrays), 1.0 / step)
    assert np.abs(found.poles()[0] - true.poles()).min() < 1e-6
    # instead
    again, _ = control.eigensys_realization(response, r=2, dt=step)
    assert np.isclose(again.dcgain(), 4.0, rtol=1e-6) and again.dt == step
PROGRAM
