#!/usr/bin/env bash
# Expected: `optical_flow_tvl1` sees the same motion in grey values of 0 to 255 as in the same numbers as floats.
# What happens: uint8 is divided by 255, floats are taken as they are, and the weights of the method have the unit of
#   the brightness: a shift of 0.1 px of a smooth texture is 0.10 px in uint8 and 0.16 px in floats, 0.5 px is 0.59. No
#   warning. `optical_flow_ilk` is right in all.
# Package: scikit-image 0.26.0. Source: found by trying.
# Who is hurt: whoever subtracts a background or averages frames first, so that a film has become floats.
# Instead: divide by 255 (tried), or optical_flow_ilk (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pillow==13.0.0 tifffile==2026.3.3 imageio==2.38.1 networkx==3.6.1 lazy-loader==0.6 \
    packaging==26.4 scikit-image==0.26.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import skimage
from scipy import ndimage
from skimage.registration import optical_flow_ilk, optical_flow_tvl1

warnings.simplefilter("error")
print("scikit-image", skimage.__version__, "numpy", np.__version__)
random = np.random.default_rng(0)
texture = ndimage.gaussian_filter(random.normal(size=(120, 120)), 2.0, mode="wrap")
texture = 128.0 + 40.0 * texture / texture.std()


def picture(shift):
    moved = ndimage.shift(texture, (0.0, shift), order=5, mode="grid-wrap")
    return np.clip(np.round(moved), 0, 255).astype(np.uint8)


first = picture(0.0)
for shift in (0.05, 0.1, 0.5):
    second = picture(shift)
    seen = {}
    for name, scale in (("uint8", None), ("float of 0 to 255", 1.0), ("float of 0 to 1", 255.0)):
        pair = [image if scale is None else image / scale for image in (first, second)]
        flows = optical_flow_tvl1(*pair)[1], optical_flow_ilk(*pair)[1]
        seen[name] = [float(flow[30:-30, 30:-30].mean()) / shift for flow in flows]
    print(f"shift of {shift} px, share seen by tvl1 and ilk:",
          {name: [round(each, 2) for each in shares] for name, shares in seen.items()})
    assert abs(seen["uint8"][0] - 1.0) < 0.05 and seen["float of 0 to 255"][0] > 1.12
    assert all(abs(shares[1] - 1.0) < 0.07 for shares in seen.values())
    assert abs(seen["float of 0 to 1"][0] - 1.0) < 0.05  # instead
    if shift == 0.1:
        assert seen["float of 0 to 255"][0] > 1.5
PROGRAM
