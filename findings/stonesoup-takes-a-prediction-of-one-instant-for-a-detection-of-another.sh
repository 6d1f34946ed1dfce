#!/usr/bin/env bash
# Expected: a prediction of 1.0 s and a detection of 1.5 s are refused by the updater, or the prediction is moved on.
# What happens: the two are joined as of one instant, and the result has the detection's time: of a body that moves with
#   exactly 1 m/s, whose first detection comes half a step late, the position at 1.5 s is 1.34 m and the velocity 1.17.
#   A detection without a time gives a state without one. No warning; all updaters that were tried agree.
# Package: stonesoup 1.9.1, numpy 2.4.6. Source: found by trying.
# Who is hurt: whoever predicts to the frame and gets readings of a camera and a sensor with times of their own.
# Instead: predict to `detection.timestamp` (tried), as trackers and hypothesisers of the package do.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 ruamel.yaml==0.17.21 ordered-set==4.1.0 rtree==1.4.1 \
    pymap3d==3.2.0 utm==0.9.0 setuptools==80.9.0 stonesoup==1.9.1
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings
from datetime import datetime, timedelta
from importlib.metadata import version

import numpy as np
from stonesoup.models.measurement.linear import LinearGaussian
from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.types.detection import Detection
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.state import GaussianState
from stonesoup.updater.kalman import ExtendedKalmanUpdater, KalmanUpdater, UnscentedKalmanUpdater

warnings.simplefilter("error")
print(*(f"{name} {version(name)}" for name in ("stonesoup", "numpy")))
start = datetime(2026, 1, 1)
predictor = KalmanPredictor(CombinedLinearGaussianTransitionModel([ConstantVelocity(1e-6)]))
sensor = LinearGaussian(2, [0], np.array([[1e-4]]))


def updated(updater, seconds, stamped=True):
    """State after a detection at 1.5 s of a prediction for an instant."""
    time = start + timedelta(seconds=1.5) if stamped else None
    detection = Detection([[1.5]], timestamp=time, measurement_model=sensor)
    begin = GaussianState([[0.0], [1.0]], np.diag([1e-4, 1e-4]), timestamp=start)
    prediction = predictor.predict(begin, timestamp=start + timedelta(seconds=seconds))
    result = updater.update(SingleHypothesis(prediction, detection))
    return result.timestamp, *np.asarray(result.state_vector, float).ravel()


for kind in (KalmanUpdater, ExtendedKalmanUpdater, UnscentedKalmanUpdater):
    late, right = updated(kind(sensor), 1.0), updated(kind(sensor), 1.5)
    for name, seen in (("1.0 s", late), ("1.5 s", right)):
        print(f"{kind.__name__}, predicted to {name}: at {(seen[0] - start).total_seconds()} s {seen[1]:.3f} m, "
              f"{seen[2]:.3f} m/s")
    assert late[0] == right[0] and abs(right[1] - 1.5) < 1e-3 and abs(right[2] - 1.0) < 1e-3
    assert abs(late[1] - 1.335) < 0.01 and abs(late[2] - 1.167) < 0.01
bare = updated(KalmanUpdater(sensor), 1.5, stamped=False)
print(f"a detection without a time: time {bare[0]}")
assert bare[0] is None
PROGRAM
