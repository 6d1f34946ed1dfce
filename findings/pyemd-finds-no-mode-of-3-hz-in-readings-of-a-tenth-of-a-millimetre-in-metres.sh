#!/usr/bin/env bash
# Expected: `EMD()` parts a record of 20 and 3 Hz on a slow swing into its modes, whatever the unit.
# What happens: sifting ends where what is left has a range below 0.001 or a sum of absolute values below 0.005, in the
#   record's own unit. In mm there are three modes and a rest; 0.1 mm and less in metres give the mode of 20 Hz alone,
#   and the rest holds all else. The sum of all is the record, so that the usual test passes. No warning.
# Package: EMD-signal 1.10.0 (PyEMD), numpy 2.3.5. Source: both numbers are documented, their unit is not.
# Who is hurt: whoever seeks slow modes or a trend of small motions in SI units; EEMD has the same test.
# Instead: the record over its standard deviation (tried); thresholds of 0 give five and six modes from 1 um on (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 scipy==1.17.1 EMD-signal==1.10.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from PyEMD import EMD
warnings.simplefilter("error")
print("EMD-signal", version("EMD-signal"), "numpy", np.__version__)
t = np.arange(1000) * 0.002
record = np.sin(2 * np.pi * 20 * t) + np.sin(2 * np.pi * 3 * t) + 0.5 * np.sin(2 * np.pi * 0.6 * t)


def modes(readings):
    """The frequencies of the modes, by their crossings of zero, and the rest's standard deviation."""
    sifted = EMD()
    sifted.emd(readings, t)
    found, rest = sifted.get_imfs_and_residue()
    assert np.allclose(found.sum(axis=0) + rest, readings, atol=1e-9 * abs(readings).max())
    crossings = [int(np.sum(np.diff(np.sign(mode)) != 0)) for mode in found]
    return [round(float(count / 2 / t[-1]), 1) for count in crossings], float(np.std(rest))


for scale in (1.0, 1e-3, 1e-4, 1e-6):
    (plain, rest), (scaled, _) = modes(scale * record), modes(scale * record / np.std(scale * record))
    print(f"readings of {scale:g}: modes of {plain} Hz, a rest of {rest / scale:.2f}; over their scatter {scaled} Hz")
    assert len(scaled) == 3 and abs(scaled[1] - 3.0) < 0.5
    assert plain == scaled if scale >= 1e-3 else len(plain) == 1 and rest > 0.7 * scale
PROGRAM
