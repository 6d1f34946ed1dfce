#!/usr/bin/env bash
# Expected: a step of ten deviations in 400 readings is found at its reading by an exact search (`Pelt`, `Dynp`).
# What happens: by default only each fifth reading is looked at: steps at 201 and 202 are found at 200, at 203 and 204
#   at 205, by Pelt, Dynp, Binseg, BottomUp and Window, with no word; a disturbance at 203 to 206 is one from 200 to
#   210. KernelCPD alone looks at all.
# Package: ruptures 1.1.10. Source: the parameter `jump` and its default of 5 are documented; what it costs was found by
#   trying.
# Who is hurt: whoever dates an event in a log, or takes the two sides' levels.
# Instead: jump=1 (tried), or KernelCPD (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 ruptures==1.1.10
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import ruptures

warnings.simplefilter("error")
random = np.random.default_rng(0)
noise = 0.1 * random.normal(size=400)


def found(readings, **options):
    each = {name: [int(k) for k in getattr(ruptures, name)(model="l2", **options).fit(readings).predict(n_bkps=1)][0]
            for name in ("Dynp", "Binseg", "BottomUp", "Window")}
    return {"Pelt": int(ruptures.Pelt(model="l2", **options).fit(readings).predict(pen=1.0)[0]), **each}


print("ruptures", version("ruptures"), "numpy", np.__version__)
for at, near in ((200, 200), (201, 200), (202, 200), (203, 205), (204, 205)):
    readings = noise + (np.arange(400) >= at)
    seen = found(readings)
    kernel = int(ruptures.KernelCPD().fit(readings).predict(n_bkps=1)[0])
    print(f"step at {at}: {seen}, KernelCPD {kernel}")
    assert set(seen.values()) == {near} and kernel == at
    # instead
    by_one = found(readings, jump=1)
    assert by_one["Pelt"] == by_one["Dynp"] == by_one["Binseg"] == at
bump = noise + 5.0 * ((np.arange(400) >= 203) & (np.arange(400) < 207))
seen = [int(k) for k in ruptures.Pelt(model="l2").fit(bump).predict(pen=1.0)]
print("disturbance from 203 to 206:", seen)
assert seen == [200, 210, 400]
assert [int(k) for k in ruptures.Pelt(model="l2", jump=1).fit(bump).predict(pen=1.0)] == [203, 207, 400]
PROGRAM
