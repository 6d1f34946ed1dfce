#!/usr/bin/env bash
# Expected: `np.unique(a)` costs at most what `np.unique(a, return_index=True)` does, which returns the same and more,
#   and a newer release is no slower.
# What happens: since 2.3 whole numbers without further results go through a table of hashes, where each new number has
#   memory of its own. Of 200 000 different ones `unique` takes six times as long as with `return_index`, forty times
#   as long as of the same numbers as floats, and over ten times as long as in 2.2.6. `setdiff1d`, by which rows are left
#   out, goes the same way: hundreds of times `np.delete`.
# Package: numpy 2.4.6 beside 2.2.6. Source: found by a profile.
# Who is hurt: whoever splits a long log by rows, indices or time stamps in counts, fold by fold.
# Instead: `np.delete(np.arange(n), rows)`, `np.flatnonzero(mask)`, `return_index=True`, or floats (all tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat > "$folder/costs.py" <<'EOF'
import time

import numpy as np


def cost(call):
    took = []
    for _ in range(7):
        begun = time.process_time()
        call()
        took.append(time.process_time() - begun)
    return sorted(took)[3]


n = 200_000
numbers = np.random.default_rng(0).permutation(n)
rows = np.arange(0, n, 10)
assert np.array_equal(np.setdiff1d(np.arange(n), rows), np.delete(np.arange(n), rows))
print(
    cost(lambda: np.unique(numbers)),
    cost(lambda: np.unique(numbers, return_index=True)),
    cost(lambda: np.unique(numbers.astype(float))),
    cost(lambda: np.setdiff1d(np.arange(n), rows)),
    cost(lambda: np.delete(np.arange(n), rows)),
)
EOF
for version in 2.2.6 2.4.6; do
    python3 -m venv "$folder/$version"
    "$folder/$version/bin/pip" install --quiet --no-compile --disable-pip-version-check "numpy==$version"
    "$folder/$version/bin/python" "$folder/costs.py" > "$folder/$version.txt"
    echo "numpy $version, s: unique, with places, of floats, setdiff1d, delete: $(cat "$folder/$version.txt")"
done
# Seen, in ms: 2.2.6 5.6, 33, 9.3, 14, 0.6; 2.4.6 122, 20, 2.8, 116, 0.4.
paste "$folder/2.2.6.txt" "$folder/2.4.6.txt" | tr '\t' ' ' | awk '{
    before = $1; plain = $6; places = $7; floats = $8; rest = $9; deleted = $10
    if (!(plain > 3 * before && plain > 2 * places && plain > 5 * floats && rest > 20 * deleted && $1 < $2)) exit 1
}'
