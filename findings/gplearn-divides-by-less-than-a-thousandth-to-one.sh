#!/usr/bin/env bash
# Expected: symbolic regression finds y = x1 / x2, which has no unit, from lengths in metres as from lengths in mm.
# What happens: its `div` gives 1 where the divisor is below 0.001, `log` gives 0 there and `inv` 0. With lengths of 50
#   to 200 um in metres no quotient can be found: the score is below 0 where it is 1.0 in mm, and a found law that holds
#   a quotient jumps where its divisor passes 1 mm. No warning.
# Package: gplearn 0.4.3. Source: the documentation has protected functions and this number; what it costs in SI units
#   was found by trying.
# Who is hurt: whoever looks for a law of speeds, forces or inertias in SI units.
# Instead: scale the data to about 1 first (tried), or a division of your own by make_function (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-learn==1.9.1 gplearn==0.4.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import gplearn
import numpy as np
from gplearn.functions import _function_map, make_function
from gplearn.genetic import SymbolicRegressor

warnings.simplefilter("ignore", FutureWarning)
random = np.random.default_rng(0)
lengths = random.uniform(50.0, 200.0, (200, 2))  # um
ratio = lengths[:, 0] / lengths[:, 1]


def fit(scale, divide="div"):
    law = SymbolicRegressor(population_size=300, generations=4, function_set=("add", "sub", "mul", divide),
                            parsimony_coefficient=0.01, random_state=0)
    law.fit(lengths * scale, ratio)
    return float(law.score(lengths * scale, ratio)), str(law._program)


def _divide(x1, x2):
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(x2 != 0.0, x1 / x2, 1.0)


print("gplearn", gplearn.__version__, "numpy", np.__version__)
small = np.array([5e-4])
values = {name: float(_function_map[name](*[small] * _function_map[name].arity)[0]) for name in ("log", "inv")}
quotient = float(_function_map["div"](np.array([2e-4]), small)[0])
print("log and inv of 0.0005:", values, "; 0.0002 / 0.0005 =", quotient)
assert values == {"log": 0.0, "inv": 0.0} and quotient == 1.0
for unit, scale in (("mm", 1e-3), ("m", 1e-6)):
    score, program = fit(scale)
    print(f"in {unit}: score {score:.3f}, law {program[:60]}")
    assert score < 0.5 if unit == "m" else score > 0.999
# instead
score, program = fit(1e-6, make_function(function=_divide, name="quotient", arity=2))
print(f"in m with a division of one's own: score {score:.3f}")
assert score > 0.999
PROGRAM
