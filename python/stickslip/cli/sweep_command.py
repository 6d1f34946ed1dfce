"""``stickslip sweep``."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import stickslip
from stickslip.cli import options, output
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import load_with
from stickslip.simulation.notes import lines_of_json
from stickslip.simulation.quantities import ASKED
from stickslip.simulation.run import SUFFIXES
from stickslip.simulation.seen_from_drive import shown_velocities
from stickslip.sweeping.cluster import open_cluster

if TYPE_CHECKING:
    import xarray
    from pandas import DataFrame

_SHOWN = ("theta_min", "theta_max", "slip_up", "slip_down", "airborne_fraction")


@click.command(
    "sweep",
    help="""Simulate a SCENARIO (a TOML file) at all combinations of the values of some keys.

    Prints the summaries; --set record.pull_share=yes adds pull_share. All else of [record] is
    ignored. A point that fails is a status in the results: the command still succeeds,
    and says on standard error how many there are.

    A netCDF --out is written every second or more rarely, and on Ctrl-C, so that --resume can go on
    with it after whatever stopped the sweep, without simulating a finished point again.
    The exit status is 1 if all points failed, or if --plot had nothing to draw, as no point has a
    velocity.
    """,
    epilog="\b\nExample:\n"
    "  stickslip sweep scenario.toml --vary drive.frequency=5:200:40 --vary drive.mode=IPP,OPP \\\n"
    "    --out sweep.nc --plot sweep.png",
)
@click.argument("scenario", type=options.PATH)
@options.vary_option(required=True)
@options.SET
@options.THREADS
@click.option("--dask", metavar="ADDRESS", help="Simulate on the workers of a Dask cluster.")
@click.option(
    "--out",
    type=options.PATH,
    help="Write the results: .nc (netCDF; also .nc4, .h5) "
    "while the sweep goes on, or .csv at its end.",
)
@click.option("--resume", is_flag=True, help="Go on with the sweep that --out holds, if any.")
@options.plot_option("the mean velocities, lines over one number or a map over two")
@options.JSON
def command(
    scenario: Path,
    vary: dict[str, list[Any]],
    set: dict[str, Any],
    threads: int | None,
    dask: str | None,
    out: Path | None,
    resume: bool,
    plot: Path | None,
    as_json: bool,
) -> int:
    if both := vary.keys() & set.keys():
        raise click.UsageError(f"{min(both)}: allowed is either --set or --vary, not both")
    as_csv = out is not None and out.suffix.lower() == ".csv"
    if resume and (out is None or as_csv):
        raise click.UsageError("--resume: allowed with a netCDF --out only, the file to go on with")
    if dask is not None and threads is not None:
        raise click.UsageError("--threads: not allowed with --dask, whose workers are all used")
    loaded, read = load_with(scenario, set)
    output.check_files(read, out=(out, SUFFIXES), plot=(plot, ()))
    if out is not None and out.exists() and not resume:
        more = "" if as_csv else ", or go on with it by --resume"
        raise ScenarioError(f"--out: {out} already exists; choose another name{more}")
    options.check_drawable(plot, vary, 2)
    count = math.prod(map(len, vary.values()))
    with output.progress_bar(count) as bar, open_cluster(dask) as executor:
        how: dict[str, Any] = {"threads": threads, "executor": executor, "resume": resume}
        data = stickslip.sweep(loaded, vary, out=None if as_csv else out, progress=bar, **how)
    table = stickslip.sweep_dataframe(data)
    if as_json:
        output.print_json(_as_dict(data, table))
    else:
        _print(data, table)
    if as_csv and out is not None:
        output.write_frame(table, out)
    if failed := int(data.attrs["failed_points"]):
        first = next(filter(None, table["message"]))
        output.say(f"stickslip: {failed} of {count} points failed; the first: {first}", err=True)
    done = failed < count and output.drawn("--plot", plot, output.save_plot("velocity", data))
    return 0 if done else 1


def _as_dict(data: xarray.Dataset, table: DataFrame) -> dict[str, Any]:
    """Counts, extremes and the points in order, in the words of a single run's summary."""
    keys = _keys(data)
    table = table.rename(columns=keys)
    counts = table.filter(regex="^events_")
    results = table.drop(columns=counts.columns).to_dict("records")
    counts = counts.rename(columns=lambda name: name.removeprefix("events_"))
    for point, events in zip(results, counts.to_dict("records"), strict=True):
        point["events"] = events
    return {
        "points": len(table),
        "failed": int(data.attrs["failed_points"]),
        "status": json.loads(data.attrs["statuses"]),
        "notes": json.loads(data.attrs["notes"]),
        **_extremes(data, table),
        "results": results,
    }


def _extremes(data: xarray.Dataset, table: DataFrame) -> dict[str, dict[str, Any]]:
    """The keys and the velocity of the slowest and of the fastest point."""
    figure = next(iter(shown_velocities(data)))
    if table[figure].isna().all():
        return {}
    columns = table[[*_keys(data).values(), figure]]
    places = {"lowest": table[figure].idxmin(), "highest": table[figure].idxmax()}
    return {name: columns.loc[[label]].to_dict("records")[0] for name, label in places.items()}


def _print(data: xarray.Dataset, table: DataFrame) -> None:
    """The points, counts and extremes."""
    velocities, keys, units = shown_velocities(data), _keys(data), table.attrs["units"]
    names = [*keys, "status", *velocities, *_SHOWN, *(name for name in ASKED if name in data)]
    output.print_points({(name, units[name] or "-"): table[name] for name in names})
    sizes = " x ".join(f"{size} {name}" for name, size in data["status"].sizes.items())
    statuses = json.loads(data.attrs["statuses"])
    rows = [
        ("points", f"{len(table)} ({sizes})"),
        ("status", ", ".join(f"{name} {count}" for name, count in statuses.items())),
    ]
    for name, point in _extremes(data, table.rename(columns=keys)).items():
        figure, value = point.popitem()
        at = ", ".join(f"{keys[key]} = {point[keys[key]]} {units[key]}".removesuffix(" 1").rstrip()
                       for key in keys)  # fmt: skip
        direction = f"{value * 1e3:.6g} mm/s {velocities[figure]}".rstrip()
        rows.append((name, f"{direction} at {at}"))
    output.print_rows([*rows, *(("note", line) for line in lines_of_json(data.attrs["notes"]))])


def _keys(data: xarray.Dataset) -> dict[str, str]:
    """The keys that vary by their names in the Dataset."""
    coordinates = data["status"].coords.items()
    return {str(name): axis.attrs["key"] for name, axis in coordinates if "key" in axis.attrs}
