#!/usr/bin/env bash
# Expected: `save_csv` and `save_labelstudio` keep the order of points, so that column 0 of `numpy()` stays the head.
# What happens: "sleap" (the default) and "instances" bring the points in the order of the alphabet: column 0 is an arm.
#   "frames" adds a point "inst0" that nobody tracked. Label Studio's file comes back in an order that changes from run
#   to run of the program, with one film for each frame, so that `numpy()` is one frame of nine, and without tracks and
#   scores. "points", .slp and the analysis file keep the order. No warning.
# Package: sleap-io 0.9.5, pandas 3.1.1, h5py 3.16.0, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever tells head from tail by the number of a column: a robot seems to turn round between two files.
# Instead: format="points" or .slp (tried), or points taken by the names in `skeleton.node_names` (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 pandas==3.1.1 h5py==3.16.0 sleap-io==0.9.5
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import os
import subprocess
import sys
import warnings
from importlib.metadata import version

import numpy as np
import sleap_io

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("sleap-io", "pandas", "h5py", "numpy")))
names = ["head", "body", "arm"]
skeleton = sleap_io.Skeleton(list(names), name="robot")
video = sleap_io.Video(filename="film.mp4", open_backend=False)
track = sleap_io.Track("one")
points = np.random.default_rng(1).uniform(5.0, 90.0, (9, 3, 2))
frames = [
    sleap_io.LabeledFrame(video=video, frame_idx=place, instances=[sleap_io.PredictedInstance.from_numpy(
        point, skeleton=skeleton, point_scores=np.array([0.1, 0.2, 0.3]), score=0.9, track=track)])
    for place, point in enumerate(points)]
labels = sleap_io.Labels(frames)
assert np.allclose(labels.numpy()[:, 0], points, atol=1e-4)


def told(name, read):
    order = read.skeletons[-1].node_names
    print(f"{name}: points {order}, numpy() {read.numpy().shape}, {len(read.videos)} films, {len(read.tracks)} tracks, "
          f"first point of frame 0 at {read.numpy()[0, 0, 0].round(1)}, the head is at {points[0, 0].round(1)}")
    return order


for kind, expected in (("sleap", sorted(names)), ("instances", sorted(names)), ("points", names),
                       ("frames", sorted([*names, "inst0"]))):
    sleap_io.save_csv(labels, "robot.csv", format=kind)
    read = sleap_io.load_csv("robot.csv", format=kind)
    assert told(kind, read) == expected
    if kind != "frames":
        mended = read.numpy()[:, 0, [read.skeletons[-1].node_names.index(name) for name in names]]
        assert np.allclose(mended, points, atol=1e-4)
sleap_io.save_slp(labels, "robot.slp")
assert told(".slp", sleap_io.load_slp("robot.slp")) == names
sleap_io.save_analysis_h5(labels, "robot.analysis.h5")
assert told("analysis", sleap_io.load_analysis_h5("robot.analysis.h5")) == names

sleap_io.save_labelstudio(labels, "robot.json")
read = sleap_io.load_labelstudio("robot.json")
told("Label Studio", read)
assert read.numpy().shape[0] == 1 and len(read.videos) == 9 and len(read.tracks) == 0
again = "import sleap_io; print(*sleap_io.load_labelstudio('robot.json').skeletons[-1].node_names)"
orders = {subprocess.run([sys.executable, "-c", again], env={**os.environ, "PYTHONHASHSEED": str(seed)}, check=True,
                         capture_output=True, text=True).stdout.strip() for seed in range(1, 7)}
print("Label Studio in six runs of the program:", "; ".join(sorted(orders)))
assert len(orders) > 1
PROGRAM
