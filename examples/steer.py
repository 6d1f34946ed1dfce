"""A robot follows a figure of eight by what a camera shows, and robots that differ do.

``python steer.py`` draws the path of one into path.png.
``python steer.py --robots 100`` prints how many follow it, and how well.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np
from controllers import SCENARIO
from follower import Followed, Path, follow
from matplotlib.figure import Figure

from stickslip import Drive, Scenario, plot, simulate
from stickslip.control import Camera

CAMERA = Camera(frame_rate=30.0, latency=0.05, noise_x=3e-6, noise_heading=0.02)


def figure_of_eight(width: float = 4e-3) -> Path:
    """Make x = a sin u, y = a/2 sin 2u, from its crossing at the origin and back to it.

    `width` is 2 a, m: the figure is twice as wide as it is high, 3.05 widths long, and nowhere
    bent more than by a radius of 0.21 a.
    """
    u, half = np.linspace(0.0, 2.0 * np.pi, 361), 0.5 * width
    return Path(np.column_stack([half * np.sin(u), 0.5 * half * np.sin(2.0 * u)]))


def row(name: str, robots: Sequence[Followed]) -> str:
    """Return a row of the table; what a robot does once it is lost does not count in it."""
    times = [len(each.states) * each.period for each in robots if each.arrived]
    across = np.concatenate([each.across for each in robots])
    numbers = " | ".join(f"{1e6 * each:.0f}" for each in np.quantile(across, [0.5, 0.95, 1.0]))
    spans = "{:.1f} ({:.1f} to {:.1f})".format(*np.quantile(times or [np.nan], [0.5, 0.0, 1.0]))
    return f"| {name} | {len(times)} of {len(robots)} | {numbers} | {spans} |"


def main() -> None:
    """Draw the path of one robot, or print how many follow it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=0)
    count, eight = parser.parse_args().robots, figure_of_eight()
    if count:
        robots = enumerate(SCENARIO.draws(count, seed=2))
        seen = [follow(SCENARIO, eight, robot, camera=CAMERA, seed=k) for k, robot in robots]
        print("| by | followed | error, um | 95 % | largest | time, s |")
        print("| --- | --- | --- | --- | --- | --- |")
        print(row("camera", seen))
        return
    walk = follow(Scenario(drive=Drive(base=0.5e-3)), eight, camera=CAMERA, seed=1)
    drive = Drive(mode="program", program=walk.program())
    run = simulate(Scenario(drive=drive).replace({"record.rate": 1e3}))
    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    plot.path(run, along=eight.points, ax=figure.subplots())
    plot.save(figure, "path.png")


if __name__ == "__main__":
    main()
