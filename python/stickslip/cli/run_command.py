"""``stickslip run``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

import stickslip
from stickslip import _core
from stickslip._util.text import highest
from stickslip._util.units import handy
from stickslip.cli import options, output
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.scenario import Scenario, load_with
from stickslip.simulation.notes import shown_lines
from stickslip.simulation.quantities import NUMBERS
from stickslip.simulation.run import SUFFIXES, Run
from stickslip.simulation.seen_from_drive import VELOCITIES
from stickslip.simulation.simulate import simulate

# Ten samples a period of the fastest free swing, some 850 Hz at 2.5 mT, with margin; Hz.
_RATE = 2e4
# Chosen: at high frequencies a sawtooth's edge is then at most a fiftieth of a pulse wide.
_SAMPLES_PER_PULSE = 50
# Chosen: some 145 MB of arrays; of a longer run the picture and the file are coarser.
_MOST_SAMPLES = 1_000_000

# Chosen: a robot that moves by less than this part of its length, some 3 nm, stays: no camera sees
# it, and what is left is settling and rounding.
_STAYS = 1e-5
_MOTION = ("mean_velocity", "mean_velocity_y", "velocity_growth")

_MOVING = (".gif", ".webp", ".mp4")
_EVENTS = "\n".join(f"  {name:<10}  {meaning}" for name, meaning in _core.events.items())


@click.command(
    "run",
    help="""Simulate one SCENARIO (a TOML file) and print its summary.

    Velocity, angles and slip are those of the measuring window, which is printed with them: from
    the end of the third pulse to the end of the last; with a program of voltages, all of it.

    --out, --plot and --animate record on a uniform grid if the scenario's record.rate is "none".
    What --out recorded before Ctrl-C or a full disk stays in FILE.part. The exit status is 1 if the
    simulation failed or there was nothing to draw, with the reason on standard error.
    """,
    epilog=f"""\b
Events that the summary counts:
{_EVENTS}

\b
"stickslip init scenario.toml" writes a scenario with all keys; "stickslip keys" lists them.

