"""Put robots that differ to x = 3 mm, by the tables of a placer from 64 others.

``python controllers.py`` judges it by the exact state and by a camera.
"""

from __future__ import annotations

import argparse

import numpy as np

from stickslip import Drive, Scenario
from stickslip.control import Camera, Placed, Placer

PRIORS = {  # of friction, adhesion and drag
    "contact.kinetic_friction": {"mean": 0.145, "sd": 0.01},
    "contact.static_friction": {"mean": 0.2, "sd": 0.014},
    "contact.adhesion": {"mean": 0.22e-6, "sd": 0.03e-6},
    "drag.linear": {"low": 3e-6, "high": 3e-5},
    "drag.rotational": {"median": 9e-17, "factor": 2.0},
}
SCENARIO = Scenario(drive=Drive(base=0.5e-3), uncertain=PRIORS)
TOLERANCE = 2e-6  # m
CAMERAS = {
    "exact state": Camera(frame_rate=1000.0),
    "camera": Camera(frame_rate=30.0, latency=0.05, noise_x=3e-6),
}


def row(name: str, placed: Placed) -> str:
    """A row of the table."""
    time = np.quantile(np.nan_to_num(placed.time, nan=np.inf), [0.5, 0.9], method="higher")
    error = 1e6 * np.quantile(np.abs(placed.error), [0.5, 0.9])
    numbers = " | ".join(f"{number:.1f}" for number in (*time, *error))
    share, pulses = 100 * placed.within(TOLERANCE), np.median(placed.pulses)
    return f"| {name} | {numbers} | {share:.1f} % | {pulses:.0f} |"


def main() -> None:
    """Make the tables, and print what the placer reaches."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=256)
    robots = SCENARIO.draws(parser.parse_args().robots, seed=2)
    print("| by | time, s | 90 % | error, um | 90 % | within 2 um | single pulses |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, camera in CAMERAS.items():
        placer = Placer(SCENARIO, camera=camera, tolerance=TOLERANCE, seed=1)
        print(row(name, placer.put(robots, goal=3e-3)))


if __name__ == "__main__":
    main()
