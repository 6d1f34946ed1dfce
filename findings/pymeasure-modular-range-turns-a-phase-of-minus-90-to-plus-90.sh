#!/usr/bin/env bash
# Expected: `modular_range(-90, [-180, 180])` is -90, as its docstring says of values in the range; 190 becomes -170.
# What happens: it is the value modulo the upper limit, always: -90 becomes 90, -10 becomes 170, 190 becomes 10 and 180
#   itself 0; 25 in 10 to 20 becomes 5, which is outside. `modular_range_bidirectional` leaves -90 and makes 10 of 190.
#   As the validator of a property the wrong number is sent to the instrument. No error, no warning.
# Package: pymeasure 0.16.0. Source: its docstring says otherwise; found by trying.
# Who is hurt: whoever writes the phase of a lock-in amplifier, or the angle of a stage, in -180 to 180 degrees.
# Instead: lower + (value - lower) % (upper - lower) as a validator of one's own (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.3.5 pandas==3.1.1 pint==0.25.3 pyvisa==1.16.2 pymeasure==0.16.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

from pymeasure.instruments import Instrument
from pymeasure.instruments.validators import modular_range, modular_range_bidirectional
from pymeasure.test import expected_protocol

warnings.simplefilter("error")
print("pymeasure", version("pymeasure"))
LIMITS = [-180, 180]


def own(value, limits):
    return limits[0] + (value - limits[0]) % (limits[1] - limits[0])


for value, plain, both, right in ((-90, 90, -90, -90), (-10, 170, -10, -10), (90, 90, 90, 90), (190, 10, 10, -170)):
    found = modular_range(value, LIMITS), modular_range_bidirectional(value, LIMITS), own(value, LIMITS)
    print(f"{value} in -180 to 180: modular_range {found[0]}, bidirectional {found[1]}, right {found[2]}")
    assert found == (plain, both, right)
assert modular_range(180, LIMITS) == 0 and modular_range(25, [10, 20]) == 5


class Amplifier(Instrument):
    def __init__(self, adapter, name="lock-in", **kwargs):
        super().__init__(adapter, name, includeSCPI=False, **kwargs)

    phase = Instrument.control("PHAS?", "PHAS %g", "Phase in degrees.", validator=modular_range, values=LIMITS)


with expected_protocol(Amplifier, [("PHAS 90", None)]) as device:
    device.phase = -90  # the protocol checks what is sent
print("phase = -90 sends: PHAS 90")
PROGRAM
