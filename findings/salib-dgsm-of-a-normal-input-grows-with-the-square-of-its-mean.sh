#!/usr/bin/env bash
# Expected: `dgsm` bounds the share of each input in the scatter, 1 at most in a linear law, and the samplers take
#   "dists"; an offset of an input, as of degrees Celsius from kelvin, changes nothing.
# What happens: the index is made with upper less lower bound of a uniform input, whatever "dists" says, and of a normal
#   one these are mean and standard deviation: with a + b, of 10.0 +- 0.1 and 0.50 +- 0.25, a has 137 and b 0.09, with
#   100.0 +- 0.1 a has 13959; the right shares, which `sobol` finds for the same problem, are 0.14 and 0.86. The sample
#   itself is right. `morris` puts half of the levels of a normal input at minus and plus infinity. SALib does not warn.
# Package: SALib 1.6.0, numpy 2.4.6, scipy 1.17.1, pandas 3.1.1. Source: found by trying; the page of `dgsm` names no
#   distribution, that of problems offers "norm" for all.
# Who is hurt: whoever ranks thicknesses, fields or temperatures by stated errors and trims the wrong one.
# Instead: uniform inputs of the same deviation, or vi times the variance of the input over that of the output (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 SALib==1.6.0
cd "$folder"
"$folder/venv/bin/python" -W ignore - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
from SALib.analyze import dgsm
from SALib.analyze import sobol as shares
from SALib.sample import finite_diff, morris, sobol

print(*(f"{name} {version(name)}" for name in ("SALib", "numpy", "scipy", "pandas")))


def law(sample):
    return sample.sum(axis=1)


def problem(bounds, kind):
    return {"num_vars": 2, "names": ["a", "b"], "bounds": bounds, "dists": [kind, kind]}


def index(stated):
    """The indices of dgsm, and the same ones from the derivatives and the scatter of the inputs."""
    sample = finite_diff.sample(stated, 4096, seed=1)
    found = dgsm.analyze(stated, sample, law(sample), seed=1)
    inputs = sample[::3]
    return np.array(found["dgsm"]), found["vi"] * inputs.var(axis=0) / law(inputs).var(), inputs.std(axis=0)


right = np.array([0.1, 0.25]) ** 2 / (0.1**2 + 0.25**2)
for mean, expected in ((0.0, None), (10.0, 137), (100.0, 13959)):
    stated = problem([[mean, 0.1], [0.5, 0.25]], "norm")
    found, mended, scatter = index(stated)
    sample = sobol.sample(stated, 1024, calc_second_order=False, seed=1)
    total = shares.analyze(stated, law(sample), calc_second_order=False, seed=1)["ST"]
    print(f"a of {mean} +- 0.1: dgsm {found.round(3)}, sobol {total.round(3)}, by variances {mended.round(3)}, right {right.round(3)}")
    assert np.allclose(scatter, [0.1, 0.25], rtol=0.02)
    assert np.allclose(total, right, atol=0.02) and np.allclose(mended, right, atol=0.02)
    if expected:
        assert abs(found[0] / expected - 1) < 0.02 and found[1] < 0.1
reached = morris.sample(problem([[10.0, 0.1], [0.5, 0.25]], "norm"), 200, num_levels=4, seed=1)
print(f"morris, four levels of a normal input: {np.unique(reached[:, 0])}, infinite {np.isinf(reached).mean():.2f}")
assert abs(np.isinf(reached).mean() - 0.5) < 0.05
wide = np.sqrt(3) * np.array([0.1, 0.25])
even = problem([[10.0 - wide[0], 10.0 + wide[0]], [0.5 - wide[1], 0.5 + wide[1]]], "unif")
found, mended, _ = index(even)
print(f"uniform inputs of the same deviation: dgsm {found.round(3)}")
assert np.allclose(found, right * 12 / np.pi**2, rtol=0.02)
PROGRAM
