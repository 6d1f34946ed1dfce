"""Speed of a run in the whole plane beside that in one: `python -m bench plane`.

The reference run of `speed.py` (IPP at 100 Hz, 100 pulses, summaries only), straight ahead, which
is simulated in one plane, and with headings that are not. One process on one core; CPU time is the
median of calls through the Python interface, the headings measured in turn. Exit status 1 where the
whole plane is slower than is asked of it; a busy machine shows in the first row.
"""

from __future__ import annotations

import argparse
import math
import sys

from measure import cpu_seconds_in_turn, pin
from speed import REFERENCE, simulated_time, with_solver

import stickslip

ASKED = 200.0  # simulated seconds per CPU second at 30 degrees and rtol 1e-6
HEADINGS = (0.0, 30.0, 45.0, 90.0)  # degrees


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--rtol", type=float, default=1e-6)
    options = parser.parse_args()
    pin()
    reference = with_solver(REFERENCE, "tsit5", options.rtol)
    scenarios = [reference.replace({"drive.heading": math.radians(each)}) for each in HEADINGS]
    works = [lambda scenario=scenario: stickslip.simulate(scenario) for scenario in scenarios]
    costs = cpu_seconds_in_turn(works, options.repeats)
    speeds = [simulated_time(each) / cost for each, cost in zip(scenarios, costs, strict=True)]
    print(f"{'heading (degrees)':>17} {'simulated s / CPU s':>20} {'planar cost':>12}")
    for heading, speed in zip(HEADINGS, speeds, strict=True):
        print(f"{heading:17.0f} {speed:20.0f} {speeds[0] / speed:12.2f}")
    found = speeds[HEADINGS.index(30.0)]
    if options.rtol == 1e-6 and found < ASKED:
        sys.exit(f"at 30 degrees {found:.0f} simulated seconds a CPU second: {ASKED:.0f} are asked")


if __name__ == "__main__":
    main()
