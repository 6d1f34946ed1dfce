#!/usr/bin/env bash
# Expected: of a spot that moves by 0.2 px along x each point gives (0, 0.2), as pyidi's table tells two translations.
# What happens: one difference of grey values is shared among the axes by the point's gradient, over the gradient's
#   length: where the edge stands at 45 degrees to the motion x is 0.10 for 0.20 and y 0.10 or -0.10 for 0, where it
#   lies along it both are 0. Of 0.02 px alike. No warning.
# Package: pyidi 1.4.0, numpy 2.4.6, scipy 1.17.1. Source: found by trying; its table says two translations.
# Who is hurt: whoever reads an axis of a motion from points that were not chosen by their gradient.
# Instead: `LucasKanade` (tried), or points whose gradient stands along the motion.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 numba==0.68.1 opencv-contrib-python==5.1.0.95 matplotlib==3.11.2 pyidi==1.4.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
from pyidi import LucasKanade, SimplifiedOpticalFlow, VideoReader

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("pyidi", "numpy", "scipy")))
y, x = np.mgrid[:80, :80].astype(float)
shifts = np.array([0.0, 0.02, 0.2])
film = np.array([120 + 100 * np.exp(-((y - 40) ** 2 + (x - 40 - shift) ** 2) / (2 * 8.0**2)) for shift in shifts])
points = np.array([[40, 48], [46, 46], [34, 46], [48, 40]])
places = ("edge across the motion", "edge at 45 degrees", "edge at -45 degrees", "edge along the motion")
part = np.array([[1.0, 0.0], [0.5, 0.5], [0.5, -0.5], [0.0, 0.0]])


def displacements(kind, **options):
    """(points, frames, y and x) in pixels."""
    method = kind(VideoReader(film, root="."))
    method.configure(**options)
    method.set_points(points)
    return method.get_displacements(autosave=False)


flow = displacements(SimplifiedOpticalFlow, reference_range=(0, 1), progress_bar=False)
right = displacements(LucasKanade, roi_size=(15, 15), verbose=0)
for place, by_flow, by_fit, share in zip(places, flow, right, part, strict=True):
    for frame in (1, 2):
        print(f"{place}, {shifts[frame]} px: x {by_flow[frame, 1]:.4f} y {by_flow[frame, 0]:.4f}, LucasKanade x "
              f"{by_fit[frame, 1]:.4f} y {by_fit[frame, 0]:.4f}")
        assert np.allclose(by_flow[frame, ::-1] / shifts[frame], share, atol=0.03)
        assert np.allclose(by_fit[frame, ::-1] / shifts[frame], [1.0, 0.0], atol=0.05)
PROGRAM
