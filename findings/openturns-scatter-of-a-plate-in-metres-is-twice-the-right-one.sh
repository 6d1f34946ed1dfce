#!/usr/bin/env bash
# Expected: the first-order scatter of w t**3 / 12 does not depend on the unit of length, nor on whether the formula is
#   a text or a Python function.
# What happens: a `PythonFunction` has a gradient of differences over 2e-5 in any unit: of a plate 20 by 5 in mm the
#   scatter is 12.67 mm**4, in metres as in the text; of 20 um by 5 um in metres 29.24 for 12.67 um**4, with 0.995 of
#   it due to the thickness in place of 0.973. `SymbolicFunction` and sampling are right. Of sin(x / um) the slope at
#   0.5 um is -0.05 for 0.88. No warning: the mean is right to all digits.
# Package: openturns 1.27.post1, numpy 2.4.6. Source: found by trying; the page says finite differences, and no step.
# Who is hurt: whoever states the error of a stiffness, a field or a force of a micromachine in SI from a simulation.
# Instead: setGradient with CenteredFiniteDifferenceGradient and steps of the inputs' size (tried), or inputs in um.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 openturns==1.27.post1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
from importlib.metadata import version

import numpy as np
import openturns as turns

print(*(f"{name} {version(name)}" for name in ("openturns", "numpy")))


def section(sizes):
    return [sizes[0] * sizes[1] ** 3 / 12]


def propagated(function, unit):
    sizes = turns.JointDistribution([turns.Normal(20 * unit, 0.2 * unit), turns.Normal(5 * unit, 0.1 * unit)])
    moments = turns.TaylorExpansionMoments(turns.CompositeRandomVector(function, turns.RandomVector(sizes)))
    sampled = np.std(np.array(function(sizes.getSample(100000))))
    scatter = np.sqrt(moments.getCovariance()[0, 0])
    mean = moments.getMeanFirstOrder()[0]
    return scatter / unit**4, float(sampled / unit**4), mean / unit**4, moments.getImportanceFactors()[1]


seen = {}
for unit in (1.0, 1e-3, 1e-6):
    mended = turns.PythonFunction(2, 1, section)
    steps = turns.ConstantStep([1e-4 * 20 * unit, 1e-4 * 5 * unit])
    mended.setGradient(turns.CenteredFiniteDifferenceGradient(steps, mended.getEvaluation()))
    functions = {
        "text": turns.SymbolicFunction(["w", "t"], ["w * t^3 / 12"]),
        "Python": turns.PythonFunction(2, 1, section),
        "Python, steps given": mended,
    }
    for name, function in functions.items():
        turns.RandomGenerator.SetSeed(0)
        scatter, sampled, mean, share = seen[name, unit] = propagated(function, unit)
        print(f"unit {unit:g}, {name}: scatter {scatter:.3f}, sampled {sampled:.3f}, mean {mean:.3f}, thickness {share:.4f}")
        assert abs(sampled / 12.67 - 1) < 0.02 and abs(mean / 208.333 - 1) < 1e-4
        if (name, unit) != ("Python", 1e-6):
            assert abs(scatter / 12.6724 - 1) < 1e-3 and abs(share - 0.973) < 1e-3
assert seen["Python", 1e-6][0] > 29 and seen["Python", 1e-6][3] > 0.994
wave = turns.PythonFunction(1, 1, lambda x: [np.sin(x[0] / 1e-6)])
slope = wave.gradient([0.5e-6])[0, 0] * 1e-6
print("slope of sin(x / um) at 0.5 um:", slope, "right", np.cos(0.5))
assert abs(slope) < 0.1
PROGRAM
