#!/usr/bin/env bash
# Expected: attributes are dropped by arithmetic (as until 2025), or kept where they stay true.
# What happens: `units: mm` stays on x * x, x**2, 1 / x, x / 1000, x > 1, isnull, var, the count and the argmax; x / t
#   drops it where t has units of its own, but keeps mm where t has none. Derivatives and integrals drop it.
# Package: xarray 2026.9.0; version 2025.9.0 drops them in all these (tried below).
# Who is hurt: whoever hands results to a reader that converts by `units`: a speed is stated in mm, a variance in mm.
# Instead: `xr.set_options(keep_attrs=False)`, or units that are set anew after each step (tried below).
# Source: xarray's list of changes for late 2025 names the default; what it does to units was found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.3.5 pandas==2.3.3 xarray==2026.9.0
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps --target "$folder/old" xarray==2025.9.0
cd "$folder"
cat >program.py <<'PROGRAM'
import xarray as xr

x = xr.DataArray([1.0, 2.0, 4.0], dims="n", attrs={"units": "mm"})
stated = xr.DataArray([1.0, 2.0, 3.0], dims="n", attrs={"units": "s"})
bare = xr.DataArray([1.0, 2.0, 3.0], dims="n")
results = {
    "x * x": lambda: x * x,
    "x**2": lambda: x**2,
    "1 / x": lambda: 1 / x,
    "x / 1000": lambda: x / 1000,
    "x / t": lambda: x / bare,
    "x > 1": lambda: x > 1,
    "isnull": x.isnull,
    "var": x.var,
    "count": x.count,
    "argmax": lambda: x.argmax("n"),
}
for name, result in results.items():
    units = result().attrs.get("units")
    assert (units == "mm") is (xr.__version__ >= "2026"), (name, units)
assert "units" not in (x / stated).attrs
assert "units" not in x.assign_coords(n=bare).differentiate("n").attrs
with xr.set_options(keep_attrs=False):
    assert not any(result().attrs for name, result in results.items() if name != "isnull")
print("xarray", xr.__version__, "keeps mm on" if (xr.__version__ >= "2026") else "drops mm from", ", ".join(results))
PROGRAM
PYTHONPATH="$folder/old" "$folder/venv/bin/python" program.py
"$folder/venv/bin/python" program.py
