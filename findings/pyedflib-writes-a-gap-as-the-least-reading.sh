#!/usr/bin/env bash
# Expected: NaN and what lies outside the stated range are refused when an EDF file is written, and its length is kept.
# What happens: NaN is written as the physical minimum (-100 of +-100), 150 as 100, and a record that does not fill the
#   last second is filled with zeros: 25 readings at 10 Hz come back as 30. No word about any of it; 0 comes back as
#   0.0015, a step of the converter.
# Package: pyedflib 0.1.42 (edfio 0.4.18 refuses all three).
# Who is hurt: whoever keeps a tracker's or sensor's record with lost readings as EDF: they come back as real extremes.
# Instead: edfio, or a check before writing (tried below).
# Source: found by trying; that the last record is padded stands in the documentation of EDFlib.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pyEDFlib==0.1.42 edfio==0.4.18
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import importlib.metadata

import edfio
import numpy as np
import pyedflib

readings = np.concatenate([[0.0, np.nan, 150.0, -3.0], np.full(21, 1.0)])
header = {
    "label": "x", "dimension": "mm", "sample_frequency": 10, "physical_max": 100.0, "physical_min": -100.0,
    "digital_max": 32767, "digital_min": -32768, "transducer": "", "prefilter": "",
}
writer = pyedflib.EdfWriter("track.edf", 1, file_type=pyedflib.FILETYPE_EDFPLUS)
writer.setSignalHeaders([header])
writer.writeSamples([readings])
writer.close()
reader = pyedflib.EdfReader("track.edf")
read = reader.readSignal(0)
reader.close()
assert len(readings) == 25 and len(read) == 30
assert np.isfinite(read).all()
assert read[1] == -100.0 and read[2] == 100.0
assert np.allclose(read[25:], 0.0, atol=2e-3)
# instead
refused = []
for given in (readings[:10], np.full(10, 150.0), np.ones(25)):
    try:
        signal = edfio.EdfSignal(given, 10, label="x", physical_dimension="mm", physical_range=(-100, 100))
        edfio.Edf([signal])
    except ValueError as error:
        refused.append(str(error))
assert len(refused) == 3, refused
print("pyedflib", pyedflib.__version__, "edfio", importlib.metadata.version("edfio"), "numpy", np.__version__)
print("0, NaN, 150, -3 are read as", read[:4], "and 25 readings are", len(read))
PROGRAM
