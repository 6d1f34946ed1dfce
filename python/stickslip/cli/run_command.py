"""``stickslip run``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip.cli.json_text import json_text
from stickslip.cli.progress import progress_bar
from stickslip.cli.settings import with_settings
from stickslip.cli.summary_table import summary_table
from stickslip.errors import ScenarioError
from stickslip.files import check_writable
from stickslip.scenario import Scenario

if TYPE_CHECKING:
    from stickslip.run import Run

# Ten samples a period of the fastest free swing, some 850 Hz at 2.5 mT, with margin.
_RATE = 2e4
_SAMPLES_PER_PULSE = 50
# Of a run longer than this allows, the picture and the file are coarser.
_MOST_SAMPLES = 1_000_000


@click.command(
    "run",
    epilog="\b\nExample:\n"
    "  stickslip run scenario.toml --set drive.frequency=30 --out run.nc --plot run.png",
)
@click.argument("scenario", type=click.Path(path_type=Path))
@click.option(
    "--set", "settings", multiple=True, metavar="KEY=VALUE", help="Change a key; repeatable."
)
@click.option(
    "--out", type=click.Path(path_type=Path), help="Write the recorded motion to a netCDF file."
)
@click.option(
    "--plot", type=click.Path(path_type=Path), help="Draw the run: .png, .pdf, .svg and others."
)
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object.")
def command(
    scenario: Path, settings: tuple[str, ...], out: Path | None, plot: Path | None, as_json: bool
) -> int:
    """Simulate one SCENARIO (a TOML file) and print its summary.

    --out and --plot record on a uniform grid if the scenario's record.rate is "none". The exit
    status is 1 if the simulation failed, with the reason on standard error.
    """
    loaded = with_settings(Scenario.from_toml(scenario), settings)
    if out is not None or plot is not None:
        loaded = _with_record(loaded, for_plot=plot is not None)
        _check_targets(out, plot)
    run = _simulated(loaded)

    if out is not None:
        run.save(out)
    if plot is not None:
        from stickslip import plot as drawing

        drawing.save(drawing.run(run), plot)
    click.echo(json_text(run.summary()) if as_json else summary_table(run.summary()))
    if not run.ok:
        click.echo(f"stickslip: the simulation failed: {run.status}, {run.message}", err=True)
        return 1
    return 0


def _simulated(scenario: Scenario) -> Run:
    from stickslip.simulation import simulate

    with progress_bar("simulating") as show:
        return simulate(scenario, progress=show)


def _with_record(scenario: Scenario, for_plot: bool) -> Scenario:
    if scenario.record.rate == "none":
        rate = max(_RATE, _SAMPLES_PER_PULSE * scenario.drive.frequency)
        return scenario.replace({"record.rate": min(rate, _MOST_SAMPLES / scenario.duration)})
    if for_plot and scenario.record.rate == "events":
        raise ScenarioError(
            '--plot: record.rate = "events": allowed is a number of Hz or "none", '
            "as a curve needs a uniform grid"
        )
    return scenario


def _check_targets(out: Path | None, plot: Path | None) -> None:
    """Say before a long simulation what could not be written after it."""
    try:
        for path in (out, plot):
            if path is not None:
                check_writable(path)
    except OSError as error:
        raise ScenarioError(str(error)) from None
    if plot is not None:
        from stickslip.plot import check_format

        try:
            check_format(plot)
        except ValueError as error:
            raise ScenarioError(f"--plot: {error}") from None
        if out is not None and out.resolve() == plot.resolve():
            raise ScenarioError(f"--out and --plot: {out} cannot be both")
