#!/usr/bin/env bash
# Expected: `variances()` of a profile (`WeightedMean`) has one meaning, and weights in another unit change neither a
#   mean nor its error.
# What happens: `view().variance` is that of the readings, `variances()` that of their mean, made by dividing by the
#   sum of the weights as if it were a count: the error of 5000 readings is 0.029, with weights 1000 times as large
#   0.0009, with a thousandth 0.9. Weights of 1/sigma**2 have such a size. No warning.
# Package: boost-histogram 1.8.1. Source: found by trying.
# Who is hurt: whoever averages a log over phase, place or temperature with weights, and plots its error bars.
# Instead: view().variance over sum_of_weights**2 / sum_of_weights_squared (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 boost-histogram==1.8.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import boost_histogram as bh
import numpy as np

warnings.simplefilter("error")
print("boost-histogram", bh.__version__, "numpy", np.__version__)
random = np.random.default_rng(0)
count = 5000
speeds = random.normal(10.0, 2.0, size=count)  # mm/s, all at one phase of a step
share = random.uniform(0.5, 1.5, size=count)
mean = np.average(speeds, weights=share)
spread = np.average((speeds - mean) ** 2, weights=share)
right = np.sqrt(spread * np.sum(share**2)) / share.sum()
for name, weights in (("none", None), ("about 1", share), ("about 1000", 1e3 * share), ("about 0.001", 1e-3 * share)):
    storage = bh.storage.Mean() if weights is None else bh.storage.WeightedMean()
    profile = bh.Histogram(bh.axis.Regular(1, 0.0, 1.0), storage=storage)
    profile.fill(np.full(count, 0.5), sample=speeds, **({} if weights is None else {"weight": weights}))
    view, error = profile.view(), float(np.sqrt(profile.variances()[0]))
    print(f"weights {name}: mean {float(profile.values()[0]):.3f}, root of view().variance "
          f"{view.variance[0] ** 0.5:.3f}, root of variances() {error:.5f}; right error of the mean {right:.5f}")
    assert np.isclose(np.sqrt(view.variance[0]), 2.0, rtol=0.03) and np.isclose(profile.values()[0], 10.0, atol=0.1)
    factor = {"none": 1.0, "about 1": 1.0, "about 1000": 1e-3**0.5, "about 0.001": 1e3**0.5}[name]
    assert np.isclose(error, factor * right, rtol=0.06)
    if weights is not None:
        # instead
        number = view.sum_of_weights[0] ** 2 / view.sum_of_weights_squared[0]
        assert np.isclose(np.sqrt(view.variance[0] / number), right, rtol=1e-3)
PROGRAM
