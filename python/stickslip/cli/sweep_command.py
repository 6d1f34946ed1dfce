"""``stickslip sweep``."""

from __future__ import annotations

import math
from pathlib import Path

import click

from stickslip._util.files import NETCDF_SUFFIXES
from stickslip._util.text import json_text
from stickslip.cli.cluster import cluster
from stickslip.cli.common import JSON, PATH, SET, THREADS, draw, say, vary_option
from stickslip.cli.progress import ProgressBar
from stickslip.cli.settings import swept_points
from stickslip.cli.tables import sweep_as_dict, sweep_failure, sweep_table
from stickslip.cli.targets import (
    Inputs,
    check_different,
    check_plot,
    check_target,
    input_files,
    same_file,
)
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import known_keys
from stickslip.sweeping.points import Points
from stickslip.sweeping.run_sweep import sweep_points


@click.command(
    "sweep",
    epilog="\b\nExample:\n"
    "  stickslip sweep scenario.toml --vary drive.frequency=5:200:40 --vary drive.mode=IPP,OPP \\\n"
    "    --out sweep.nc --plot sweep.png",
)
@click.argument("scenario", type=PATH)
@vary_option(required=True)
@SET
@THREADS
@click.option("--dask", metavar="ADDRESS", help="Simulate on the workers of a Dask cluster.")
@click.option("--out", type=PATH, help="Write the results to a netCDF file.")
@click.option("--resume", is_flag=True, help="Go on with the sweep that --out holds, if any.")
@click.option(
    "--plot",
    type=PATH,
    help="Draw the mean velocities, lines over one number or a map over two: .png, .pdf, .svg and "
    "others.",
)
@JSON
def command(
    scenario: Path,
    vary: tuple[str, ...],
    settings: tuple[str, ...],
    threads: int | None,
    dask: str | None,
    out: Path | None,
    resume: bool,
    plot: Path | None,
    as_json: bool,
) -> int:
    """Simulate a SCENARIO (a TOML file) at all combinations of the values of some keys.

    Prints the summaries; what the scenario records is ignored. A point that fails is a status in
    the results: the command still succeeds, and says on standard error how many there are.

    --out is written every second or more rarely, and on Ctrl-C, so that --resume can go on with it
    after whatever stopped the sweep, without simulating a finished point again.
    The exit status is 1 if --plot had nothing to draw, as no point has a velocity.
    """
    points = swept_points(scenario, vary, settings)
    if resume and out is None:
        raise ScenarioError("--resume: allowed with --out only, the file to go on with")
    if dask is not None and threads is not None:
        raise ScenarioError("--threads: not allowed with --dask, whose workers are all used")
    inputs = input_files(scenario, settings)
    check_different({"--out": out, "--plot": plot})
    if out is not None:
        _check_out(out, resume, inputs)
    if plot is not None:
        _check_drawable(points)
        check_plot(plot, inputs)

    def kept(stage: str) -> str:
        there = out is not None and out.is_file()
        return f"--resume goes on with {out}" if there else "nothing written"

    bar = ProgressBar(points=points.count, kept=kept)
    try:
        with bar, cluster(dask) as executor:
            data = sweep_points(
                points, threads=threads, executor=executor, out=out, resume=resume, progress=bar
            )
    except (FileExistsError, PermissionError) as error:
        if error.errno:  # of the system, in the midst of the work
            raise
        raise ScenarioError(f"--out: {error}") from None
    try:
        drawn = plot is None or draw(plot, "velocity", data)
    finally:  # the table is printed even if a disk was full
        click.echo(json_text(sweep_as_dict(data)) if as_json else sweep_table(data))
        failure = sweep_failure(data)
        if failure:
            say(f"stickslip: {failure}", err=True)
    return 0 if drawn else 1


def _check_drawable(points: Points) -> None:
    """Say before a long sweep that it varies what `plot.velocity` cannot draw."""
    from stickslip.plot.velocities import MOST_LINES

    sizes = {key: size for key, size in zip(points.keys, points.shape, strict=True) if size > 1}
    lines = [size for key, size in sizes.items() if known_keys()[key].kind == "word"]
    numbers = len(sizes) - len(lines)
    if not (numbers == 1 and math.prod(lines) <= MOST_LINES) and not (numbers == 2 and not lines):
        raise ScenarioError(
            f"--plot: allowed with one --vary of numbers, and others of words for at most "
            f"{MOST_LINES} lines; or with two of numbers"
        )


def _check_out(out: Path, resume: bool, inputs: Inputs) -> None:
    """Say before a long sweep what could not be written after it."""
    if not out.is_file() or any(same_file(out, read) for read in inputs.values()):
        check_target("--out", out, inputs, NETCDF_SUFFIXES)
    elif not resume:
        raise ScenarioError(
            f"--out: {out} is already there; --resume goes on with it, and another name begins anew"
        )
