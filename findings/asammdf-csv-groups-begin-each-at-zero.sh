#!/usr/bin/env bash
# Expected: the channels of a measurement keep their common time when they are exported; no value stands outside a
#   channel's record.
# What happens: `export("csv")` writes each group from its own 0: a channel that began 0.5 s late is 0.5 s early in its
#   file. `to_dataframe` and `interp` hold the first and last value beyond a channel's record, not to be told from
#   readings; between them integers are held and floats interpolated.
# Package: asammdf 8.8.28.
# Who is hurt: whoever takes the lag between command and reading from the files of two groups.
# Instead: `time_from_zero=False`, or the channels with their own times by `get` (tried below). Source: found by trying.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 asammdf==8.8.28
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from pathlib import Path

warnings.simplefilter("ignore")
import asammdf
import numpy as np
from asammdf import MDF, Signal

with MDF(version="4.10") as log:
    log.append([Signal(np.array([0.0, 10.0, 20.0, 30.0]), np.array([0.0, 1.0, 2.0, 3.0]), name="command")])
    log.append([Signal(np.array([5.0, 6.0, 7.0]), np.array([0.5, 1.5, 2.5]), name="reading")])
    log.append([Signal(np.array([5, 6, 7], dtype=np.int16), np.array([0.5, 1.5, 2.5]), name="counts")])
    log.export("csv", "moved.csv")
    log.export("csv", "kept.csv", time_from_zero=False)
    table = log.to_dataframe()
    outside = log.get("reading").interp(np.array([-5.0, 99.0])).samples
    own = log.get("reading")


def first_times(name):
    files = sorted(Path(".").glob(name + "*.csv"))
    return [float(file.read_text().splitlines()[1].split(",")[0]) for file in files]


moved, kept = first_times("moved"), first_times("kept")
assert moved == [0.0, 0.0, 0.0], moved
assert outside.tolist() == [5.0, 7.0]
assert table.loc[0.0, "reading"] == 5.0 and table.loc[3.0, "reading"] == 7.0
assert table.loc[1.0, "reading"] == 5.5 and table.loc[1.0, "counts"] == 5
# instead
assert kept == [0.0, 0.5, 0.5], kept
assert own.timestamps.tolist() == [0.5, 1.5, 2.5]
print("asammdf", asammdf.__version__)
print("first times of the groups: exported", moved, "with time_from_zero=False", kept)
print("reading of 0.5 to 2.5 s, asked for -5 s and 99 s:", outside)
PROGRAM
