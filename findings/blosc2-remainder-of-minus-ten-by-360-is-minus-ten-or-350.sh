#!/usr/bin/env bash
# Expected: `a % 360` of a compressed array is that of numpy: -10 gives 350, whatever stands beside it.
# What happens: the remainder keeps the sign of the number divided, as in C: -10 % 360 is -10, 10 % -360 is 10, of whole
#   numbers and of floats; `//` rounds down as in numpy, and one `//` in the expression makes its `%` numpy's, too:
#   a % 360 + 0 is -10, a % 360 + 0 * (a // 360) is 350. Half of evenly spread headings are wrong, without a word.
#   `round` takes halves away from zero: 0.5 is 1 and 2.5 is 3, so that halves are rounded up by 0.5 on average.
# Package: blosc2 4.14.1, numexpr 2.14.2, numpy 2.4.6. Source: found by trying; the page of `remainder` calls it equal to
#   Python's % and links to numpy's, the page of `round` links to numpy's. numexpr itself agrees with numpy.
# Who is hurt: whoever wraps headings, phases and counts of an encoder in a long log that is kept compressed.
# Instead: a - 360 * (a // 360) on the compressed array, or numpy on a[:] (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 numexpr==2.14.2 blosc2==4.14.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import blosc2
import numexpr
import numpy as np

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("blosc2", "numexpr", "numpy")))
for kind in (int, float):
    heading = np.array([-10, 350, -370, 730], kind)
    stored = blosc2.asarray(heading)
    beside = (stored % 360 + 0 * (stored // 360))[:]
    instead = (stored - 360 * (stored // 360))[:]
    print(f"{np.dtype(kind)} {heading}: numpy {heading % 360}, blosc2 {(stored % 360)[:]}, beside // {beside}")
    assert (heading % 360 == [350, 350, 350, 10]).all()
    assert (numexpr.evaluate("heading % 360") == heading % 360).all()
    for expression in (stored % 360, stored % 360 + 0, blosc2.remainder(stored, 360), stored * 1 % 360):
        assert (expression[:] == [-10, 350, -10, 10]).all()
    assert ((blosc2.asarray(-heading) % -360)[:] == [10, -350, 10, -10]).all()
    assert ((stored // 360)[:] == heading // 360).all()
    assert (beside == heading % 360).all() and (instead == heading % 360).all()

many = np.random.default_rng(0).integers(-1000, 1000, 1_000_000)
share = float(np.mean((blosc2.asarray(many) % 360)[:] != many % 360))
print("wrong of headings between -1000 and 1000:", share)
assert abs(share - 0.5) < 0.01
halves = np.arange(1000) + 0.5
rounded = blosc2.round(blosc2.asarray(halves))[:]
print("halves: mean", halves.mean(), "numpy rounded", np.round(halves).mean(), "blosc2 rounded", rounded.mean())
assert np.round(halves).mean() == halves.mean() and rounded.mean() == halves.mean() + 0.5
PROGRAM
