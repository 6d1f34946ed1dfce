#!/usr/bin/env bash
# Expected: trees fit readings in metres as they fit the same readings in mm or um, since they only compare values.
# What happens: XGBoost takes no split that gains less than 1e-6, in the square of the reading's unit, and calculates
#   in 32 bits: of readings around 1 it explains all, of 1e-3 0.99, of 1e-4 0.66, and of 1e-6 nothing, the prediction is one
#   constant. scikit-learn's trees and forests do so below a variance of 2e-16, readings of 1e-9 kg.
#   LightGBM is right at all scales. No warning.
# Package: xgboost 3.2.0, scikit-learn 1.9.1, lightgbm 4.7.0, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever learns displacements in metres, masses of mg in kg or forces of nN in N.
# Instead: TransformedTargetRegressor(..., transformer=StandardScaler()) (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-learn==1.9.1 lightgbm==4.7.0 xgboost==3.2.0
cd "$folder"
export OMP_NUM_THREADS=1
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from lightgbm import LGBMRegressor
from sklearn.compose import TransformedTargetRegressor
from sklearn.ensemble import RandomForestRegressor  # codespell:ignore ensemble
from sklearn.preprocessing import StandardScaler
from sklearn.tree import DecisionTreeRegressor
from xgboost import XGBRegressor

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("xgboost", "scikit-learn", "lightgbm", "numpy")))
settings = np.random.default_rng(0).uniform(size=(1000, 2))
readings = np.sin(6 * settings[:, 0]) + settings[:, 1]
models = {
    "xgboost": XGBRegressor(n_jobs=1),
    "xgboost over the scatter": TransformedTargetRegressor(XGBRegressor(n_jobs=1), transformer=StandardScaler()),
    "one tree": DecisionTreeRegressor(),
    "a forest": RandomForestRegressor(20, random_state=0),
    "a forest over the scatter": TransformedTargetRegressor(
        RandomForestRegressor(20, random_state=0), transformer=StandardScaler()),
    "lightgbm": LGBMRegressor(verbose=-1, n_jobs=1),
}
explained, different = {}, {}
scales = (1.0, 1e-3, 1e-4, 1e-6, 1e-9)
for name, model in models.items():
    for scale in scales:
        model.fit(settings, scale * readings)
        found = np.asarray(model.predict(settings), float)
        explained[name, scale] = 1.0 - np.mean((found - scale * readings) ** 2) / np.var(scale * readings)
        different[name, scale] = len(np.unique(found))
    print(f"{name}: explained at", ", ".join(f"{scale:g}: {explained[name, scale]:.3f}" for scale in scales))
right = "lightgbm", "xgboost over the scatter", "a forest over the scatter"
assert all(explained[name, scale] > 0.98 for name in right for scale in scales)
assert explained["xgboost", 1.0] > 0.99 and 0.3 < explained["xgboost", 1e-4] < 0.9
assert different["xgboost", 1e-6] == 1 and abs(explained["xgboost", 1e-6]) < 1e-3
for name in ("one tree", "a forest"):
    assert explained[name, 1e-6] > 0.99 and different[name, 1e-9] == 1 and explained[name, 1e-9] < 0.01
print("at 1e-6 xgboost predicts one value, at 1e-9 so do the tree and the forest")
PROGRAM
