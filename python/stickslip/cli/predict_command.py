"""``stickslip predict``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip._util.files import replacing
from stickslip._util.text import json_text
from stickslip.cli.common import (
    JSON,
    PATH,
    SET,
    THREADS,
    UNCERTAIN,
    WholeNumber,
    draw,
    say,
    vary_option,
)
from stickslip.cli.progress import ProgressBar
from stickslip.cli.settings import read_with, swept_points, with_uncertain_file
from stickslip.cli.tables import prediction_as_dict, prediction_failures, prediction_table
from stickslip.cli.targets import check_out_and_plot, input_files
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import known_keys
from stickslip.sweeping.files import write
from stickslip.sweeping.points import Points
from stickslip.sweeping.predict import DRAWS, predict

if TYPE_CHECKING:
    import xarray


@click.command(
    "predict",
    epilog="\b\nExample:\n"
    "  stickslip predict scenario.toml --uncertain measurement.toml \\\n"
    "    --vary drive.frequency=20:200:10 --out bands.csv --plot bands.png",
)
@click.argument("scenario", type=PATH)
@UNCERTAIN
@vary_option(required=False)
@SET
@click.option(
    "--draws",
    type=WholeNumber(2),
    default=DRAWS,
    show_default=True,
    help="Simulations of each point, all with other values of what is uncertain.",
)
@click.option("--seed", type=WholeNumber(0), default=0, show_default=True, help="Of the draws.")
@THREADS
@click.option("--out", type=PATH, help="Write the quantiles: .nc (netCDF; also .nc4, .h5) or .csv.")
@click.option("--plot", type=PATH, help="Draw velocities with bands: .png, .pdf, .svg and others.")
@JSON
def command(
    scenario: Path,
    uncertain: Path | None,
    vary: tuple[str, ...],
    settings: tuple[str, ...],
    draws: int,
    seed: int,
    threads: int | None,
    out: Path | None,
    plot: Path | None,
    as_json: bool,
) -> int:
    """Predict the summary of a SCENARIO (a TOML file) with error bars.

    Prints the quantiles of 10, 50 and 90 % over what is uncertain in it: values that are drawn
    from its [uncertain], or from that of another file. Draws that fail are in no quantile; how many
    there are is said on standard error, and the exit status is then 1.
    """
    points = swept_points(scenario, vary, settings) if vary else None
    base = read_with(scenario, settings) if points is None else points.scenario
    base = with_uncertain_file(base, uncertain, settings)
    if plot is not None:
        _check_drawable(points)
    check_out_and_plot(out, plot, input_files(scenario, settings, uncertain))

    columns = {} if points is None else points.columns
    varied = {key: values for key, (_, values) in columns.items()}
    with ProgressBar(points=draws * (1 if points is None else points.count)) as bar:
        found = predict(base, varied, draws, seed, threads=threads, progress=bar)
    drawn = True
    try:
        if out is not None:
            _save(found, out)
        if plot is not None:
            drawn = draw(plot, "velocity", found)
    finally:  # the table is printed even if a disk was full
        click.echo(json_text(prediction_as_dict(found)) if as_json else prediction_table(found))
        for failure in prediction_failures(found):
            say(f"stickslip: {failure}", err=True)
    return 1 if found.attrs["failed_draws"] or not drawn else 0


def _save(found: xarray.Dataset, path: Path) -> None:
    """Write the quantiles as netCDF, or as CSV whose headings name the units."""
    if path.suffix.lower() != ".csv":
        write(found, path)
        return
    from stickslip.sweeping.sweep_table import sweep_dataframe

    table = sweep_dataframe(found)
    units = table.attrs["units"].items()
    names = {name: f"{name} ({unit})" for name, unit in units if unit not in ("", "1")}
    with replacing(path) as temporary:
        table.rename(columns=names).to_csv(temporary, index=False)


def _check_drawable(points: Points | None) -> None:
    """Refuse what `plot.velocity` draws no bands of."""
    sizes = () if points is None else zip(points.keys, points.shape, strict=True)
    numbers = [key for key, size in sizes if size > 1 and known_keys()[key].kind != "word"]
    if len(numbers) != 1:
        raise ScenarioError("--plot: allowed with one --vary of numbers, and others of words")
