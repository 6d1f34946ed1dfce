"""``stickslip diagnose``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip._util.strict_json import json_text
from stickslip.cli.common import JSON, PATH, THREADS, say
from stickslip.cli.progress import ProgressBar
from stickslip.cli.targets import check_folder_target
from stickslip.scenario.toml_file import voltages_beside

if TYPE_CHECKING:
    from stickslip.diagnosis.results import Diagnosis
    from stickslip.measurement.reading import Measurement


@click.command("diagnose", epilog="\b\nExample:\n  stickslip diagnose measurement.toml --out found")
@click.argument("measurement", type=PATH)
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for report.html, report.json and extended.toml.  [default: diagnosis; with "
    "--json none]",
)
@JSON
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of all draws.")
@click.option(
    "--free-shapes",
    is_flag=True,
    help="Fit curves of a free shape at the laws of the model too, also where a cause is found.",
)
@THREADS
def command(
    measurement: Path,
    out: Path | None,
    as_json: bool,
    seed: int,
    free_shapes: bool,
    threads: int | None,
) -> None:
    """Find what in a MEASUREMENT (a TOML file) the model does not explain.

    Recalibrates what is uncertain, tests whether anything is left, and says one of: none, named,
    ambiguous, pair, unexplained, data-problem.
    """
    from stickslip.diagnosis.report.html import EXTENDED, FILES
    from stickslip.measurement import read_measurement

    data = read_measurement(measurement)
    if out is None and not as_json:
        out = Path("diagnosis")
    if out is not None:
        check_folder_target(out, [*FILES, voltages_beside(Path(EXTENDED)).name])
    how = {"seed": seed, "threads": threads, "free_shapes": free_shapes}
    result = _diagnosed(data, out, how, as_json)
    _tell(result, as_json)
    if out is not None and not as_json:
        say(f"  in {out}: {', '.join(FILES)}")


def _diagnosed(
    data: Measurement, out: Path | None, how: Mapping[str, Any], as_json: bool
) -> Diagnosis:
    """The diagnosis with its experiments, and its report where one is wanted, while a bar shows."""
    from stickslip.diagnosis.api import diagnose

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
    except OSError:
        if bar.stage == "report":  # the verdict is printed even if a disk was full
            _tell(result, as_json)
        raise
    return result


def _tell(result: Diagnosis, as_json: bool) -> None:
    from stickslip.diagnosis.report.messages import experiment_lines

    if as_json:
        click.echo(json_text(result.as_dict()))
        return
    experiments = result.propose_experiments()
    lines = result.verdict_lines()
    for line in lines + experiment_lines(result.findings, experiments, result.posed.conditions):
        say(line)
