"""A short tour: both modes of driving at two frequencies, as lines, pictures and a film.

``python -m stickslip.demo`` writes to ``demo_output/`` in the current folder.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import stickslip
from stickslip.cli import BAD_INPUT, FAILED, INTERRUPTED
from stickslip.extras import MissingExtra

OUTPUT = Path("demo_output")

# The paper gives neither base, hold, edge nor clamp. With an in-plane base of zero the ramp would
# stand the body on end; these edges make both modes walk forwards at both frequencies.
_SETTINGS = [
    {"drive.mode": mode, "drive.frequency": frequency, "drive.base": base, "drive.hold": hold}
    | {"drive.edge": edge, "drive.pulses": 12, "record.rate": 20e3}
    for mode, base, hold, edge in (("IPP", 0.5e-3, 1.0e-3, "rise"), ("OPP", 0.0, 2.5e-3, "fall"))
    for frequency in (30.0, 100.0)
]


def main() -> int:
    """Simulate, print a line for each run, write film and pictures; 1 if a simulation failed.

    Raises
    ------
    MissingExtra
        If matplotlib is not installed, before anything is simulated.
    """
    plot = stickslip.plot
    runs = stickslip.simulate_batch([stickslip.Scenario().replace(keys) for keys in _SETTINGS])
    for run in runs:
        drive, numbers = run.scenario.drive, run.summary()
        low, high = (math.degrees(numbers[name]) for name in ("theta_min", "theta_max"))
        print(
            f"{drive.mode} at {drive.frequency:3g} Hz: {numbers['mean_velocity'] * 1e3:.3f} mm/s, "
            f"pitch {low:.1f} to {high:.1f} degrees, {numbers['airborne_fraction']:.1%} in flight"
        )
    OUTPUT.mkdir(exist_ok=True)
    film = OUTPUT / "walk.webp"
    plot.animation(runs[0]).save(film)
    print(f"wrote {film.resolve()}")
    for run in runs:
        drive = run.scenario.drive
        path = OUTPUT / f"{drive.mode.lower()}_{drive.frequency:g}hz.png"
        plot.save(plot.run(run), path)
        print(f"wrote {path.resolve()}")
    failed = [run for run in runs if not run.ok]
    for run in failed:
        print(f"stickslip: {run.status}: {run.message}", file=sys.stderr)
    return FAILED if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except MissingExtra as error:
        print(f"stickslip: {error}", file=sys.stderr)
        sys.exit(BAD_INPUT)
