"""``stickslip diagnose``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

import stickslip
from stickslip._util.columns import Source
from stickslip._util.units import Units
from stickslip.cli.log_models import LogFile, load_model
from stickslip.cli.options import FOLDER, JSON, MODEL, PATH, SEED, SET_OF_MODEL, THREADS, UNITS
from stickslip.cli.output import folder_of, print_json, progress_bar, say, write_new
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
    kept = [] if model else _kept([*files, *against])
    if kept and (set or units is not None):
        raise click.UsageError("--set, --units: the recipe of a log has these")
    if model is not None or kept:
        for option, value in {"--threads": threads, "--write": write or None}.items():
            if value is not None:
                raise click.UsageError(f"{option}: allowed without --model only")
        each = kept or [LogFile(path, str(model), units, set) for path in (*files, *against)]
        _diagnose_logs(each[: len(files)], each[len(files) :], out, as_json, seed)
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
    out = folder_of(out, as_json, "diagnosis", written)
    with progress_bar() as bar:
        result = stickslip.diagnose(data, against=earlier, seed=seed, threads=threads, progress=bar)
        if earlier is None:
            bar(1.0, "next experiment")
            result.propose_experiments()
    _tell(result, out, as_json, written)


def _kept(paths: Sequence[Path]) -> list[LogFile]:
    """The recipes of logs in files; none if these are others."""
    kept = [one for path in paths if (one := LogFile.of(path)) is not None]
    alike = all((one.model, one.set) == (kept[0].model, kept[0].set) for one in kept)
    if kept and not (alike and len(kept) == len(paths)):
        raise click.UsageError(f"{paths[0]}: allowed beside it are recipes of the same model")
    return kept


def _diagnose_logs(
    files: Sequence[LogFile], against: Sequence[LogFile], out: Path | None, as_json: bool, seed: int
) -> None:
    from stickslip.cli.read_command import explained
    from stickslip.models import read_log

    out = folder_of(out, as_json, "diagnosis", REPORT)
    kept, logs = [*against, *files], []
    sources = [Source(each.file) for each in kept]
    made = load_model(kept[0].model, kept[0].set, sources)
    for source, each in zip(sources, kept, strict=True):
        with explained(source, made, each.units):
            logs.append(read_log(source, made, each.units))
    names = [log.name for log in logs]
    logs = [log.named(f"{each.file.resolve().parent.name}/{log.name}")
            if names.count(log.name) > 1 else log
            for log, each in zip(logs, kept, strict=True)]  # fmt: skip
    for log in logs:
        for note in log.own_notes:
            say(f"stickslip: {log.name}: {note}", err=True)
    with progress_bar() as bar:
        if against:
            sides = logs[: len(against)], logs[len(against) :]
            result = stickslip.diagnose_change(made, *sides, seed=seed, progress=bar)
        else:
            result = stickslip.diagnose_model(made, logs, seed=seed, progress=bar)
    told = [", ".join(each.file.name for each in some) for some in (files, against) if some]
    _tell(result, out, as_json, REPORT, " against ".join(told))


def _tell(
    result: Diagnosis, out: Path | None, as_json: bool, written: Sequence[str], title: Any = None
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
