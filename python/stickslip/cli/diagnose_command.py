"""``stickslip diagnose``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip._util.text import json_text
from stickslip.cli.common import JSON, PATH, THREADS, WholeNumber, say
from stickslip.cli.progress import ProgressBar
from stickslip.cli.targets import check_folder_target

if TYPE_CHECKING:
    from stickslip.cli.next_table import Rounds
    from stickslip.diagnosis.result import Diagnosis
    from stickslip.measurement.reading import Measurement

# Lines about what was left out that are said before the work; the report has all.
_SAID_FIRST = 3


@click.command(
    "diagnose",
    epilog="\b\nExample:\n"
    "  stickslip diagnose measurement.toml --out found\n"
    "  stickslip diagnose measurement.toml --out found --next 1",
)
@click.argument("measurement", type=PATH)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for report.html, report.json and extended.toml with its voltages and map, if "
    "any.  [default: diagnosis; with --json and without --next none]",
)
@click.option(
    "--next",
    "most",
    type=WholeNumber(1),
    metavar="N",
    help="Where no name is safe, write up to N drives to measure into next.csv in the folder of "
    "--out. The velocities that were filled in there are read by the next call.",
)
@click.option(
    "--budget",
    type=WholeNumber(1),
    help="With --next: experiments that may be measured in all.  [default: 3]",
)
@JSON
@click.option("--seed", type=WholeNumber(0), default=0, show_default=True, help="Of all draws.")
@THREADS
def command(
    measurement: Path,
    out: Path | None,
    as_json: bool,
    seed: int,
    threads: int | None,
    most: int | None = None,
    budget: int | None = None,
) -> None:
    """Find what in a MEASUREMENT (a TOML file) the model does not explain.

    Recalibrates what is uncertain, tests whether anything is left, and says one of: named,
    dominant, pair, ambiguous, unexplained, none, data-problem.
    """
    from stickslip.diagnosis.report.files import report_files
    from stickslip.measurement import read_measurement

    if budget is not None and most is None:
        raise click.UsageError("--budget: allowed is --budget beside --next")
    data = read_measurement(measurement)
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
        check_folder_target(out, files)
        data, rounds = _with_next(data, out, most, budget)
    how = {"seed": seed, "threads": threads}
    result = _diagnosed(data, out, how, as_json, rounds)
    _tell(result, as_json, rounds)
    if out is not None and not as_json:
        say(f"  in {out}: {', '.join(files)}")


def _with_next(
    data: Measurement, out: Path, most: int | None, budget: int | None
) -> tuple[Measurement, Rounds | None]:
    """The measurement with what was filled in of the proposed drives, if ``--next`` is given."""
    from stickslip.cli.next_table import PREDICTIONS, TABLE, with_measured
    from stickslip.diagnosis.rounds import BUDGET

    if most is not None:
        check_folder_target(out, [TABLE, PREDICTIONS])
        return with_measured(data, out, most, BUDGET if budget is None else budget)
    if (out / TABLE).exists():
        say(f"stickslip: {out / TABLE} is not read, as --next is not given", err=True)
    return data, None


def _diagnosed(
    data: Measurement,
    out: Path | None,
    how: Mapping[str, Any],
    as_json: bool,
    rounds: Rounds | None,
) -> Diagnosis:
    """The diagnosis with its experiments, and its report where one is wanted, while a bar shows."""
    from stickslip.diagnosis.entry import diagnose

    bar = ProgressBar(
        "recalibrating", kept=lambda stage: "" if stage == "report" else "nothing written"
    )
    try:
        with bar:

            def diagnosing(done: float, stage: str) -> None:
                if done < 1.0:  # two stages come after the last of these
                    bar(0.95 * done, stage)

            result = diagnose(data, **how, progress=diagnosing)
            bar(0.95, "next experiment")
            result.propose_experiments()
            if out is not None:
                bar(0.97, "report")
                result.save_report(out)
            if rounds is not None:
                rounds.write(result)
    except OSError:
        if bar.stage == "report":  # the verdict is printed even if a disk was full
            _tell(result, as_json, rounds)
        raise
    return result


def _tell(result: Diagnosis, as_json: bool, rounds: Rounds | None) -> None:
    if as_json:
        said = result.as_dict()
        click.echo(json_text(said if rounds is None else {**said, "next": rounds.as_dict(result)}))
        return
    for line in [*result.summary().splitlines(), *(rounds.lines(result) if rounds else [])]:
        say(line)
