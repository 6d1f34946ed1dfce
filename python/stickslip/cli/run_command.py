"""``stickslip run``."""

from __future__ import annotations

from pathlib import Path

import click

from stickslip._util.text import json_text
from stickslip.cli.common import JSON, PATH, SET, say
from stickslip.cli.progress import ProgressBar
from stickslip.cli.run_pictures import Pictures
from stickslip.cli.settings import read_with
from stickslip.cli.tables import summary_table
from stickslip.cli.targets import check_different, check_target, input_files
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import Scenario
from stickslip.simulation.run import SUFFIXES
from stickslip.simulation.simulate import simulate

# Ten samples a period of the fastest free swing, some 850 Hz at 2.5 mT, with margin; Hz.
_RATE = 2e4
# Chosen: at high frequencies a sawtooth's edge is then at most a fiftieth of a pulse wide.
_SAMPLES_PER_PULSE = 50
# Chosen: with fewer a sawtooth's edge is drawn in a wrong place, and whole slips are missed.
_FEWEST_PER_PULSE = 20
# Chosen: some 145 MB of arrays; of a longer run the picture and the file are coarser.
_MOST_SAMPLES = 1_000_000


@click.command(
    "run",
    epilog="""\b
Events that the summary counts:
  slip_start  a sticking contact slips
  stick       a slipping contact sticks
  reversal    a slip stops and goes on the other way
  lift_off    the last contact is lost
  touch_down  a corner meets the surface out of flight
  landing     a body on one corner comes to lie on a face
  tip         a body on a face goes to one corner
  roll_over   a body on one corner goes to the next at once, as the face between lands
  rebound     the second corner of a body on one corner meets the surface and bounces off
  painleve    a slip had no solution and was stopped by an impulse

\b
"stickslip init scenario.toml" writes a scenario with all keys; "stickslip keys" lists them.

\b
Example:
  stickslip run scenario.toml --set drive.frequency=30 --out run.nc --plot run.png""",
)
@click.argument("scenario", type=PATH)
@SET
@click.option(
    "--out",
    type=PATH,
    help="Write the recorded motion while the run goes on: .nc (netCDF; also .nc4, .h5) or .csv.",
)
@click.option(
    "--until",
    metavar="CONDITION",
    help='End where a condition is met, such as "x >= 3e-3"; of time (s), x, y, z (m), theta, '
    "heading (rad, from -pi to pi) or turns.",
)
@click.option("--plot", type=PATH, help="Draw the run: .png, .pdf, .svg and others.")
@click.option(
    "--animate",
    type=PATH,
    help="Write a moving picture: .gif, .webp, or .mp4 where ffmpeg is installed.",
)
@click.option(
    "--start",
    type=float,
    metavar="SECONDS",
    help="Begin of the time that --plot and --animate show.",
)
@click.option("--stop", type=float, metavar="SECONDS", help="End of that time.")
@click.option(
    "--slowdown",
    type=float,
    metavar="FACTOR",
    help="Seconds of --animate for one second of the motion; default: it lasts 10 s at most.",
)
@JSON
def command(
    scenario: Path,
    settings: tuple[str, ...],
    out: Path | None,
    until: str | None,
    plot: Path | None,
    animate: Path | None,
    start: float | None,
    stop: float | None,
    slowdown: float | None,
    as_json: bool,
) -> int:
    """Simulate one SCENARIO (a TOML file) and print its summary.

    Velocity, angles and slip are those of the measuring window, which is printed with them: from
    the end of the third pulse to the end of the last; with a program of voltages, all of it.

    --out, --plot and --animate record on a uniform grid if the scenario's record.rate is "none".
    What --out recorded before Ctrl-C or a full disk stays in FILE.part. The exit status is 1 if the
    simulation failed or there was nothing to draw, with the reason on standard error.
    """
    loaded = read_with(scenario, settings)
    pictures = Pictures(plot, animate, start, stop, slowdown)
    pictures.check_stretch(loaded)
    if out is not None or pictures.option:
        inputs = input_files(scenario, settings)
        check_different({"--out": out, "--plot": plot, "--animate": animate})
        if out is not None:
            check_target("--out", out, inputs, SUFFIXES)
        pictures.check_files(inputs)
        loaded = _with_record(loaded, pictures.option)
    if pictures.option:
        pictures.check_recorded(loaded)
    with ProgressBar() as bar:
        run = simulate(loaded, progress=bar, until=until, out=out)

    drawn = True
    try:
        drawn = pictures.draw(run)
    finally:  # the summary is printed even if a disk was full
        click.echo(json_text(run.summary()) if as_json else summary_table(run))
        if not run.ok:
            say(f"stickslip: the simulation failed: {run.status}, {run.message}", err=True)
    return 0 if run.ok and drawn else 1


def _with_record(scenario: Scenario, picture: str) -> Scenario:
    """The scenario with a uniform grid of its own or ours; notes on standard error.

    `picture` is the option that asks for a picture, "" if none does.
    """
    rate, pulsed = scenario.record.rate, scenario.drive.mode != "program"
    frequency = scenario.drive.frequency if pulsed else 0.0
    if rate == "none":
        wanted = max(_RATE, _SAMPLES_PER_PULSE * frequency)
        given = min(wanted, _MOST_SAMPLES / scenario.duration)
        if given < wanted:
            _note(
                f"{given:.4g} Hz in place of {wanted:.4g} Hz, as the run is long; "
                "set record.rate for another"
            )
        return scenario.replace({"record.rate": given})
    if rate == "events":
        if picture:
            raise ScenarioError(
                f'{picture}: record.rate = "events": allowed is a number of Hz or "none", '
                "as a curve needs a uniform grid"
            )
    elif pulsed and rate < _FEWEST_PER_PULSE * frequency:
        _note(
            f"{rate:g} Hz gives {rate / frequency:.3g} samples a pulse, which shows the motion "
            f'wrongly; {_FEWEST_PER_PULSE} or more are needed, or record.rate = "none"'
        )
    return scenario


def _note(text: str) -> None:
    say(f"stickslip: note: record.rate: {text}", err=True)
