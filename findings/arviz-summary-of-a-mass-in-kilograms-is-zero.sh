#!/usr/bin/env bash
# Expected: `arviz.summary(draws)` is a table of numbers with the digits that their errors deserve.
# What happens: every number is rounded to three decimals, in whatever unit. A mass of 2e-9 kg and a magnetic moment of
#   3e-8 A m^2 have the mean 0.0, the deviation 0.0 and the interval 0.0 to 0.0, beside an r_hat of 1.0 and an ess of
#   2000, which say that all is well. These zeros are floats and go into files. No warning.
# Package: arviz 0.23.4, xarray 2026.9.0, numpy 2.4.6. Source: rounding is documented, by `round_to`.
# Who is hurt: whoever reports constants of micro-robots in SI units. Instead: round_to="none" (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 xarray==2026.9.0 xarray-einstats==0.9.1 arviz-stats==0.8.0 \
    arviz==0.23.4
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version
from pathlib import Path

import numpy as np

warnings.simplefilter("ignore", FutureWarning)
import arviz as az  # noqa: E402

random = np.random.default_rng(0)
draws = {
    "mass": 2e-9 * (1.0 + 0.05 * random.standard_normal((4, 500))),  # kg
    "moment": 3e-8 * (1.0 + 0.05 * random.standard_normal((4, 500))),  # A m^2
    "mu": 0.3 * (1.0 + 0.05 * random.standard_normal((4, 500))),
}
warnings.simplefilter("error")
table, whole = az.summary(draws), az.summary(draws, round_to="none")
print("arviz", version("arviz"), "numpy", np.__version__, "xarray", version("xarray"))
print(table.to_string())
for name in ("mass", "moment"):
    numbers = table.loc[name, ["mean", "sd", "hdi_3%", "hdi_97%", "mcse_mean"]]
    assert np.all(numbers == 0.0) and numbers.dtype == float
    assert table.loc[name, "r_hat"] == 1.0
assert abs(table.loc["mu", "mean"] - 0.3) < 0.002
table.to_csv("fit.csv")
assert "\nmass,0.0,0.0,0.0,0.0" in Path("fit.csv").read_text()
# instead
assert abs(whole.loc["mass", "mean"] - 2e-9) < 1e-11
print(whole[["mean", "sd"]].to_string())
PROGRAM
