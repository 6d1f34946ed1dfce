#!/usr/bin/env bash
# Expected: `GaussianHMM(2)` of a record that stands at 0 or at 1 with a noise of 0.1 finds the two states, in any unit.
# What happens: `min_covar` is 1e-3 in the square of the data's unit, and the variance has a prior of 1e-2. In units
#   of 1 and 0.1 every reading is told right, in 0.01 and less half of them, as by a coin: both states have the mean 0.5
#   and a width of 0.7 to thousands. The fit reports that it converged. No warning.
# Package: hmmlearn 0.3.3, scikit-learn 1.9.1, numpy 2.3.5. Source: found by trying; both numbers are documented.
# Who is hurt: whoever parts stick from slip, or steps of a walker, by positions in metres or speeds in mm/s.
# Instead: the readings over their standard deviation, and the means turned back (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 scikit-learn==1.9.1 hmmlearn==0.3.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from hmmlearn.hmm import GaussianHMM

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("hmmlearn", "scikit-learn", "numpy")))
rng = np.random.default_rng(0)
state = np.arange(1000) // 100 % 2
record = state + rng.normal(0.0, 0.1, 1000)


def told(readings):
    """The share of readings told right, the means and the widths of both states, and whether it converged."""
    model = GaussianHMM(2, random_state=0, n_iter=100).fit(readings[:, None])
    found = model.predict(readings[:, None])
    share = max(np.mean(found == state), np.mean(found != state))
    return float(share), np.sort(model.means_.ravel()), np.sqrt(model.covars_.ravel()), model.monitor_.converged


for unit in (1.0, 0.1, 0.01, 1e-3, 1e-6):
    share, means, widths, done = told(unit * record)
    scaled = told(unit * record / np.std(unit * record))
    print(f"in units of {unit:g}: {share:.3f} told right, means {(means / unit).round(3)}, widths "
          f"{(widths / unit).round(2)}, converged: {done}; over their scatter {scaled[0]:.3f} told right")
    assert scaled[0] > 0.99
    if unit >= 0.1:
        assert share > 0.99
    else:
        assert share < 0.6 and done and abs(means / unit - 0.5).max() < 0.05
PROGRAM
