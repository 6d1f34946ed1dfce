"""A short tour: both modes of driving at two frequencies, as a table, pictures and a film.

``python -m stickslip.demo`` writes to ``demo_output/`` in the current folder.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from stickslip._util.extras import MissingExtra
from stickslip.cli import BAD_INPUT, INTERRUPTED
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import Drive, Record
from stickslip.simulation.run import Run
from stickslip.simulation.simulate import simulate_batch

OUTPUT = Path("demo_output")

# The paper gives neither base, hold, edge nor clamp. With an in-plane base of zero the ramp would
# stand the body on end; these edges make both modes walk forwards at both frequencies.
_SETTINGS = {
    "IPP": {"base": 0.5e-3, "hold": 1.0e-3, "edge": "rise", "clamp": "down"},
    "OPP": {"base": 0.0, "hold": 2.5e-3, "edge": "fall", "clamp": "down"},
}
_FREQUENCIES = (30.0, 100.0)


def scenarios() -> list[Scenario]:
    """IPP and OPP at 30 Hz and 100 Hz, twelve pulses each."""
    return [
        Scenario(
            drive=Drive(mode=mode, frequency=frequency, pulses=12, **fields),  # type: ignore[arg-type]
            record=Record(rate=20e3),
        )
        for mode, fields in _SETTINGS.items()
        for frequency in _FREQUENCIES
    ]


def table(runs: list[Run]) -> str:
    """The summaries of the runs, one a row."""
    lines = [
        "mode  frequency  base  hold  edge  clamp  velocity  theta from       to  slip up  "
        "slip down  airborne",
        "             Hz    mT    mT                    mm/s     degrees  degrees     mm/s  "
        "     mm/s         %",
    ]
    for run in runs:
        drive, s = run.scenario.drive, run.summary()
        lines.append(
            f"{drive.mode:<4}  {drive.frequency:9g}  {drive.base * 1e3:4.1f}  "
            f"{drive.hold * 1e3:4.1f}  {drive.edge:<4}  {drive.clamp:<5}  "
            f"{s['mean_velocity'] * 1e3:8.4f}  {math.degrees(s['theta_min']):10.2f}  "
            f"{math.degrees(s['theta_max']):7.2f}  {s['slip_up'] * 1e3:7.4f}  "
            f"{s['slip_down'] * 1e3:9.4f}  {s['airborne_fraction'] * 100:8.2f}"
        )
    return "\n".join(lines)


def main() -> int:
    """Simulate, print the table, write film and pictures; 1 if a simulation failed.

    Raises
    ------
    MissingExtra
        If matplotlib is not installed, before anything is simulated.
    """
    from stickslip import plot

    runs = simulate_batch(scenarios())
    print(table(runs))
    OUTPUT.mkdir(exist_ok=True)
    print()
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
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except MissingExtra as error:
        print(f"stickslip: {error}", file=sys.stderr)
        sys.exit(BAD_INPUT)
