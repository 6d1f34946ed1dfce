#!/usr/bin/env bash
# Expected: a SEG-Y file keeps the interval between readings that `tools.from_array` was given, or refuses it.
# What happens: its header has whole microseconds in 16 bits with a sign, and what does not fit is cut without a word:
#   40 ms (and 100 ms, and 0.5 us) are read as the default of 4 ms, 1 s as 16.96 ms, 333.333 us as 333 us, which is 1 s
#   in a record of 17 minutes. 40 ms stand in the header as -25536. Up to 32.767 ms whole microseconds are right.
# Package: segyio 1.9.14, numpy 2.4.6. Source: the field's 16 bits are in the standard; what the reader does was tried.
# Who is hurt: whoever keeps slow records (a camera, a thermometer) beside geophones, or 3 kHz.
# Instead: the header's number modulo 65536 up to 65.535 ms (tried), or another format.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 segyio==1.9.14
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import segyio

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("segyio", "numpy")))
record = np.sin(0.1 * np.arange(200, dtype=np.float32))[None].repeat(2, axis=0)
for asked, expected in ((1000.0, 1000.0), (32767.0, 32767.0), (333.333, 333.0), (0.5, 4000.0), (40000.0, 4000.0),
                        (100000.0, 4000.0), (1e6, 16960.0)):
    segyio.tools.from_array("record.sgy", record, dt=asked)
    with segyio.open("record.sgy", ignore_geometry=True) as read:
        interval = segyio.tools.dt(read)
        stored = read.bin[segyio.BinField.Interval]
        in_trace = read.header[0][segyio.TraceField.TRACE_SAMPLE_INTERVAL]
        step = 1e3 * (read.samples[1] - read.samples[0])
        same = np.array_equal(read.trace.raw[:], record)
    print(f"asked for {asked:g} us: read {interval:g} us, samples {step:g} us apart, headers {stored} and {in_trace}, "
          f"readings the same: {same}")
    assert interval == expected and abs(step - expected) < 1.0 and same
    if asked == 40000.0:
        assert stored % 65536 == in_trace % 65536 == 40000
PROGRAM
