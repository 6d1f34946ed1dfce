#!/usr/bin/env bash
# Expected: a normalised filter (NLMS) divides by the power of its input, so that it learns alike in mm and in metres.
# What happens: the power has eps added, by default 0.001 in the square of the reading's unit: readings around 1 and
#   0.01 are learnt without a rest, of 0.001 0.2 of the record is left after 3000 readings, of 1e-6 all of it; GNGD
#   leaves 0.8 from 0.01 on, AP all at 1e-6. RLS is right. The output is as smooth as it is small, no warning.
# Package: padasip 1.2.2, numpy 2.4.6. Source: eps is documented as a term for numerical stability.
# Who is hurt: whoever takes a known disturbance, hum or shake, out of a displacement in metres or a field in tesla.
# Instead: readings over their standard deviation (tried); eps=0.001 * variance for NLMS (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 padasip==1.2.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import padasip

warnings.simplefilter("error")
print("padasip", version("padasip"), "numpy", np.__version__)
shake = np.random.default_rng(0).normal(size=3003)
delayed = np.array([shake[i : i + 4] for i in range(3000)])
record = delayed @ [1.0, 0.5, -0.3, 0.2]


def left(kind, scale, **options):
    """What is left of the record at the end, as a share of it."""
    adaptive = kind(n=4, w="zeros", **options)
    _, error, _ = adaptive.run(scale * record, scale * delayed)
    return float(np.std(error[-300:]) / np.std(scale * record[-300:]))


filters = padasip.filters
shares = {}
for scale in (1.0, 0.01, 0.001, 1e-6):
    shares[scale] = {
        "NLMS": left(filters.FilterNLMS, scale, mu=0.5),
        "NLMS, eps of the variance": left(filters.FilterNLMS, scale, mu=0.5, eps=0.001 * scale**2),
        "GNGD": left(filters.FilterGNGD, scale, mu=0.5),
        "AP": left(filters.FilterAP, scale, mu=0.5),
        "RLS": left(filters.FilterRLS, scale, mu=0.99),
    }
    print(f"readings of {scale:g}: left", ", ".join(f"{name} {share:.3f}" for name, share in shares[scale].items()))
    assert shares[scale]["RLS"] < 0.01 and shares[scale]["NLMS, eps of the variance"] < 0.01
assert all(share < 0.01 for share in shares[1.0].values())
assert shares[0.01]["NLMS"] < 0.01 and 0.1 < shares[0.001]["NLMS"] < 0.4 and shares[0.01]["GNGD"] > 0.7
assert all(shares[1e-6][name] > 0.99 for name in ("NLMS", "GNGD", "AP"))
PROGRAM
