"""``stickslip reproduce``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip._util.text import json_text, printable
from stickslip.cli.common import JSON, PATH, THREADS, WholeNumber, say
from stickslip.cli.progress import ProgressBar
from stickslip.cli.targets import check_folder_target
from stickslip.errors import ScenarioError

if TYPE_CHECKING:
    from stickslip.reproduction.study import Reproduction


@click.command(
    "reproduce",
    epilog="\b\nExample:\n  stickslip reproduce --out reproduction --only fig8,fig12\n"
    "  stickslip reproduce --search --out reproduction",
)
@click.option(
    "--out",
    type=PATH,
    default=Path("reproduction"),
    show_default=True,
    help="Folder for pictures, data and the page index.html.",
)
@click.option("--only", metavar="FIGURES", help="Figures to make, such as fig8,fig12; else all.")
@click.option(
    "--measured",
    type=PATH,
    help="CSV file of digitised points: columns figure, mode, x, y, in SI units.",
)
@click.option(
    "--search",
    is_flag=True,
    help="Search continuously for the pair of settings that satisfies most statements, instead.",
)
@click.option(
    "--pairs",
    type=WholeNumber(1),
    help="Pairs of settings that --search tries.  [default: 2400, some six minutes]",
)
@click.option("--seed", type=WholeNumber(0), help="Of the draws of --search.  [default: 0]")
@THREADS
@JSON
def command(
    out: Path,
    only: str | None,
    measured: Path | None,
    search: bool,
    pairs: int | None,
    seed: int | None,
    threads: int | None,
    as_json: bool,
) -> None:
    """Redo the paper's simulations and test its statements.

    Tries what the paper leaves open, says for each of its statements S1 to S17 whether it is
    reproduced, and with which settings, and draws Figs. 2 (e) to (h) and 4 to 15.

    With --search it looks, over continuous base, hold, ramp, edge time and damping, for the pair of
    settings that satisfies most of S5 to S14 with S1 to S4 kept, says which statements cannot hold
    together, and writes all pairs that it tried to search.csv.
    """
    for option, given, needed in (
        ("--only", only, not search),
        ("--measured", measured, not search),
        ("--pairs", pairs, search),
        ("--seed", seed, search),
    ):
        if given is not None and not needed:
            raise ScenarioError(f"{option}: not allowed {'with' if search else 'without'} --search")
    if search:
        _search(out, pairs, seed or 0, threads, as_json)
        return
    from stickslip.reproduction.study import FIGURES, PAGE, SETTINGS, reproduce

    names = None if only is None else [name.strip() for name in only.split(",") if name.strip()]
    if names == []:
        raise ScenarioError(f'--only "{only}": allowed are names of figures, such as fig8,fig12')
    figures = [f"{name}{suffix}" for name in names or FIGURES for suffix in (".png", ".csv")]
    check_folder_target(out, [PAGE, SETTINGS, *figures])
    with _bar("trying settings", out) as bar:
        result = reproduce(out, only=names, measured=measured, threads=threads, progress=bar)
    click.echo(json_text(result.as_dict()) if as_json else _table(result))


def _bar(stage: str, out: Path) -> ProgressBar:
    drawn = f"{out} has what was drawn"
    return ProgressBar(stage, kept=lambda stage: drawn if stage == "drawing" else "nothing written")


def _search(out: Path, pairs: int | None, seed: int, threads: int | None, as_json: bool) -> None:
    from stickslip.reproduction.setting_search import PAIRS, POINTS, search_settings
    from stickslip.reproduction.tables import write_table

    check_folder_target(out, [POINTS])
    with _bar("grid", out) as bar:
        found = search_settings(pairs or PAIRS, seed=seed, threads=threads, progress=bar)
    out.mkdir(parents=True, exist_ok=True)
    write_table(found.points, out / POINTS)
    click.echo(json_text(found.as_dict()) if as_json else found.summary())
    say(f"{found.tried} pairs: {out / POINTS}", err=as_json)
    if found.interrupted:
        say("stickslip: interrupted, this is the best so far", err=True)
        raise KeyboardInterrupt


def _table(result: Reproduction) -> str:
    lines = [f"{mode}  {setting.text()}" for mode, setting in result.reference.items()]
    lines.append("")
    for each in result.statements:
        share = each.verdict.share
        holds = "" if share is None else f"holds for {share:.1%} of the settings"
        lines.append(f"{each.name:<4} {each.text}")
        lines.append(f"     {'; '.join(filter(None, [each.verdict.text, holds]))}")
        lines.append(f"     {each.numbers}")
    made = f"{len(result.figures)} figures in {result.seconds:.0f} s: {printable(result.page)}"
    return "\n".join([*lines, "", made])
