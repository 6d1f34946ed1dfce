"""``stickslip optimise``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import stickslip
from stickslip._util.text import printable_lines
from stickslip.cli import options, output
from stickslip.design.optimum import SearchInterrupted
from stickslip.errors import ScenarioError
from stickslip.scenario.scenario import load_uncertain


@click.command(
    "optimise",
    help="""Find the drive of a SCENARIO (a TOML file) that is best under limits.

    Uncertain parameters are drawn, and a limit has to hold in all draws. The drive has to walk: at
    most 20 % of the time in flight, never upright, and pulled by the gradient with at most 40 % of
    what friction could hold, unless --allow-flight, --allow-pull or a limit of yours says
    otherwise. The result is compared with the start on fresh draws. To limit the field, limit
    field_max, which a fast drive.peak does not reach.

    Ctrl-C ends the search, and writes the best so far.
    """,
    epilog="""\b
Examples:
  stickslip optimise scenario.toml --maximise mean_velocity --limit voltage_max=26 \\
    --free drive.frequency=5:300 --free drive.base=-2e-3:2e-3 --free drive.edge=rise,fall
  stickslip optimise best/best.toml --maximise mean_velocity --limit voltage_max=26 \\
    --knots 12 --coils xp,clamp --free drive.frequency=50:300 --out wave""",
)
@click.argument("scenario", type=options.PATH)
@click.option(
    "--maximise",
    metavar="FIGURE",
    help="A number of the summary, as large as may be: mean_velocity along x, for which both "
    "directions of a sawtooth are tried, velocity_along the heading of the drive.",
)
@click.option("--minimise", metavar="FIGURE", help="The same, as small as may be.")
@options.pairs(
    "--limit",
    options.number,
    "figure=value, such as field_max=2.5e-3",
    "Greatest value of a number of the summary, or of tilt_max, the largest |theta|, in every draw",
    metavar="FIGURE=VALUE",
)
@options.pairs(
    "--at-least",
    options.number,
    "figure=value, such as mean_velocity=1e-3",
    "Least value of such a number",
    metavar="FIGURE=VALUE",
)
@click.option(
    "--allow-flight",
    is_flag=True,
    help="Drop the default limits of walking, airborne_fraction=0.2 and tilt_max=1.5 (rad).",
)
@click.option(
    "--allow-pull",
    is_flag=True,
    help="Drop the default limit of being dragged, pull_share=0.4; a run takes half as long then.",
)
@options.pairs(
    "--free",
    options.range_or_words,
    "key=low:high or key=word,word, such as drive.frequency=5:300",
    "A key and its range, low:high, or words to try, a,b",
    **options.KEYS,
)
@click.option(
    "--knots",
    type=click.IntRange(2),
    help="A free waveform with so many knots of each coil; needs --limit voltage_max.",
)
@click.option("--coils", default="xp,clamp", help="Coils that a free waveform drives.")
@options.UNCERTAIN
@click.option(
    "--score",
    default="q10",
    help="How the draws are summed up: q10 for the 10 % quantile, mean or worst.",
)
@click.option("--draws", type=click.IntRange(1), default=8, help="Draws in the search.")
@click.option(
    "--fresh", type=click.IntRange(1), default=64, help="Other draws, to judge what was found."
)
@click.option(
    "--evaluations", type=click.IntRange(1), default=10_000, help="Simulations of the search."
)
@options.SEED
@click.option(
    "--out",
    type=options.FOLDER,
    help="Folder for best.toml, best.csv and best.png.  [default: best; with --json none]",
)
@options.SET
@options.THREADS
@options.JSON
def command(
    scenario: Path,
    set: dict[str, Any],
    uncertain: Path | None,
    limit: dict[str, float],
    coils: str,
    out: Path | None,
    as_json: bool,
    **how: Any,
) -> None:
    if how["maximise"] is None and how["minimise"] is None:
        raise click.UsageError("--maximise or --minimise is missing, with a number of the summary")
    base, read = load_uncertain(scenario, set, uncertain)
    out = output.choose_folder(out, as_json, "best")
    for path in read:
        if out is not None and path.resolve().parent == out.resolve():
            raise ScenarioError(f"--out: {out} has {path}, which is read; choose another folder")
    how |= {"limits": limit, "coils": [name.strip() for name in coils.split(",")]}
    interrupted = False
    with output.progress_bar() as bar:
        try:
            optimum = stickslip.optimise(base, progress=bar, **how)
        except SearchInterrupted as interrupt:
            if interrupt.best is None:
                raise
            optimum, interrupted = interrupt.best, True
    if as_json:
        output.print_json(optimum.as_dict())
    else:
        click.echo(printable_lines(optimum.summary()))
    if out is not None:
        output.say(f"  in {out}: {', '.join(optimum.save(out))}", err=as_json)
    if interrupted:
        raise KeyboardInterrupt("this is the best so far")
