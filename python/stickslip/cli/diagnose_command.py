"""``stickslip diagnose``."""

from __future__ import annotations

from pathlib import Path

import click

from stickslip.cli.json_text import json_text
from stickslip.cli.progress import progress_bar
from stickslip.errors import ScenarioError


@click.command("diagnose", epilog="\b\nExample:\n  stickslip diagnose measurement.toml --out found")
@click.argument("measurement", type=click.Path(path_type=Path))
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Write report.html, report.json and extended.toml into this folder.",
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
    from stickslip.diagnosis.experiments import propose
    from stickslip.diagnosis.report import changes, write_report
    from stickslip.diagnosis.simulator import diagnose
    from stickslip.diagnosis.summary import headline, summary
    from stickslip.measurement import read_measurement

    data = read_measurement(measurement)
    if out is not None and out.exists() and not out.is_dir():
        raise ScenarioError(f"--out: {out} is there and is no folder")
    with progress_bar("diagnosing") as show:
        examination = diagnose(data, seed=seed, threads=jobs, progress=show)
    found = examination.found
    experiments = propose(examination)
    if out is not None:
        write_report(out, examination, data, experiments)
    if as_json:
        click.echo(json_text(summary(found, data, experiments)))
        return
    click.echo(f"{found.verdict.word}: {headline(found)}")
    reasons = () if found.verdict.word == "data-problem" else found.verdict.reasons
    for line in (*reasons, *found.notes, *data.left_out):
        click.echo(f"  {line}")
    if found.gain is not None:
        click.echo(
            f"  chi-square of each of {len(found.gain.held_out)} held-out conditions: "
            f"{found.gain.chi2_before:.1f} recalibrated, {found.gain.chi2_after:.1f} extended"
        )
    for each in experiments[:1]:
        click.echo(f"  next experiment: {changes(each.drive, examination.conditions)}; {each.why}")
    if out is not None:
        click.echo(f"  {out / 'report.html'}")
