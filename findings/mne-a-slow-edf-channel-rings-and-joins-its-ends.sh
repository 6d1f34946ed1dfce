#!/usr/bin/env bash
# Expected: a channel of 10 readings a second beside one of 100 keeps its own readings.
# What happens: with preload=True it is resampled by a Fourier method, as if the record were periodic, without a
#   warning. A temperature that steps or drifts from 20 to 80 reaches 11.5 and 88.5 and ends at 25. Read in parts, each
#   part has such ends (that is warned of).
# Packages: mne 1.13.2, edfio 0.4.18. Source: `read_raw_edf` documents the one rate; found by trying.
# Who is hurt: whoever reads slow sensors, flags or steps of a multi-rate recorder.
# Instead: read slow channels alone by exclude=, or with edfio (both tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 mne==1.13.2 edfio==0.4.18
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import edfio
import mne
import numpy as np

warnings.simplefilter("error")
mne.set_log_level("WARNING")
SECONDS = 60
fast = 50.0 * np.sin(np.arange(100 * SECONDS) / 7.0)
slow = {"step": np.where(np.arange(10 * SECONDS) < 300, 20.0, 80.0), "drift": np.linspace(20.0, 80.0, 10 * SECONDS)}
edfio.Edf([edfio.EdfSignal(values, values.size // SECONDS, label=name, physical_dimension="uV",
                           physical_range=(-100, 100)) for name, values in {"fast": fast, **slow}.items()]
          ).write("log.edf")
raw = mne.io.read_raw_edf("log.edf", preload=True)
seen = {name: raw.get_data(name)[0] * 1e6 for name in slow}
print("mne", mne.__version__, "edfio", edfio.__version__, "numpy", np.__version__)
for name, values in seen.items():
    print(f"{name} from 20 to 80: from {values.min():.1f} to {values.max():.1f}; first readings "
          f"{values[:3].round(1).tolist()}, last {values[-3:].round(1).tolist()}")
    assert values.size == 100 * SECONDS and abs(values[-1] - 80.0) > 40.0
assert seen["step"].min() < 12.0 and seen["step"].max() > 88.0
assert abs(seen["drift"][0] - 20.0) < 1.0 < abs(seen["drift"][1:10] - 20.0).max()
# instead
alone = mne.io.read_raw_edf("log.edf", exclude=["fast"], preload=True)
by_edfio = edfio.read_edf("log.edf")
for k, (name, values) in enumerate(slow.items()):
    assert alone.info["sfreq"] == 10.0 and np.allclose(alone.get_data(name)[0] * 1e6, values, atol=0.01)
    assert np.allclose(by_edfio.signals[1 + k].data, values, atol=0.01)
PROGRAM
