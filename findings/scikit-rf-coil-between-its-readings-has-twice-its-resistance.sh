#!/usr/bin/env bash
# Expected: a smooth coil, measured every 0.5 MHz, interpolates well: inductance and resistance to a per cent.
# What happens: `interpolate` draws straight lines between points of s, which lie on a circle, so that between readings
#   the coil has a loss that it has not: of 1 uH with 0.05 ohm the resistance is 0.098 ohm halfway at 1.25 MHz and 0.05 at
#   the readings, the quality 80 for 157; of 0.005 ohm it is ten times as large. The inductance is right to 0.1 %, and
#   the curve of s looks smooth. No warning. The deeper inside the plot, the less: at 50 MHz it is 0.051.
# Package: scikit-rf 2.2.0, numpy 2.4.6, scipy 1.17.1. Source: found by trying; the page advises to try coordinates.
# Who is hurt: whoever takes losses and heating of a coil from a sweep brought to the frequencies of another.
# Instead: coords="polar", kind="cubic", or basis="z" (all tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 scikit-rf==2.2.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import skrf

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("scikit-rf", "numpy", "scipy")))
sweep, finer = skrf.Frequency(1, 101, 201, "MHz"), skrf.Frequency(1, 101, 401, "MHz")
omega = 2 * np.pi * finer.f


def coil(resistance, **options):
    """Resistance and inductance of a coil of 1 uH, interpolated to twice as many frequencies."""
    z = resistance + 2j * np.pi * sweep.f * 1e-6
    network = skrf.Network(frequency=sweep, s=((z - 50) / (z + 50))[:, None, None], z0=50)
    z = network.interpolate(finer, **options).z[:, 0, 0]
    return z.real, z.imag / omega


for resistance in (2.0, 0.05, 0.005):
    ohm, henry = coil(resistance)
    print(f"{resistance} ohm: at 1.00, 1.25, 1.50 and 50.25 MHz", ohm[[0, 1, 2, 197]].round(4),
          "quality at 1.25 MHz", (omega * henry / ohm)[1].round(1), "right", (omega * 1e-6)[1] / resistance)
    assert np.allclose(ohm[::2], resistance, rtol=1e-6) and np.allclose(henry, 1e-6, rtol=2e-3)
    assert 0.04 < ohm[1] - resistance < 0.05 and ohm[197] - resistance < 0.002
    for options in ({"coords": "polar"}, {"kind": "cubic"}, {"basis": "z"}):
        mended, _ = coil(resistance, **options)
        print("   instead", options, mended[[1, 3, 197]].round(5))
        assert abs(mended[5:] - resistance).max() < 0.004 * max(resistance, 0.05)
PROGRAM