\b
Example:
  stickslip run scenario.toml --set drive.frequency=30 --out run.nc --plot run.png""",
)
@click.argument("scenario", type=options.PATH)
@options.SET
@click.option(
    "--out",
    type=options.PATH,
    help="Write the recorded motion while the run goes on: .nc (netCDF; also .nc4, .h5) or .csv.",
)
@click.option(
    "--until",
    metavar="CONDITION",
    help='End where a condition is met, such as "x >= 3e-3"; of time (s), x, y, z (m), theta, '
    "heading (rad, from -pi to pi) or revolutions.",
)
@options.plot_option("the run")
@click.option(
    "--animate",
    type=options.PATH,
    help="Write a moving picture: .gif, .webp, or .mp4 where ffmpeg is installed.",
)
@click.option(
    "--start",
    type=click.FloatRange(0.0),
    metavar="SECONDS",
    help="Start of the time that --plot and --animate show.",
)
@click.option("--stop", type=click.FloatRange(0.0), metavar="SECONDS", help="End of that time.")
@click.option(
    "--slowdown",
    type=click.FloatRange(0.0, min_open=True),
    metavar="FACTOR",
    help="Seconds of --animate for one second of the motion; default: it lasts 10 s at most.",
)
@options.JSON
def command(
    scenario: Path,
    set: dict[str, Any],
    out: Path | None,
    until: str | None,
    plot: Path | None,
    animate: Path | None,
    start: float | None,
    stop: float | None,
    slowdown: float | None,
    as_json: bool,
) -> int:
    loaded, read = load_with(scenario, set)
    output.check_files(read, out=(out, SUFFIXES), plot=(plot, ()), animate=(animate, _MOVING))
    pictures = plot is not None or animate is not None
    _check_times(loaded, start, stop, pictures)
    if slowdown is not None and animate is None:
        raise click.UsageError("--slowdown: allowed with --animate only")
    if (pictures or out is not None) and loaded.record.rate == "none":
        loaded = loaded.replace({"record.rate": _rate(loaded)})
    if pictures:  # said before a long run
        with prefixed("--plot" if plot is not None else "--animate"):
            stickslip.plot.motion.check_drawable(loaded)
    if animate is not None:
        with prefixed("--animate", RuntimeError):
            stickslip.plot.moving.check_moving_format(animate)

    with output.progress_bar() as bar:
        run = simulate(loaded, progress=bar, until=until, out=out)
    # Before what may find a disk full: nobody simulates it again.
    if as_json:
        output.print_json(run.summary())
    else:
        output.print_rows(_rows(run))
    if not run.ok:
        output.say(f"stickslip: the simulation failed: {run.status}, {run.message}", err=True)

    done = run.ok and output.drawn("--plot", plot, output.save_plot("run", run, start, stop))
    with output.progress_bar() as bar:
        shown = (run, start, stop, slowdown)
        done &= output.drawn(
            "--animate", animate, lambda to: stickslip.plot.animation(*shown).save(to, bar)
        )
    return 0 if done else 1


def _check_times(
    scenario: Scenario, start: float | None, stop: float | None, pictures: bool
) -> None:
    """Refuse times outside the run, or times that nothing shows."""
    if (start is not None or stop is not None) and not pictures:
        raise click.UsageError("--start, --stop: allowed with --plot or --animate only")
    # The sum of the drive's parts has the rounding of each: 0.16999... s is 0.17 s.
    end = max(round(scenario.duration, 12), scenario.duration)
    first, last = start or 0.0, end if stop is None else stop
    if not first < last <= end:
        raise ScenarioError(
            f"--start, --stop: {first!r} to {last!r} s: allowed is a part of the run's "
            f"{highest(round(end, 12))} s"
        )


def _rate(scenario: Scenario) -> float:
    """The rate of a record that a picture or a file needs, Hz."""
    wanted = max(_RATE, _SAMPLES_PER_PULSE * scenario.pulse_rate)
    return min(wanted, _MOST_SAMPLES / scenario.duration)


def _rows(run: Run) -> Iterator[tuple[str, str]]:
    """The summary: names, values in SI units and in handier ones."""
    summary = run.summary()
    yield "status", run.status
    start, stop = summary["window_start"], summary["window_end"]
    way = math.hypot(summary["mean_velocity"], summary["mean_velocity_y"]) * (stop - start)
    stays = way < _STAYS * run.scenario.robot.length
    for name, (unit, _) in {**VELOCITIES, **NUMBERS}.items():
        across = name in (*VELOCITIES, "mean_velocity_y", "turning_speed")
        if name not in summary or (across and not run.scenario.whole_plane):
            continue
        still = stays and name in (*_MOTION, *VELOCITIES)
        yield name, _in_two_units(0.0 if still else summary[name], unit)
    if run.scenario.whole_plane:
        end = run.final_state
        for name, unit in {"x": "m", "y": "m", "heading": "rad"}.items():
            yield f"final {name}", _in_two_units(getattr(end, name), unit)
    window = f"over {summary['window_start']:.6g} to {summary['window_end']:.6g} s"
    yield "measured", window if math.isfinite(summary["mean_velocity"]) else "nothing"
    counts = {**summary["events"], "painleve": summary["painleve_events"]}
    there = [f"{kind} {count}" for kind, count in counts.items() if count]
    yield "events", ", ".join(there) or "none"
    for line in shown_lines(run.notes):
        yield "note", line


def _in_two_units(value: float, unit: str) -> str:
    factor, other = (100.0, "%") if unit == "1" else handy(unit)
    value += 0.0  # no negative zero
    in_si = f"{value:.6g} {unit}".removesuffix(" 1")
    return in_si if other == unit else f"{in_si:<20}  {value * factor:.5g} {other}"
