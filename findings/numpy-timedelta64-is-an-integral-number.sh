#!/usr/bin/env bash
# Expected: a duration is no number: `isinstance(x, numbers.Integral)` is False, as for `datetime.timedelta`.
# What happens: numpy.timedelta64 is a subclass of numpy.signedinteger, which NumPy registers as Integral. A
#   duration passes a check for whole numbers as a count; numpy.datetime64 is no number.
# Package: numpy 2.2.6.
# Who is hurt: whoever checks arguments by `numbers.Integral` or `numbers.Real` and is given the difference of
#   two time stamps, for example of a logger's column.
# Instead: refuse numpy.timedelta64 before asking for a number (tried below).
# Source: found by trying; NumPy's documentation of scalars has the class hierarchy.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check numpy==2.2.6
"$folder/venv/bin/python" - <<'PROGRAM'
import datetime
import numbers

import numpy as np

step = np.timedelta64(3, "ms")
assert isinstance(step, numbers.Integral)
assert isinstance(step, numbers.Real)
assert issubclass(np.timedelta64, np.signedinteger)
assert not isinstance(np.datetime64("2026-01-01"), numbers.Number)
assert not isinstance(datetime.timedelta(milliseconds=3), numbers.Number)


def is_number(value):
    return isinstance(value, numbers.Real) and not isinstance(value, np.timedelta64)


assert not is_number(step)
assert is_number(np.int64(3))
assert is_number(np.float32(3.5))
print("numpy", np.__version__)
print(f"isinstance({step!r}, numbers.Integral):", isinstance(step, numbers.Integral))
PROGRAM
