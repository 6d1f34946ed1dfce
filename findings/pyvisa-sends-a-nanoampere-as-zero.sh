#!/usr/bin/env bash
# Expected: `write_ascii_values("SOUR:LIST:CURR ", values)` sends the values, with the digits that they have.
# What happens: the default converter is "f", six decimals in whatever unit: 1e-9 and 4e-7 A are sent as 0.000000, 6e-7
#   as 0.000001 and 1.23456e-4 as 0.000123. With "d" 2.7 is cut to 2. `query_ascii_values` reads all digits, so that a
#   list read from an instrument and written back is another one. No warning.
# Package: pyvisa 1.16.2. Source: the default is documented, what it does to small values is not.
# Who is hurt: whoever sends a list of currents, fields or times in SI units to a source or a generator.
# Instead: converter=repr, or a format of one's own, lambda x: f"{x:.9e}" (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    pyvisa==1.16.2
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

from pyvisa.resources import MessageBasedResource

warnings.simplefilter("error")
print("pyvisa", version("pyvisa"))


class Line(MessageBasedResource):
    """A line that keeps what is written to it."""

    sent = b""

    def __init__(self):
        self._session = None

    def __del__(self):
        pass

    def write_raw(self, message):
        self.sent = message
        return len(message)

    def read(self, termination=None, encoding=None):
        return "1.000000E-09,4.000000E-07,1.234560E-04\n"


line = Line()


def sent(values, **options):
    line.write_ascii_values("SOUR:LIST:CURR ", values, **options)
    return line.sent.decode().split(" ")[1].strip()


currents = [1e-9, 4e-7, 6e-7, 1.23456e-4, 0.5]
plain, whole, fine = sent(currents), sent([2.7], converter="d"), sent(currents, converter=lambda x: f"{x:.9e}")
print("set: ", currents, "A")
print("sent:", plain, "; by repr:", sent(currents, converter=repr), "; with a format:", fine)
print('2.7 by "d":', whole)
read = line.query_ascii_values("SOUR:LIST:CURR?")
back = sent(read)
print("read:", read, "; written back:", back)
assert read == [1e-9, 4e-7, 1.23456e-4] and back == "0.000000,0.000000,0.000123"
assert [float(x) for x in sent(currents, converter=repr).split(",")] == currents
assert [float(x) for x in fine.split(",")] == currents and whole == "2"
assert plain == "0.000000,0.000000,0.000001,0.000123,0.500000"
PROGRAM
