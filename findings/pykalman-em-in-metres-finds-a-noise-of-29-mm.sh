#!/usr/bin/env bash
# Expected: `KalmanFilter.em(readings)` finds the step and the noise of a random walk by its readings; metres or
#   micrometres give the same, in other numbers.
# What happens: it starts at 1 in whatever unit, and stops after ten rounds. For 200 readings in metres with a noise of
#   20 um and steps of 5 um it returns 29 mm and 34 mm; in micrometres 20.1 um and 7.8 um. It says nothing of not being
#   there yet, and a filter with these constants follows each reading.
# Package: pykalman 0.11.2, numpy 2.4.6. Source: ten rounds are the documented default; the size found by trying.
# Who is hurt: whoever works in SI units with small things. Instead: readings in units of their noise, or a start of the
#   right size (tried); and more rounds until nothing changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-base==0.13.2 pykalman==0.11.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from pykalman import KalmanFilter

warnings.simplefilter("error", RuntimeWarning)
STEP, NOISE = 5e-6, 20e-6  # m
random = np.random.default_rng(0)
read = np.cumsum(random.normal(0.0, STEP, 200)) + random.normal(0.0, NOISE, 200)


def found(readings, **start):
    """Step and noise, in the unit of the readings, after `em` with its default number of rounds."""
    kf = KalmanFilter(transition_matrices=[[1.0]], observation_matrices=[[1.0]], **start)
    kf = kf.em(readings, em_vars=["transition_covariance", "observation_covariance"])
    return np.sqrt([kf.transition_covariance.item(), kf.observation_covariance.item()])


metres, micrometres = found(read), found(read * 1e6)
near = found(read, transition_covariance=[[STEP**2]], observation_covariance=[[NOISE**2]],
             initial_state_covariance=[[1e-9]])
print("pykalman", version("pykalman"), "numpy", np.__version__)
for name, (step, noise) in {"in m": metres * 1e6, "in um": micrometres, "started at the true ones": near * 1e6}.items():
    print(f"{name}: a step of {step:.4g} um and a noise of {noise:.4g} um (true: 5 and 20)")
assert metres[0] > 1e3 * STEP and metres[1] > 1e3 * NOISE
assert abs(micrometres[1] / 20.0 - 1.0) < 0.1 and abs(micrometres[0] / 5.0 - 1.0) < 1.0
assert abs(near[0] / STEP - 1.0) < 0.2 and abs(near[1] / NOISE - 1.0) < 0.2  # instead
PROGRAM
