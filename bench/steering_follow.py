"""Robots that differ follow a figure of eight of 4 mm by what a camera shows.

`python -m bench steering` prints the table of docs/howto/steering.md.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path as File

import numpy as np
from controllers import drawn
from numpy.typing import NDArray

sys.path.append(str(File(__file__).resolve().parents[1] / "docs" / "examples"))

from steer import PULSE, STEP, follow

from stickslip import STATE_COLUMNS, Scenario, SimulationError, rollout
from stickslip.control import Path

Array = NDArray[np.float64]

LOST = 0.25e-3  # m; a robot one body length beside the path has lost it
ARRIVED = 50e-6  # m, from the end; a pulse and a half, and the error of the place expected
TURNED = 60  # pulses, after which every robot has turned from +x to the path
PLACE = [STATE_COLUMNS.index("x"), STATE_COLUMNS.index("y")]


@dataclass
class Outcome:
    """How one robot followed the path: its true distance across after each pulse, m; time, s."""

    across: Array
    time: float
    followed: bool  # to the end, and never lost


def judged(places: Array, path: Path) -> Outcome:
    """The outcome of places after each step, (steps, 2), m; NaN where the simulation failed."""
    progress, across = 0.0, []
    for place in places[len(PULSE) - 1 :: len(PULSE)]:
        if np.isnan(place).any():
            break
        progress, off = path.project(place, progress)
        across.append(abs(float(off)))
        if across[-1] > LOST:
            break
    followed = progress >= path.length - ARRIVED and across[-1] <= LOST
    return Outcome(np.array(across), STEP * len(PULSE) * len(across), bool(followed))


def closed_loop(robots: Sequence[Scenario], path: Path) -> list[Outcome]:
    """Every robot by what its own camera shows."""
    outcomes = []
    for index, robot in enumerate(robots):
        try:
            states, _ = follow(robot, path, np.random.default_rng(index))
        except SimulationError as error:
            print(f"robot {index}: {error}")
            outcomes.append(Outcome(np.empty(0), math.inf, False))
            continue
        outcomes.append(judged(states[:, PLACE], path))
    return outcomes


def open_loop(robots: Sequence[Scenario], path: Path) -> list[Outcome]:
    """Every robot by the voltages that took the one of Table II along the path."""
    _, voltages = follow(Scenario(), path, np.random.default_rng(0))
    found = rollout(robots, None, voltages, STEP, record=("x", "y"))
    return [judged(places, path) for places in found.states]


def row(name: str, outcomes: Sequence[Outcome]) -> str:
    """A row of the table; what a robot does once it is lost does not count in it."""
    off = 1e6 * np.concatenate([each.across for each in outcomes])
    times = [each.time for each in outcomes if each.followed]
    cells = [name, f"{len(times)} of {len(outcomes)}"]
    cells += [f"{each:.0f}" for each in np.quantile(off, [0.5, 0.95, 1.0])]
    later = [each.across[TURNED:].max(initial=0.0) for each in outcomes]
    cells.append(f"{1e6 * max(later):.0f}")
    spans = np.quantile(times or [math.nan], [0.5, 0.0, 1.0])
    cells.append("{:.1f} ({:.1f} to {:.1f})".format(*spans))
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=100)
    robots = drawn(parser.parse_args().robots, seed=2)
    path = Path.figure_of_eight(4e-3)
    print("| by | followed | error, um | 95 % | largest | after 0.6 s | time, s |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    print(row("camera", closed_loop(robots, path)))
    print(row("the voltages of another robot", open_loop(robots, path)))


if __name__ == "__main__":
    main()
