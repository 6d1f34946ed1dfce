"""``stickslip diagnose``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

import stickslip
from stickslip._util.columns import Source
from stickslip._util.units import Units
from stickslip.cli.options import FOLDER, JSON, MODEL, PATH, SEED, SET_OF_MODEL, THREADS, UNITS
from stickslip.cli.output import choose_folder, print_json, progress_bar, say, write_new
from stickslip.diagnosis.report.files import FILES as REPORT
from stickslip.diagnosis.result import Diagnosis
from stickslip.walker.first_lines import TableGiven
from stickslip.walker.problem import report_files

# Lines about left-out data that are printed before the work; the report has all.
_SAID_FIRST = 3


@click.command(
    "diagnose",
    help="""Find what in a MEASUREMENT (a TOML file), or in LOGs (tables), a model does not explain.

    A log has columns of time, of a reading and of inputs, and --model names its model. Of a table
    of data without --model it prints the lines of the measurement that fit its columns. The recipe
    of a log, which "stickslip read --write" keeps, may take the place of LOG and --model.

    Recalibrates the uncertain parameters, tests for a misfit, and gives a verdict: named, dominant,
    pair, ambiguous, unexplained, none or data-problem.
    """,
    epilog="\b\nExample:\n"
    "  stickslip diagnose measurement.toml --out found\n"
    "  stickslip diagnose log.csv --model joint --set inertia=0.1,0.002 --set viscous=0.2,0.05\n"
    "  stickslip diagnose after.csv --against before.csv --model joint --set inertia=0.1,0.002",
)
@click.argument("files", type=PATH, nargs=-1, required=True, metavar="MEASUREMENT | LOG...")
@MODEL
@click.option(
    "--against",
    type=PATH,
    multiple=True,
    metavar="BEFORE",
    help="What changed since BEFORE, an earlier measurement or log; of logs there may be several.",
)
@SET_OF_MODEL
@UNITS
@click.option(
    "--out",
    type=FOLDER,
    help="Folder for report.html, report.json and extended.toml, or with --against before.toml "
    "and after.toml, with their voltages and maps, if any.  [default: diagnosis; with --json none]",
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
    files: tuple[Path, ...],
    model: str | None,
    against: tuple[Path, ...],
    set: dict[str, Any],
    units: Units,
    out: Path | None,
    as_json: bool,
    seed: int,
    threads: int | None,
    write: bool,
) -> None:
    if model is not None:
        for option, value in {"--threads": threads, "--write": write or None}.items():
            if value is not None:
                raise click.UsageError(f"{option}: allowed without --model only")
        out = choose_folder(out, as_json, "diagnosis", REPORT)
        _tell(*_of_logs(files, against, model, set, units, seed), out, as_json, REPORT)
        return
    measurement, *more = files
    more += against[1:]
    if more or set or units is not None:
        wrong = more[0] if more else "--set" if set else "--units"
        raise click.UsageError(f"{wrong}: allowed with --model only")
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
    earlier = stickslip.read_measurement(against[0]) if against else None
    sides = [data] if earlier is None else [earlier, data]
    # Before what takes minutes: a cell with a slip of the pen may be worth mending first.
    left_out: list[object] = [row for each in sides for row in each.left_out]
    left_out[_SAID_FIRST:] = ["and more, which the report lists"] * (len(left_out) > _SAID_FIRST)
    for row in left_out:
        say(f"stickslip: {row}", err=True)
    written = report_files(*(each.scenario for each in sides))
    out = choose_folder(out, as_json, "diagnosis", written)
    with progress_bar() as bar:
        result = stickslip.diagnose(data, against=earlier, seed=seed, threads=threads, progress=bar)
        if earlier is None:
            bar(1.0, "next experiment")
            result.propose_experiments()
    _tell(result, None, out, as_json, written)


def _of_logs(
    files: Sequence[Path], against: Sequence[Path], model: str, given: Any, units: Units, seed: int
) -> tuple[Diagnosis, str]:
    """The diagnosis of logs, and the title of its page."""
    from stickslip.cli.log_models import load_model
    from stickslip.cli.read_command import read_or_explain

    paths = [*against, *files]
    sources = list(map(Source, paths))
    made = load_model(model, given, sources)
    logs = [read_or_explain(source, made, units) for source in sources]
    names = [log.name for log in logs]
    logs = [log.named(f"{path.resolve().parent.name}/{log.name}")
            if names.count(log.name) > 1 else log
            for log, path in zip(logs, paths, strict=True)]  # fmt: skip
    for log in logs:
        for note in log.own_notes:
            say(f"stickslip: {log.name}: {note}", err=True)
    with progress_bar() as bar:
        if against:
            sides = logs[: len(against)], logs[len(against) :]
            result = stickslip.diagnose_change(made, *sides, seed=seed, progress=bar)
        else:
            result = stickslip.diagnose_model(made, logs, seed=seed, progress=bar)
    told = [", ".join(path.name for path in some) for some in (files, against) if some]
    return result, " against ".join(told)


def _tell(
    result: Diagnosis, title: str | None, out: Path | None, as_json: bool, written: Sequence[str]
) -> None:
    """Print what was found, and write it. Printing comes first, as a disk may be full."""
    try:
        if as_json:
            print_json(result.as_dict())
        for line in () if as_json else result.summary().splitlines():
            say(line)
    finally:  # a reader that closes the pipe loses no file
        if out is not None:
            result.save_report(out, title=title)
    if out is not None and not as_json:
        say(f"  in {out}: {', '.join(written)}")
