"""Films of a simulated robot, and measurement files of them, for the tests of tracking."""

import numpy as np

from made_measurement import write_files
from stickslip import Scenario
from stickslip.walker.exposure import CameraModel, record
from stickslip.walker.read_tracking import TrackingRun

NOISE = {"x": 5e-7, "theta": 5e-3, "current_x": 2e-3, "current_clamp": 2e-3}

NOMINAL = """stickslip = 1

[drive]
base = 0.5e-3
frequency = 30.0
pulses = 12
"""

HEAD = """stickslip_measurement = 1
name = "film"
scenario = "nominal.toml"

[uncertain]
"contact.kinetic_friction" = { mean = 0.145, sd = 0.01 }
"drag.linear" = { low = 3e-6, high = 3e-5 }
"""

TRUE = {"contact.kinetic_friction": 0.15, "drag.linear": 1.3e-5}
"""True constants of the filmed robot."""

ROBOT = Scenario().replace({"drive.base": 0.5e-3, "drive.frequency": 30.0, "drive.pulses": 12})


def noisy(frames, noise, random):
    """Frames with pixel noise of the standard deviations `noise`; others stay as they are."""
    return {
        name: values + noise.get(name, 0.0) * random.standard_normal(len(values))
        for name, values in frames.items()
    }


def film(changes, camera, rate, seed, names=("x", "theta"), noise=NOISE):
    """Columns of noisy frames of the nominal robot with `changes`, from the start of its drive."""
    scenario = ROBOT.replace(changes)
    times = np.arange(0.0, scenario.window[1], 1.0 / rate)
    shown = camera.frames(_motion(scenario), times, names)
    frames = noisy(shown, noise, np.random.default_rng(seed))
    frames["x"] = frames["x"] + 1e-4  # the origin of the pixels is nobody's
    return {"t": times, **frames}


def tracking_run(changes, rate, seed, exposure=3e-4, stated=True, drive=None, **more):
    """A run of the true robot with `changes` as the diagnosis takes it."""
    drive = drive or {}
    columns = film({**TRUE, **drive, **changes}, CameraModel(exposure), rate, seed, **more)
    noise = {"x": NOISE["x"], "theta": NOISE["theta"]} if stated else {}
    return TrackingRun("film.csv", columns, ROBOT.replace(drive), exposure, noise)


_MOTIONS = {}


def _motion(scenario):
    """Recorded at a rate that no fit uses, and much finer; once for all films of it."""
    key = scenario.to_toml()
    if key not in _MOTIONS:
        _MOTIONS[key] = next(record(scenario, [], np.zeros((1, 0)), 9e4, 1))
    return _MOTIONS[key]


def write_films(folder, rate, seed, marker):
    """A measurement of the true robot, each way with a camera of its own.

    What is tracked lies `marker` ahead of the centre of mass, m.
    """
    random, text, tables = np.random.default_rng([seed, 1]), HEAD, {}
    for number, (way, facing) in enumerate((("+x", 1.0), ("-x", -1.0))):
        own = [0.0, 0.0, 1.0] + [2e-4, 0.01, 0.005] * random.standard_normal(3)
        camera = CameraModel(3e-4, *own.tolist(), marker_along=marker, facing=facing)
        columns = film({**TRUE, "drive.direction": way}, camera, rate, [seed, 2, number])
        tables[f"run{number}"] = columns
        text += (
            f'\n[[tracking]]\nfile = "run{number}.csv"\nframe_rate = {rate}\nexposure = 3e-4\n'
            f"noise_x = {NOISE['x']}\nnoise_theta = {NOISE['theta']}\n"
            f'drive = {{ direction = "{way}" }}\n'
        )
    return write_files(folder, NOMINAL, text, **tables)
