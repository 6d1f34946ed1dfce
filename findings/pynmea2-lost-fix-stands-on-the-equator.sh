#!/usr/bin/env bash
# Expected: an NMEA sentence without a fix, whose fields are empty, has no latitude: None or nan, as its altitude has.
# What happens: `latitude` and `longitude` are 0.0 and 0.0, a place in the sea, while altitude, speed and course are
#   None; the text in `lat` is empty. The mean of a log at 48.1 degrees with one lost fix in ten is 43.3. No warning.
# Package: pynmea2 1.19.0; pynmeagps 1.1.8 gives empty text. Source: found by trying; read in `dm_to_sd`.
# Who is hurt: whoever takes the way of a rover from a receiver's log in which a bridge or a tunnel stands.
# Instead: keep sentences with `lat` and with `is_valid` alone (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pynmea2==1.19.0 pynmeagps==1.1.8
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from functools import reduce
from importlib.metadata import version
from statistics import mean

import pynmea2
import pynmeagps

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("pynmea2", "pynmeagps")))


def sentence(body):
    return f"${body}*{reduce(lambda check, letter: check ^ ord(letter), body, 0):02X}"


fix = "GPGGA,1235{:02d}.00,4807.0380,N,01131.0000,E,1,08,0.9,545.4,M,46.9,M,,"
lost = {"GGA": "GPGGA,123520.00,,,,,0,00,,,M,,M,,", "RMC": "GPRMC,123520.00,V,,,,,,,230394,,,N",
        "GLL": "GPGLL,,,,,123520.00,V,N"}
for name, body in lost.items():
    seen, other = pynmea2.parse(sentence(body)), pynmeagps.NMEAReader.parse(sentence(body) + "\r\n")
    rest = {key: getattr(seen, key, "-") for key in ("altitude", "spd_over_grnd", "true_course")}
    print(f"{name} without a fix: {seen.latitude}, {seen.longitude}, text {seen.lat!r}, {rest}, valid {seen.is_valid}; "
          f"pynmeagps {other.lat!r}")
    assert seen.latitude == seen.longitude == 0.0 and seen.lat == "" and not seen.is_valid and other.lat == ""
    assert all(value in (None, "-") for value in rest.values())
log = [pynmea2.parse(sentence(lost["GGA"] if second == 3 else fix.format(second))) for second in range(10)]
found = mean(row.latitude for row in log)
right = mean(row.latitude for row in log if row.lat and row.is_valid)
print(f"mean of ten fixes with one lost: {found:.3f} degrees, of those with a place {right:.3f}")
assert abs(found - 43.306) < 0.001 and abs(right - 48.1173) < 1e-6
PROGRAM
