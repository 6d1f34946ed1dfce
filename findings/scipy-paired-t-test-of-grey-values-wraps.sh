#!/usr/bin/env bash
# Expected: a statistic of whole numbers is made in floats: `ttest_rel` of grey values is that of the same floats.
# What happens: `ttest_rel` subtracts in uint8: five pairs that differ by -1 to -3 have t = 678, p = 3e-11, of the other
#   sign, where floats have t = -5.9, p = 0.004. `ttest_ind`, `wilcoxon`, `pearsonr` and `f_oneway` are right. `gmean`
#   of uint8 is made in half precision: 109 in place of 109.1.
# Package: scipy 1.17.1.
# Who is hurt: whoever compares frames, counts of an ADC or labels before and after, as the camera's library gave them.
# Instead: `.astype(float)` before a test (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import numpy as np
import scipy
from scipy import stats

before = np.array([100, 120, 130, 90, 110], dtype=np.uint8)
after = np.array([102, 121, 133, 92, 113], dtype=np.uint8)
wrapped = stats.ttest_rel(before, after)
assert wrapped.statistic > 600.0 and wrapped.pvalue < 1e-9
# instead
right = stats.ttest_rel(before.astype(float), after.astype(float))
assert np.isclose(right.statistic, -5.8797, atol=1e-3) and right.pvalue > 0.004
for test in (stats.ttest_ind, stats.wilcoxon, stats.f_oneway):
    assert np.isclose(test(before, after).statistic, test(before.astype(float), after.astype(float)).statistic)
assert stats.gmean(before).dtype == np.float16
assert abs(stats.gmean(before.astype(float)) - float(stats.gmean(before))) > 0.05
print("scipy", scipy.__version__, "numpy", np.__version__)
print(f"uint8: t = {wrapped.statistic:.1f}, p = {wrapped.pvalue:.2g}; floats: t = {right.statistic:.2f}, p = {right.pvalue:.2g}")
PROGRAM
