#!/usr/bin/env bash
# Expected: `soundfile.write("log.wav", readings, rate)` of int32 readings stores them: reading them back as int32 gives
#   them, or else a refusal tells that the file's 16 bits are too few.
# What happens: a WAV or FLAC file has 16 bits by default and takes the upper ones: readings of 0 to 65535 come back as
#   0, of -1 to -65536 as -65536. Readings of 24-bit converters below 2^16 are gone, larger ones are steps of 65536. Of
#   floats, what lies beyond 1 is cut there: volts of 4 and 1.5 are read as 1. No warning.
# Package: soundfile 0.14.0 (libsndfile in its wheel). Source: libsndfile's scaling is documented, the loss is not told.
# Who is hurt: whoever stores vibration, currents or fields as sound files. Instead: subtype="PCM_32" for int32,
#   subtype="DOUBLE" for floats (both tried, bit for bit).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 cffi==2.1.1 soundfile==0.14.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import soundfile as sf

warnings.simplefilter("error")
counts = np.array([0, 1000, -1000, 40000, 65535, 2_000_000], dtype=np.int32)
volts = np.array([0.5, 1.5, 4.0, -4.0])


def back(name, readings, dtype, **options):
    sf.write(name, readings, 1000, **options)
    return sf.read(name, dtype=dtype)[0]


print("soundfile", sf.__version__, sf.__libsndfile_version__, "numpy", np.__version__)
for name in ("log.wav", "log.flac"):
    seen = back(name, counts, "int32")
    print(name, counts.tolist(), "are read as", seen.tolist())
    assert seen.tolist() == [0, 0, -65536, 0, 0, 30 * 65536]
seen = back("log.wav", volts, "float64")
print(volts.tolist(), "are read as", seen.tolist())
assert np.allclose(seen, [0.5, 1.0, 1.0, -1.0], atol=1e-4)
# instead
assert np.array_equal(back("log.wav", counts, "int32", subtype="PCM_32"), counts)
assert np.array_equal(back("log.wav", volts, "float64", subtype="DOUBLE"), volts)
PROGRAM
