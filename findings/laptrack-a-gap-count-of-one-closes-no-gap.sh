#!/usr/bin/env bash
# Expected: `gap_closing_max_frame_count=1` joins a track over one lost frame, as `memory=1` of trackpy does.
# What happens: it counts the steps over the gap: 1 closes nothing, as 0 does, and n lost frames need n + 1. Each robot
#   becomes two tracks at every lost frame, with no word; the default of 2 closes a single one.
# Packages: laptrack 0.17.1, trackpy 0.7, pandas 3.1.1. Source: found by trying.
# Who is hurt: whoever carries a setting over from trackpy: speeds and ranges are of half tracks.
# Instead: the number of lost frames plus one (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 trackpy==0.7 laptrack==0.17.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from importlib.metadata import version

import numpy as np
import pandas as pd
import trackpy as tp
from laptrack import LapTrack

warnings.simplefilter("error", UserWarning)
tp.quiet()


def table(lost):
    """Two robots that move by 0.5 px a frame; frames 7 to 6 + lost are missing."""
    frames = [f for f in range(20) if not 7 <= f < 7 + lost]
    return pd.DataFrame([(f, 20.0 * k + 0.5 * f, 0.0) for f in frames for k in range(2)], columns=["frame", "x", "y"])


def tracks(lost, count):
    by = LapTrack(cutoff=3.0**2, gap_closing_cutoff=3.0**2, gap_closing_max_frame_count=count)
    found = by.predict_dataframe(table(lost), ["x", "y"], frame_col="frame", only_coordinate_cols=False)[0]
    return int(found["track_id"].nunique())


def by_trackpy(lost, memory):
    return int(tp.link(table(lost), 3.0, memory=memory)["particle"].nunique())


print("laptrack", version("laptrack"), "trackpy", tp.__version__, "pandas", pd.__version__, "numpy", np.__version__)
for lost in (1, 2, 3):
    laps = {count: tracks(lost, count) for count in range(5)}
    pies = {memory: by_trackpy(lost, memory) for memory in range(5)}
    print(f"{lost} lost: tracks of two robots by gap_closing_max_frame_count {laps}, by trackpy's memory {pies}")
    assert laps == {count: 2 if count > lost else 4 for count in range(5)}
    assert pies == {memory: 2 if memory >= lost else 4 for memory in range(5)}
PROGRAM
