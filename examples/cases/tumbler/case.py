"""The tilt of a tumbling robot in a vertical field: what is missing in a balance of moments?"""

import math
from pathlib import Path

import numpy as np

from stickslip import diagnose, read_measurement

result = diagnose(read_measurement(Path(__file__).with_name("measurement.toml")))
print(result.verdict.kind, *result.verdict.causes)
report = result.as_dict()
for name in ("recalibrated", "extended"):
    off = [row["reading"] - row[name] for row in report["conditions"]]
    error = math.degrees(np.sqrt(np.mean(np.square(off))))
    print(f"{name} model: {error:.1f} degrees off")
(table,) = report["channels"].values()
angle = report["parameters"]["misalignment.angle"]
gain = report["gain"]
before, after = (math.degrees(*gain[key].values()) for key in ("mae_before", "mae_after"))
print(f"noise of a reading: {math.degrees(table['median_sd']):.1f} degrees")
print(f"misalignment: {math.degrees(angle['value']):.0f} degrees")
print(f"held out: {before:.0f} -> {after:.1f} degrees")
print("the gain is certain:", gain["interval"][0] > 0)
for model in report["ranking"]:
    if model["probability"] > 2e-3:
        print(f"{model['candidate']:30} {model['probability']:.2f}")
