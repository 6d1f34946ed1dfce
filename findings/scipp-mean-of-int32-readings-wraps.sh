#!/usr/bin/env bash
# Expected: a mean of whole numbers is made in floats; a conversion that does not fit raises or wraps.
# What happens: `sum` and `mean` of int32 wrap: the mean of three readings of 2e9 is 5.7e8, a float, without a word. A
#   conversion of int32 that does not fit stops at 2147483647 (3 m are 2147483647 nm); one to a coarser unit rounds and
#   stays whole (1500 mm are 2 m), also for dates: 1.999 s is 00:00:02.
# Package: scipp 26.8.0.
# Who is hurt: whoever gives scipp a driver's int32 counts or stamps; NumPy's mean and conversions of dates do neither.
# Instead: `dtype="float64"` when the variable is made or converted (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipp==26.8.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import scipp as sc

counts = np.full(3, 2_000_000_000, dtype=np.int32)
held = sc.array(dims=["n"], values=counts, unit="counts")
assert counts.mean() == 2e9
mean = sc.mean(held)
assert mean.dtype == sc.DType.float64
assert np.isclose(mean.value, (6_000_000_000 - 2**32) / 3)
assert sc.sum(held).value == 6_000_000_000 - 2**32
far = sc.array(dims=["n"], values=np.array([3], dtype=np.int32), unit="m").to(unit="nm")
assert far.values.tolist() == [2**31 - 1]
whole = [int(sc.scalar(n, unit="mm").to(unit="m").value) for n in (499, 500, 1500, 2500, -500)]
assert whole == [0, 1, 2, 3, -1]
late = sc.datetimes(dims=["t"], values=[1999], unit="ms").to(unit="s").values[0]
assert late == np.datetime64(2, "s")
assert np.datetime64(1999, "ms").astype("M8[s]") == np.datetime64(1, "s")
# instead
assert sc.mean(held.to(dtype="float64")).value == 2e9
assert sc.scalar(1500, unit="mm").to(unit="m", dtype="float64").value == 1.5
print("scipp", sc.__version__, "numpy", np.__version__)
print("mean of three counts of 2e9:", mean.value, "; 3 m in nm:", far.values[0], "; 499, 500, 1500 mm in m:", whole[:3])
PROGRAM
