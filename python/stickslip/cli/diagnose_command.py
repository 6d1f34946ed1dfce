"""``stickslip diagnose``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip._util.strict_json import json_text
from stickslip.cli.lines import say
from stickslip.cli.options import JSON, PATH, THREADS
from stickslip.cli.progress import ProgressBar
from stickslip.cli.targets import check_folder_target
from stickslip.scenario.toml_file import voltages_beside

if TYPE_CHECKING:
    from stickslip.diagnosis.api import Examination
    from stickslip.diagnosis.inference.experiment_design import Experiment
    from stickslip.measurement import Measurement


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
@THREADS
def command(
    measurement: Path, out: Path | None, as_json: bool, seed: int, threads: int | None
) -> None:
    """Find what in a MEASUREMENT (a TOML file) the model does not explain.

    Recalibrates what is uncertain, tests whether anything is left, and says one of: none, named,
    ambiguous, pair, unexplained, data-problem.
    """
    from stickslip.diagnosis.api import diagnose
    from stickslip.diagnosis.inference.experiment_design import propose
    from stickslip.diagnosis.report.html import EXTENDED, FILES, write_report
    from stickslip.measurement import read_measurement

    data = read_measurement(measurement)
    if out is None and not as_json:
        out = Path("diagnosis")
    if out is not None:
        check_folder_target("--out", out, [*FILES, voltages_beside(Path(EXTENDED)).name])
    bar = ProgressBar("recalibrating")
    try:
        with bar:

            def diagnosing(done: float, stage: str) -> None:
                if done < 1.0:  # two stages come after the last of these
                    bar(0.95 * done, stage)

            examination = diagnose(data, seed=seed, threads=threads, progress=diagnosing)
            bar(0.95, "next experiment")
            experiments = propose(examination)
            if out is not None:
                bar(0.97, "report")
                write_report(out, examination, data, experiments)
    except KeyboardInterrupt:
        kept = "" if bar.stage == "report" else ", nothing written"
        say(f"stickslip: interrupted at the stage '{bar.stage}'{kept}", err=True)
        raise
    except OSError:
        if bar.stage == "report":  # what was found is told also where a disk was full
            _tell(examination, data, experiments, as_json)
        raise
    _tell(examination, data, experiments, as_json)
    if out is not None and not as_json:
        say(f"  in {out}: {', '.join(FILES)}")


def _tell(
    examination: Examination,
    data: Measurement,
    experiments: Sequence[Experiment],
    as_json: bool,
) -> None:
    from stickslip.diagnosis.data.conditions import changes
    from stickslip.diagnosis.inference.experiment_design import advice
    from stickslip.diagnosis.inference.ranking import runner_up
    from stickslip.diagnosis.report.json_keys import summary
    from stickslip.diagnosis.report.messages import headline

    if as_json:
        click.echo(json_text(summary(examination, data, experiments)))
        return
    found = examination.found
    say(f"{found.verdict.word}: {headline(found)}")
    reasons = () if found.verdict.word == "data-problem" else found.verdict.reasons
    second = runner_up(found)
    for line in (*reasons, *([second] if second else []), *found.notes):
        say(f"  {line}")
    for line in (*data.left_out, *examination.left_out):
        say(f"  left out: {line}")
    if found.gain is not None:
        say(
            f"  chi-square per condition, {len(found.gain.held_out)} held out: "
            f"{found.gain.chi2_before:.1f} recalibrated, {found.gain.chi2_after:.1f} extended"
        )
    for each in experiments[:1]:
        what = f"{changes(each.drive, examination.conditions)}; {each.why}"
        if not each.decides:
            what = f"none that was tried tells the leading rivals apart; the best: {what}"
        say(f"  next experiment: {what}")
    for line in advice(found):
        say(f"  beside the drive: {line}")
