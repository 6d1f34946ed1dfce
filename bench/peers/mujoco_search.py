"""Search for MuJoCo's settings: `PYTHONPATH=bench python -m peers.mujoco_search --seconds 300`.

Draws settings at random (with a seed), runs them on the tuning runs, and prints for each time step
the best by root-mean-square velocity error. Nothing of `python -m bench peers` depends on it.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from peers.mujoco_peer import Settings, simulate
from peers.problem import TUNING, problem_of
from peers.stickslip_side import exact_velocities

TIMESTEPS = (0.04, 0.02, 0.01)  # ms
SHOWN = 5


def draw(rng: np.random.Generator) -> Settings:
    """One set of settings; see `Settings` for units."""
    return Settings(
        timestep=float(rng.choice(TIMESTEPS)),
        stiffness_time=float(rng.choice([2.0, 3.0, 4.0, 6.0])),
        damping_ratio=float(rng.choice([0.7, 1.0, 2.0, 4.0])),
        impedance=float(rng.choice([0.9, 0.99, 0.999])),
        friction_impedance=float(rng.choice([1.0, 10.0, 100.0])),
        stick_speed=float(10.0 ** rng.uniform(-5.0, -3.0)),
        release_gap=float(10.0 ** rng.uniform(-6.0, -4.0)),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=300.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    problems = [problem_of(drive) for drive in TUNING]
    exact = exact_velocities(TUNING)
    found = []
    end = time.monotonic() + options.seconds
    while time.monotonic() < end:
        settings = draw(rng)
        velocities = np.array([simulate(problem, settings) for problem in problems])
        found.append((float(np.sqrt(np.mean((velocities / exact - 1.0) ** 2))), settings))
    found.sort(key=lambda pair: pair[0])
    for timestep in TIMESTEPS:
        mine = [pair for pair in found if pair[1].timestep == timestep]
        print(f"{timestep} ms: {len(mine)} tried")
        for error, settings in mine[:SHOWN]:
            print(f"  {error:.4f} {settings}")


if __name__ == "__main__":
    main()
