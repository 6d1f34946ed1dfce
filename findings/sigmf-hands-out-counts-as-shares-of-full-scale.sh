#!/usr/bin/env bash
# Expected: `read_samples()` of a recording of int16 counts gives these counts.
# What happens: counts are divided by their type's full scale and come as float32: 100 of int16 is 0.00305, of int8
#   0.78, and of unsigned types half of the scale is taken off first: 100 of uint8 is -0.22. Recordings of floats stay
#   as they are, so that one log stored in two types has two sizes. int32 counts lose their last digits. No warning.
# Package: sigmf 1.14.0. Source: the option `autoscale` of `fromfile` is documented; found by trying.
# Who is hurt: whoever reads sensors' counts from this format of radio recordings and has a calibration in counts.
# Instead: fromfile(..., autoscale=False) (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 sigmf==1.14.0
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import numpy as np
import sigmf

warnings.simplefilter("error", UserWarning)
scales = {"ri16_le": (np.int16, 2.0**15, 0.0), "ri8": (np.int8, 2.0**7, 0.0), "ru8": (np.uint8, 2.0**7, 1.0),
          "ru16_le": (np.uint16, 2.0**15, 1.0), "ri32_le": (np.int32, 2.0**31, 0.0), "rf32_le": (np.float32, 1.0, 0.0)}
print("sigmf", sigmf.__version__, "numpy", np.__version__)
for name, (kind, full, less) in scales.items():
    counts = np.array([0, 1, 100, 127], kind)
    counts.tofile("log.sigmf-data")
    made = sigmf.SigMFFile(data_file="log.sigmf-data", global_info={
        "core:datatype": name, "core:sample_rate": 1000, "core:version": "1.2.5"})
    made.add_capture(0)
    made.tofile("log.sigmf-meta", overwrite=True)
    seen = sigmf.fromfile("log.sigmf-meta").read_samples()
    print(f"{counts.tolist()} of {name} are read as {seen.tolist()}")
    assert np.allclose(seen, counts / full - less, atol=1e-9)
    assert seen.dtype == np.float32
    # instead
    assert np.array_equal(sigmf.fromfile("log.sigmf-meta", autoscale=False).read_samples(), counts)
PROGRAM
