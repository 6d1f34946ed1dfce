"""``stickslip predict``."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import stickslip
from stickslip._util.messages import shown, suggestion
from stickslip.cli import options, output
from stickslip.scenario.scenario import load_uncertain
from stickslip.simulation.notes import lines_of_json
from stickslip.simulation.quantities import ASKED, NUMBERS
from stickslip.simulation.run import SUFFIXES
from stickslip.simulation.seen_from_drive import VELOCITIES, shown_velocities
from stickslip.sweeping.checkpoint import write
from stickslip.sweeping.predict import DRAWS

if TYPE_CHECKING:
    import xarray


def _figures(ctx: click.Context, param: click.Parameter, text: str | None) -> list[str]:
    """The names of numbers of a summary, each once."""
    known = {**VELOCITIES, **NUMBERS}
    names = [] if text is None else list(dict.fromkeys(map(str.strip, text.split(","))))
    for name in names:
        if name not in known:
            hint = suggestion(name, known)
            raise click.BadParameter(f"{shown(name)}: no number of a summary; {hint}", ctx, param)
    return names


@click.command(
    "predict",
    help="""Predict the summary of a SCENARIO (a TOML file) with error bars.

    Prints the quantiles of 10, 50 and 90 % over draws from its [uncertain], or from that of another
    file. Draws that fail are in no quantile: their number is printed on standard error, and the
    exit status is 1.
    """,
    epilog="\b\nExample:\n"
    "  stickslip predict scenario.toml --uncertain measurement.toml \\\n"
    "    --vary drive.frequency=20:200:10 --out bands.csv --plot bands.png",
)
@click.argument("scenario", type=options.PATH)
@options.UNCERTAIN
@options.vary_option(required=False)
@options.SET
@click.option(
    "--draws",
    type=click.IntRange(2),
    default=DRAWS,
    help="Simulations of each point, each with its own draw of the uncertain parameters.",
)
@options.SEED
@options.THREADS
@click.option(
    "--out", type=options.PATH, help="Write the quantiles: .nc (netCDF; also .nc4, .h5) or .csv."
)
@options.plot_option("velocities with bands")
@click.option(
    "--figures",
    callback=_figures,
    metavar="NAME,NAME",
    help="Numbers of the summary that are printed and written, such as mean_velocity,field_max; "
    "default: all, of which velocity, flight and a pull_share that is asked for are printed.",
)
@options.JSON
def command(
    scenario: Path,
    uncertain: Path | None,
    vary: dict[str, list[Any]],
    set: dict[str, Any],
    draws: int,
    seed: int,
    threads: int | None,
    out: Path | None,
    plot: Path | None,
    figures: list[str],
    as_json: bool,
) -> int:
    loaded, read = load_uncertain(scenario, set, uncertain)
    output.check_files(read, out=(out, SUFFIXES), plot=(plot, ()))
    options.check_drawable(plot, vary, 1)
    count = math.prod(map(len, vary.values())) * draws
    with output.progress_bar(count) as bar:
        data = stickslip.predict(loaded, vary, draws, seed, threads=threads, progress=bar)
    whole = data
    if figures:
        there = [name for name in figures if name in data]
        for name in [name for name in figures if name not in there]:
            why = f"needs --set {ASKED[name]}=yes" if name in ASKED else "is one of the whole plane"
            output.say(f"stickslip: note: {name} {why}, left out", err=True)
        data = data[["failed", "quantile", *there, *(f"{name}_error" for name in there)]]
    if as_json:
        output.print_json(_as_dict(data))
    else:
        _print(data, figures)
    failed, redrawn = int(data.attrs["failed_draws"]), int(data.attrs["redrawn"])
    if redrawn:
        text = f"{redrawn} more draws made no scenario and were drawn again"
        output.say(f"stickslip: note: {text}", err=True)
    if failed:
        text = f"{failed} of {count} draws failed and are in no quantile; the first: "
        output.say(f"stickslip: {text}{data.attrs['message']}", err=True)
    if out is not None and out.suffix.lower() == ".csv":
        output.write_frame(stickslip.sweep_dataframe(data), out)
    elif out is not None:
        write(data, out)
    done = output.drawn("--plot", plot, output.save_plot("velocity", whole))
    return 0 if done and not failed else 1


def _as_dict(data: xarray.Dataset) -> dict[str, Any]:
    """The points in order: quantiles of each figure and their errors, lists as `quantiles`."""
    table = stickslip.sweep_dataframe(data)
    keys = {str(name): axis.attrs["key"] for name, axis in data["failed"].coords.items()}
    columns = table[[*keys, "failed"]].rename(columns=keys).to_dict("list")
    for name, values in data.data_vars.items():
        if "quantile" in values.dims:
            columns[str(name)] = values.values.reshape(-1, data.sizes["quantile"]).tolist()
    rows = zip(*columns.values(), strict=True)
    return {
        "points": data["failed"].size,
        **{name: int(data.attrs[name]) for name in ("draws", "seed", "redrawn")},
        "failed": int(data.attrs["failed_draws"]),
        "status": json.loads(data.attrs["statuses"]),
        "notes": json.loads(data.attrs["notes"]),
        "quantiles": data["quantile"].values.tolist(),
        "results": [dict(zip(columns, row, strict=True)) for row in rows],
    }


def _print(data: xarray.Dataset, chosen: list[str]) -> None:
    """The points, counts, and the precision of the quantiles."""
    table = stickslip.sweep_dataframe(data)
    units = table.attrs["units"]
    figures = [name for name in chosen if name in data]
    if not chosen:
        asked = [name for name in ASKED if name in data]
        figures = [next(iter(shown_velocities(data))), "airborne_fraction", *asked]
    names = [f"{name}_q{100.0 * level:g}" for name in figures for level in data["quantile"].values]
    shown = [*map(str, data["failed"].coords), *names, "failed"]
    output.print_points({(name, units[name] or "-"): table[name] for name in shown})
    points, draws = data["failed"].size, int(data.attrs["draws"])
    failures = int(data.attrs["failed_draws"])
    rows = [("points", str(points)), ("draws", f"{draws} of each, {failures} of all failed")]
    if failures < points * draws:
        lowest = float(data["quantile"].min())
        error = math.sqrt(lowest * (1.0 - lowest) / draws)
        shares = f"{100 * max(lowest - error, 0.0):.3g} to {100 * (lowest + error):.3g} %"
        rows.append(("precision", f"the quantile of {100 * lowest:.4g} % is one of {shares}"))
    output.print_rows([*rows, *(("note", line) for line in lines_of_json(data.attrs["notes"]))])
