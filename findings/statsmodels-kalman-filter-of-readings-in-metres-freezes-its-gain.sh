#!/usr/bin/env bash
# Expected: a local level with stated variances (`UnobservedComponents(...).smooth([...])`) gives the same filtered and
#   smoothed positions for readings in micrometres and in metres.
# What happens: the filter takes its gain as settled once the square of the change of the forecast's variance is below
#   1e-19. Of readings of micrometres in metres that is so at the second one: the gain stays at 0.1 for 0.28, the level
#   is off by up to 4 um. No warning. A SARIMAX with one moving average does the same.
# Package: statsmodels 0.15.0. Source: `tolerance` is documented; its effect on small numbers was found by trying.
# Who is hurt: whoever filters or fits positions, masses or currents in SI units.
# Instead: model.ssm.tolerance = 0 (tried), or readings scaled to about 1 (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 patsy==1.0.3 formulaic==1.2.2 statsmodels==0.15.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import statsmodels
from statsmodels.tsa.api import UnobservedComponents

warnings.simplefilter("error", UserWarning)
print("statsmodels", statsmodels.__version__, "numpy", np.__version__)
random = np.random.default_rng(0)
readings = np.cumsum(random.normal(size=200)) + 3.0 * random.normal(size=200)  # um


def level(unit, tolerance=None):
    model = UnobservedComponents(readings * unit, "llevel")
    if tolerance is not None:
        model.ssm.tolerance = tolerance
    seen = model.smooth([9.0 * unit**2, unit**2])
    return (seen.filtered_state[0] / unit, seen.smoothed_state[0] / unit, seen.filter_results.kalman_gain[0, 0])


right = level(1.0)
for name, unit in (("um", 1.0), ("1e-5", 1e-5), ("m", 1e-6)):
    filtered, smoothed, gain = level(unit)
    off, drag = np.abs(filtered - right[0])[10:].max(), np.abs(smoothed - right[1])[10:].max()
    print(f"in {name}: gains {gain[[1, 2, 3, 50]].round(3).tolist()}, filtered level off by {off:.2f} um, smoothed by "
          f"{drag:.2f} um")
    if name == "m":
        assert np.ptp(gain[1:]) < 1e-9 and abs(gain[-1] - 0.1) < 1e-3 and off > 1.0 and drag > 0.5
    if name == "um":
        assert abs(gain[-1] - 0.282) < 1e-3
    # instead
    mended = level(unit, tolerance=0.0)
    assert np.abs(mended[0] - right[0])[10:].max() < 0.1 and abs(mended[2][-1] - 0.282) < 1e-3
PROGRAM
