#!/usr/bin/env bash
# Expected: `ZTopBottom(top=10, bottom=0, step=6)` stays between 0 and 10, and `ZRangeAround(range=4, step=3)` is as far
#   above the focus as below.
# What happens: the steps are counted from the bottom, their number is rounded: the stack is 0, 6 and 12, above its top;
#   with go_up=False it begins at 12. In steps of 3 it ends at 9. A range of 4 around the focus is -2 and 1 in steps of
#   3, -2 to 2.5 in steps of 1.5 and -2 to 5 in steps of 7, and its middle is not the focus. No warning.
# Package: useq-schema 0.9.2, pydantic 2.12.5. Source: found by trying.
# Who is hurt: whoever sets the top by what the objective must not touch, or takes a height from a stack's middle.
# Instead: a step that divides the range (tried), or ZAbsolutePositions and ZRelativePositions (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 pydantic==2.12.5 useq-schema==0.9.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import useq

warnings.simplefilter("error")
print("useq-schema", version("useq-schema"), "pydantic", version("pydantic"))


def places(plan):
    return [round(float(z), 9) for z in plan]


for step, last in ((3.0, 9.0), (4.0, 8.0), (6.0, 12.0), (1.5, 10.5), (2.5, 10.0)):
    up = places(useq.ZTopBottom(top=10.0, bottom=0.0, step=step))
    down = places(useq.ZTopBottom(top=10.0, bottom=0.0, step=step, go_up=False))
    print(f"0 to 10 um in steps of {step} um: ends at {up[-1]}, downwards begins at {down[0]}")
    assert up[0] == 0.0 and up[-1] == last and down == up[::-1]
for step, last in ((3.0, 1.0), (1.5, 2.5), (0.3, 1.9), (7.0, 5.0), (1.0, 2.0)):
    stack = places(useq.ZRangeAround(range=4.0, step=step))
    print(f"4 um around the focus in steps of {step} um: {stack[0]} to {stack[-1]}, middle "
          f"{(stack[0] + stack[-1]) / 2:.2f}")
    assert stack[0] == -2.0 and stack[-1] == last
assert places(useq.ZRelativePositions(relative=[-1.5, 0.0, 1.5])) == [-1.5, 0.0, 1.5]
assert places(useq.ZAbsolutePositions(absolute=[0.0, 5.0, 10.0])) == [0.0, 5.0, 10.0]
PROGRAM
