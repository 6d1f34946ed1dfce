"""``stickslip optimise``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from stickslip._util.text import json_text, printable_lines
from stickslip.cli.common import JSON, PATH, SET, THREADS, UNCERTAIN, WholeNumber, say
from stickslip.cli.completion import coils, figure_after, settings
from stickslip.cli.progress import ProgressBar
from stickslip.cli.settings import by_key, parse_value, read_with, with_uncertain_file
from stickslip.cli.targets import check_folder_target, input_files
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Value

_FREE = "allowed is key=low:high or key=word,word, such as drive.frequency=5:300"
_LIMIT = "allowed is figure=value, such as field_max=2.5e-3"


@click.command(
    "optimise",
    epilog="""\b
Examples:
  stickslip optimise scenario.toml --maximise mean_velocity --limit voltage_max=26 \\
    --free drive.frequency=5:300 --free drive.base=-2e-3:2e-3 --free drive.edge=rise,fall
  stickslip optimise scenario.toml --maximise mean_velocity --limit voltage_max=26 \\
    --knots 12 --coils xp,clamp --free drive.frequency=50:300 --out best""",
)
@click.argument("scenario", type=PATH)
@click.option(
    "--maximise",
    metavar="FIGURE",
    shell_complete=figure_after(""),
    help="A number of the summary, as large as may be. mean_velocity is along x, velocity_along "
    "along the heading of the drive.",
)
@click.option(
    "--minimise",
    metavar="FIGURE",
    shell_complete=figure_after(""),
    help="The same, as small as may be.",
)
@click.option(
    "--limit",
    "limits",
    multiple=True,
    metavar="FIGURE=VALUE",
    shell_complete=figure_after("="),
    help="Greatest value of a number of the summary, or of tilt_max, the largest |theta|, in every "
    "draw; repeatable.",
)
@click.option(
    "--allow-flight",
    is_flag=True,
    help="Without the default limits of walking, airborne_fraction=0.2 and tilt_max=1.5 (rad).",
)
@click.option(
    "--free",
    multiple=True,
    metavar="KEY=VALUES",
    shell_complete=settings,
    help="A key and its range, low:high, or words to try, a,b; repeatable.",
)
@click.option(
    "--knots",
    type=WholeNumber(2, 200),
    help="A free waveform with so many knots of each coil; needs --limit voltage_max.",
)
@click.option(
    "--coils",
    default="xp,clamp",
    show_default=True,
    shell_complete=coils,
    help="Coils that a free waveform drives.",
)
@UNCERTAIN
@click.option(
    "--score",
    default="q10",
    show_default=True,
    help="What of the draws counts: q10 for the 10 % quantile, mean or worst.",
)
@click.option(
    "--draws", type=WholeNumber(1), default=8, show_default=True, help="Draws in the search."
)
@click.option(
    "--fresh",
    type=WholeNumber(1),
    default=64,
    show_default=True,
    help="Other draws, to judge what was found.",
)
@click.option(
    "--evaluations",
    type=WholeNumber(1),
    default=10_000,
    show_default=True,
    help="Simulations of the search.",
)
@click.option("--seed", type=WholeNumber(0), default=0, show_default=True, help="Of all draws.")
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder for best.toml, best.csv and report.html.  [default: best; with --json none]",
)
@SET
@THREADS
@JSON
def command(
    scenario: Path,
    limits: tuple[str, ...],
    free: tuple[str, ...],
    coils: str,
    uncertain: Path | None,
    out: Path | None,
    settings: tuple[str, ...],
    as_json: bool,
    **options: Any,
) -> None:
    """Find the drive of a SCENARIO (a TOML file) that is best under limits.

    What is uncertain is drawn, the same draws for every drive, and a limit has to hold in all of
    them. The drive has to walk: at most 20 % of the time in flight, and never upright, unless
    --allow-flight or a limit of yours says otherwise. The result is compared with the start and
    with the best sawtooth of a grid, on fresh draws; the better of search and sawtooth is written.
    Without anything uncertain the scenario is the one draw.

    A field that a drive states, such as drive.peak, is what its voltage would make if it were held
    for ever; of a fast pulse the coil lets little through. To limit the field, limit field_max.

    Ctrl-C ends the search, and writes the best so far.
    """
    from stickslip.design.optimise import optimise
    from stickslip.design.optimum import FILES, SearchInterrupted

    base = with_uncertain_file(read_with(scenario, settings), uncertain, settings)
    options["free"] = by_key("--free", free, _FREE, _values)
    options["limits"] = by_key("--limit", limits, _LIMIT, _number)
    options["coils"] = [name.strip() for name in coils.split(",")]
    if out is None and not as_json:
        out = Path("best")
    if out is not None:
        check_folder_target(out, FILES, input_files(scenario, settings, uncertain))
    with ProgressBar("searching") as bar:
        try:
            found = optimise(base, progress=bar, **options)
        except SearchInterrupted as interrupt:
            if interrupt.best is None:
                raise
            found = interrupt.best
        if out is not None:
            bar(1.0, "report")
            found.save_report(out)
    click.echo(json_text(found.as_dict()) if as_json else printable_lines(found.summary()))
    if found.interrupted:
        kept = "nothing written" if out is None else f"the best so far is in {out}"
        say(f"stickslip: interrupted, {kept}", err=True)
        raise KeyboardInterrupt
    if out is not None and not as_json:
        say(f"  in {out}: {', '.join(found.files)}")


def _values(text: str) -> list[Value]:
    """The two ends of a range, or words."""
    separator = ":" if ":" in text else ","
    values = [parse_value(part.strip()) for part in text.split(separator)] if text else []
    are_numbers = all(isinstance(each, int | float) for each in values)
    if (separator == ":") != are_numbers or (are_numbers and len(values) != 2):
        raise ScenarioError(_FREE)
    return values


def _number(text: str) -> float:
    number = parse_value(text)
    if isinstance(number, str):
        raise ScenarioError(_LIMIT)
    return number
