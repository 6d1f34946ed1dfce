"""``stickslip diagnose``."""

from __future__ import annotations

from pathlib import Path

import click

from stickslip._util.strict_json import json_text
from stickslip.cli.lines import say
from stickslip.cli.progress import progress_bar
from stickslip.cli.targets import check_folder_target
from stickslip.scenario.toml_file import voltages_beside


@click.command("diagnose", epilog="\b\nExample:\n  stickslip diagnose measurement.toml --out found")
@click.argument("measurement", type=click.Path(path_type=Path))
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for report.html, report.json and extended.toml.  [default: diagnosis; with "
    "--json none]",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of all draws.")
@click.option("--jobs", type=click.IntRange(1), help="Simulations at a time; default: processors.")
def command(
    measurement: Path, out: Path | None, as_json: bool, seed: int, jobs: int | None
) -> None:
    """Find what in a MEASUREMENT (a TOML file) the model does not explain.

    Recalibrates what is uncertain, tests whether anything is left, and says one of: none, named,
    ambiguous, pair, unexplained, data-problem.
    """
    from stickslip.diagnosis.api import diagnose
    from stickslip.diagnosis.data.conditions import changes
    from stickslip.diagnosis.inference.experiment_design import advice, propose, undecided
    from stickslip.diagnosis.inference.ranking import runner_up
    from stickslip.diagnosis.report.html import EXTENDED, FILES, write_report
    from stickslip.diagnosis.report.json_keys import summary
    from stickslip.diagnosis.report.messages import headline
    from stickslip.measurement import read_measurement

    data = read_measurement(measurement)
    if out is None and not as_json:
        out = Path("diagnosis")
    if out is not None:
        check_folder_target("--out", out, [*FILES, voltages_beside(Path(EXTENDED)).name])
    now = "recalibrating"
    try:
        with progress_bar("diagnosing") as show:

            def report(done: float, stage: str) -> None:
                nonlocal now
                now = stage
                show(done, stage)

            def diagnosing(done: float, stage: str) -> None:
                if done < 1.0:  # two stages come after the last of these
                    report(0.95 * done, stage)

            examination = diagnose(data, seed=seed, threads=jobs, progress=diagnosing)
            found = examination.found
            report(0.95, "next experiment")
            experiments = propose(examination)
            if out is not None:
                report(0.97, "report")
                write_report(out, examination, data, experiments)
    except KeyboardInterrupt:
        kept = "" if now == "report" else ", nothing written"
        say(f"stickslip: interrupted at the stage '{now}'{kept}", err=True)
        raise
    if as_json:
        click.echo(json_text(summary(examination, data, experiments)))
        return
    say(f"{found.verdict.word}: {headline(found)}")
    reasons = () if found.verdict.word == "data-problem" else found.verdict.reasons
    second = runner_up(found)
    for fact in (*reasons, *([second] if second else []), *found.notes):
        say(f"  {fact}")
    for fact in (*data.left_out, *examination.left_out):
        say(f"  left out: {fact}")
    if found.gain is not None:
        say(
            f"  chi-square per condition, {len(found.gain.held_out)} held out: "
            f"{found.gain.chi2_before:.1f} recalibrated, {found.gain.chi2_after:.1f} extended"
        )
    for each in experiments[:1]:
        none = undecided(experiments)
        if none is not None:
            say(f"  {none}")
        say(f"  next experiment: {changes(each.drive, examination.conditions)}. {each.why}")
    for fact in advice(found):
        say(f"  beside the drive: {fact}")
    if out is not None:
        say(f"  in {out}: {', '.join(FILES)}")
