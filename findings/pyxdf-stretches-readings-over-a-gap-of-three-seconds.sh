#!/usr/bin/env bash
# Expected: an XDF file stores the time of each reading; where a recorder lost 3 s of a stream of 100 readings a second,
#   `load_xdf` shows a step of 3 s, as by default a break of one second starts a new piece.
# What happens: it must last a second and 500 readings, here 5 s. Below that one straight line is laid through all
#   times: the largest step is 0.011 s, times are off by up to 1.7 s, and a sine of 0.5 Hz has 0.455 Hz. No warning, as
#   the rate is still within a tenth of the nominal one. Only streams that call themselves video are left as they are.
# Package: pyxdf 1.17.5. Source: both limits are in the docstring. Who is hurt: whoever joins a sensor to a film so.
# Instead: dejitter_timestamps=False, or jitter_break_threshold_samples=1 (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pyxdf==1.17.5
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import logging
import struct
from importlib.metadata import version

import numpy as np
import pyxdf

RATE, LOST = 100.0, 3.0
said = []
handler = logging.Handler(logging.WARNING)
handler.emit = lambda record: said.append(record.getMessage())
logging.getLogger("pyxdf").addHandler(handler)


def chunk(tag, content):
    return b"\4" + struct.pack("<I", 2 + len(content)) + struct.pack("<H", tag) + content


def stored(times, readings, name):
    """An XDF file with one stream of a force sensor, each reading with its own time."""
    header = (f"<info><name>sensor</name><type>force</type><channel_count>1</channel_count>"
              f"<nominal_srate>{RATE}</nominal_srate><channel_format>double64</channel_format></info>")
    rows = b"".join(b"\x08" + struct.pack("<dd", t, v) for t, v in zip(times, readings))
    stream = struct.pack("<I", 1)
    with open(name, "wb") as file:
        file.write(b"XDF:")
        file.write(chunk(1, b"<info><version>1.0</version></info>"))
        file.write(chunk(2, stream + header.encode()))
        file.write(chunk(3, stream + b"\4" + struct.pack("<I", len(times)) + rows))
        for at in np.arange(times[0], times[-1], 5.0):  # the two clocks agree
            file.write(chunk(4, stream + struct.pack("<dd", at, 0.0)))
        footer = (f"<info><first_timestamp>{times[0]}</first_timestamp><last_timestamp>{times[-1]}</last_timestamp>"
                  f"<sample_count>{len(times)}</sample_count></info>")
        file.write(chunk(6, stream + footer.encode()))


def read(name, **options):
    said.clear()
    (stream,), _ = pyxdf.load_xdf(name, **options)
    return np.asarray(stream["time_stamps"]), stream["time_series"][:, 0], stream["info"]


t = 1000.0 + np.arange(6000) / RATE
t = t[(t < 1020.0) | (t >= 1020.0 + LOST)]
force = np.sin(2.0 * np.pi * 0.5 * t)
stored(t, force, "log.xdf")
seen, values, info = read("log.xdf")
assert np.array_equal(values, force) and not said, said
off = np.abs(seen - t)
gap = float(np.diff(seen).max())


def frequency(times):
    trial = np.linspace(0.4, 0.6, 801)
    return float(trial[np.argmax([abs(np.exp(-2j * np.pi * f * (times - 1000.0)) @ force) for f in trial])])


print("pyxdf", version("pyxdf"), "numpy", np.__version__)
print(f"largest step of time {gap:.4f} s (stored: {np.diff(t).max():.2f} s), off by {off.max():.2f} s at most")
print(f"frequency {frequency(seen):.3f} Hz (true: 0.5 Hz), rate said {info['effective_srate']:.2f}")
assert gap < 0.02
assert off.max() > 1.0
# instead
for options in ({"dejitter_timestamps": False}, {"jitter_break_threshold_samples": 1}):
    kept = read("log.xdf", **options)[0]
    print(f"{options}: off by {np.abs(kept - t).max():.0e} s")
    assert np.abs(kept - t).max() < 1e-6
assert frequency(seen) < 0.48
PROGRAM
