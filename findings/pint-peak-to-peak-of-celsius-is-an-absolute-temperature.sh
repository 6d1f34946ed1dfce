#!/usr/bin/env bash
# Expected: the spread of readings in degC is a difference: 5 degC are 5 K, by `max - min`, `ptp`, `std` and `diff`
#   alike; and what makes no sense for degC is refused, as `2 * c` and `sum` are.
# What happens: `std` and `diff` are differences, but `ptp` has the unit degC, so that 5 degC become 278.15 K. `square`,
#   `prod`, `sqrt` and `reciprocal` are not refused, and the rms of 20, 21, 25 degC goes through as 295.26 K.
# Package: pint 0.25.3.
# Who is hurt: whoever states the range of a heater's log in K.
# Instead: `max() - min()`, or K before any arithmetic (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pint==0.25.3
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import pint

registry = pint.UnitRegistry()
warm = registry.Quantity(np.array([20.0, 21.0, 25.0]), "degC")
span = np.ptp(warm)
assert str(span.units) == "degree_Celsius" and np.isclose(span.to("K").magnitude, 278.15)
assert np.isclose(np.std(warm).to("K").magnitude, np.std([20.0, 21.0, 25.0]))
assert np.allclose(np.diff(warm).to("K").magnitude, [1.0, 4.0])
for refused in (lambda: 2 * warm, lambda: warm * warm, lambda: warm**2, lambda: np.sum(warm), lambda: 1 / warm):
    try:
        refused()
    except pint.OffsetUnitCalculusError:
        pass
    else:
        raise SystemExit("pint does not refuse it any more")
for taken in (np.square, np.prod, np.sqrt, np.reciprocal):
    taken(warm)
rms = np.sqrt(np.mean(np.square(warm)))
true = np.sqrt(np.mean((warm.to("K").magnitude) ** 2))
assert abs(rms.to("K").magnitude - true) > 0.05
# instead
right = warm.max() - warm.min()
assert np.isclose(right.to("K").magnitude, 5.0)
assert np.isclose(np.ptp(warm.to("K")).magnitude, 5.0)
print("pint", pint.__version__, "numpy", np.__version__)
print("ptp:", span, "is", span.to("K"), "; max - min:", right, "is", right.to("K"))
print("rms through square:", rms.to("K"), "of kelvins:", true)
PROGRAM
