"""``stickslip sweep``."""

from __future__ import annotations

from pathlib import Path

import click

from stickslip._util.atomic_files import NETCDF_SUFFIXES
from stickslip._util.strict_json import json_text
from stickslip.cli.cluster import cluster
from stickslip.cli.common import JSON, PATH, SET, THREADS, say, vary_option
from stickslip.cli.progress import ProgressBar
from stickslip.cli.settings import swept_points
from stickslip.cli.tables import sweep_as_dict, sweep_failure, sweep_table
from stickslip.cli.targets import Inputs, check_target, input_files, same_file
from stickslip.errors import ScenarioError
from stickslip.sweeping.run_sweep import sweep_points


@click.command(
    "sweep",
    epilog="\b\nExample:\n"
    "  stickslip sweep scenario.toml --vary drive.frequency=5:200:40 --vary drive.mode=IPP,OPP \\\n"
    "    --out sweep.nc",
)
@click.argument("scenario", type=PATH)
@vary_option(required=True)
@SET
@THREADS
@click.option("--dask", metavar="ADDRESS", help="Simulate on the workers of a Dask cluster.")
@click.option("--out", type=PATH, help="Write the results to a netCDF file.")
@click.option("--resume", is_flag=True, help="Go on with the sweep that --out holds, if any.")
@JSON
def command(
    scenario: Path,
    vary: tuple[str, ...],
    settings: tuple[str, ...],
    threads: int | None,
    dask: str | None,
    out: Path | None,
    resume: bool,
    as_json: bool,
) -> None:
    """Simulate a SCENARIO (a TOML file) at all combinations of the values of some keys.

    Prints the summaries; what the scenario records is ignored. A point that fails is a status in
    the results: the command still succeeds, and says on standard error how many there are.

    --out is written after half a second, then every second or more, and on Ctrl-C, so that --resume
    can go on with it after whatever stopped the sweep, without simulating a finished point again.
    """
    points = swept_points(scenario, vary, settings)
    if resume and out is None:
        raise ScenarioError("--resume: allowed with --out only, the file to go on with")
    if dask is not None and threads is not None:
        raise ScenarioError("--threads: not allowed with --dask, whose workers are all used")
    if out is not None:
        _check_out(out, resume, input_files(scenario, settings))

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
    click.echo(json_text(sweep_as_dict(data)) if as_json else sweep_table(data))
    failure = sweep_failure(data)
    if failure:
        say(f"stickslip: {failure}", err=True)


def _check_out(out: Path, resume: bool, inputs: Inputs) -> None:
    """Say before a long sweep what could not be written after it."""
    if not out.is_file() or any(same_file(out, read) for read in inputs.values()):
        check_target("--out", out, inputs, NETCDF_SUFFIXES)
    elif not resume:
        raise ScenarioError(
            f"--out: {out} is already there; --resume goes on with it, and another name begins anew"
        )
