#!/usr/bin/env bash
# Expected: a scaled attribute that was read from a UBX message is the same bytes when it is written again.
# What happens: the value is divided by its scale and cut, not rounded: of headings of 0.00001 degrees every second is
#   written one unit nearer to zero and goes on: a log that is written ten times over is up to six units off. Of
#   dilutions of 0.01 one in eight changes, of latitudes of 0.0000001 degrees none. No warning.
# Package: pyubx2 1.4.0. Source: found by trying.
# Who is hurt: whoever edits a receiver's log or simulates a receiver, and compares bytes or takes differences.
# Instead: half a unit more in size before writing (tried), or the message's payload as it was read.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pyubx2==1.4.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

from pyubx2 import GET, UBXMessage, UBXReader

warnings.simplefilter("error")
print(f"pyubx2 {version('pyubx2')}")


def again(name, key, value, more=0.0):
    """The value of a message that is written and read."""
    return getattr(UBXReader.parse(UBXMessage("NAV", name, GET, **{key: value + more}).serialize()), key)


found = {}
for name, key, unit, digits, counts in (("NAV-PVT", "headMot", 1e-5, 5, range(1, 36000000, 35999)),
                                        ("NAV-DOP", "gDOP", 1e-2, 2, range(1, 2000)),
                                        ("NAV-PVT", "lat", 1e-7, 7, range(1, 900000000, 899999))):
    changed = mended = far = 0
    for count in counts:
        first = value = round(count * unit, digits)
        changed += round((value - again(name, key, value)) / unit) == 1
        mended += round((value - again(name, key, value, 0.5 * unit)) / unit) == 0
        for _ in range(10):
            value = again(name, key, value)
        far = max(far, round((first - value) / unit))
    found[key] = changed / len(counts), mended / len(counts), far
    print(f"{key}: {changed} of {len(counts)} one unit less, {far} units at most after ten times; with half a "
          f"unit more {len(counts) - mended} changed")
print(f"137.99498 as {again('NAV-PVT', 'headMot', 137.99498)}, 18.22 as {again('NAV-DOP', 'gDOP', 18.22)}")
assert 0.4 < found["headMot"][0] < 0.6 and found["headMot"][2] >= 4 and 0.08 < found["gDOP"][0] < 0.2
assert found["lat"][0] == 0 and all(mended == 1 for _, mended, _ in found.values())
PROGRAM
