"""``stickslip diagnose``."""

from __future__ import annotations

from pathlib import Path

import click

import stickslip
from stickslip._util.files import check_folder
from stickslip.cli.options import FOLDER, JSON, PATH, SEED, THREADS
from stickslip.cli.output import print_json, say, write_new
from stickslip.cli.progress import progress_bar
from stickslip.diagnosis.report.files import report_files
from stickslip.diagnosis.report.next_table import TABLES, with_measured
from stickslip.diagnosis.rounds import BUDGET
from stickslip.errors import prefixed
from stickslip.measurement.first_lines import TableGiven

# Lines about left-out data that are printed before the work; the report has all.
_SAID_FIRST = 3


@click.command(
    "diagnose",
    help="""Find what in a MEASUREMENT (a TOML file) the model does not explain.

    Of a table of data (CSV) it prints the lines of the measurement that fit its columns.

    Recalibrates the uncertain parameters, tests for a misfit, and gives a verdict: named, dominant,
    pair, ambiguous, unexplained, none or data-problem.
    """,
    epilog="\b\nExample:\n"
    "  stickslip diagnose measurement.toml --out found\n"
    "  stickslip diagnose measurement.toml --out found --next 1",
)
@click.argument("measurement", type=PATH)
@click.option(
    "--out",
    type=FOLDER,
    help="Folder for report.html, report.json and extended.toml with its voltages and map, if "
    "any.  [default: diagnosis; with --json and without --next none]",
)
@click.option(
    "--next",
    "most",
    type=click.IntRange(1),
    metavar="N",
    help="If the verdict is not certain, write up to N drives to measure into next.csv in the "
    "folder of --out. The next call reads the velocities that were filled in there.",
)
@click.option(
    "--budget",
    type=click.IntRange(1),
    help=f"With --next: experiments that may be measured in all.  [default: {BUDGET}]",
)
@click.option(
    "--write",
    is_flag=True,
    help="Of a table of data: write the measurement file that names it beside it, and no more.",
)
@JSON
@SEED
@THREADS
def command(
    measurement: Path,
    out: Path | None,
    as_json: bool,
    seed: int,
    threads: int | None,
    most: int | None,
    budget: int | None,
    write: bool,
) -> None:
    if budget is not None and most is None:
        raise click.UsageError("--budget: allowed with --next only")
    try:
        data = stickslip.read_measurement(measurement)
    except TableGiven as error:
        if not write:
            click.echo(error.lines, nl=False)
            raise
        write_new("--write", measurement.with_suffix(".toml"), error.lines)
        return
    if write:
        raise click.UsageError("--write: allowed with a table of data only")
    # Before what takes minutes: a cell with a slip of the pen may be worth mending first.
    for said in data.left_out[:_SAID_FIRST]:
        say(f"stickslip: left out: {said}", err=True)
    if len(data.left_out) > _SAID_FIRST:
        say("stickslip: left out: more, which the report lists", err=True)
    if out is None and (most is not None or not as_json):
        out = Path("diagnosis")
    rounds = None
    files = report_files(data.scenario)
    if out is not None:
        with prefixed("--out", OSError):
            check_folder(out, files if most is None else [*files, *TABLES])
        if most is not None:
            data, rounds = with_measured(data, out, most, BUDGET if budget is None else budget)
        elif (out / TABLES[0]).exists():
            say(f"stickslip: {out / TABLES[0]} is not read, as --next is not given", err=True)
    with progress_bar() as bar:
        result = stickslip.diagnose(data, seed=seed, threads=threads, progress=bar)
        bar(1.0, "next experiment")
        result.propose_experiments()
    # The verdict is printed even if a disk is full.
    if as_json:
        next_ = {} if rounds is None else {"next": rounds.as_dict(result)}
        print_json({**result.as_dict(), **next_})
    else:
        for line in [*result.summary().splitlines(), *(rounds.lines(result) if rounds else [])]:
            say(line)
    if out is not None:
        result.save_report(out)
        if rounds is not None:
            rounds.write(result)
        if not as_json:
            say(f"  in {out}: {', '.join(files)}")
