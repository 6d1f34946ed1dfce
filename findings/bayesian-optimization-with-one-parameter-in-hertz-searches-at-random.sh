#!/usr/bin/env bash
# Expected: `BayesianOptimization(f, {"a": (0, 1), "b": (0, 1000)})` knows the bounds, and searches as in 0 to 1.
# What happens: the default kernel has one length for all parameters and their bare numbers are used. A smooth bowl is
#   found to 1e-6 after 25 runs if both lie in 0 to 1; with b in 0 to 1000 its best is hundreds of times worse or
#   more, no better than 25 random points. The same line works in kHz and fails in Hz.
# Package: bayesian-optimization 3.4.0, scikit-learn 1.9.1. Source: found by trying.
# Who is hurt: whoever tunes a drive by a frequency in Hz and an amplitude in mT.
# Instead: parameters scaled to 0 to 1, and turned back within f (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-learn==1.9.1 bayesian-optimization==3.4.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from bayes_opt import BayesianOptimization

warnings.simplefilter("ignore")


def bowl(a, b):
    """With its top, 0, at 0.3 and 700."""
    return -((a - 0.3) ** 2 + ((b - 700.0) / 1000.0) ** 2)


def best(f, high):
    """The median of the best of 25 runs, over three seeds."""
    tops = []
    for seed in range(3):
        search = BayesianOptimization(f, {"a": (0.0, 1.0), "b": (0.0, high)}, random_state=seed, verbose=0)
        for k, point in enumerate(np.random.default_rng(seed).random((25, 2))):
            x = search.suggest() if k >= 5 else {"a": point[0], "b": high * point[1]}
            search.register(x, f(**x))
        tops.append(search.max["target"])
    return float(np.median(tops))


rng = np.random.default_rng(0)
drawn = float(np.median([max(bowl(*p) for p in rng.random((25, 2)) * [1.0, 1000.0]) for _ in range(200)]))
raw, scaled = best(bowl, 1000.0), best(lambda a, b: bowl(a, 1000.0 * b), 1.0)
print("bayesian-optimization", version("bayesian-optimization"), "scikit-learn", version("scikit-learn"))
print(f"what is missing to the top after 25 runs: b in 0 to 1000 {-raw:.1e}, in 0 to 1 {-scaled:.1e}, "
      f"25 random points {-drawn:.1e}")
assert -scaled < 1e-4
assert raw / scaled > 200.0
assert -raw > 0.3 * -drawn
PROGRAM
