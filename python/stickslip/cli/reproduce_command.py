"""``stickslip reproduce``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip._util.plain_text import printable
from stickslip._util.strict_json import json_text
from stickslip.cli.common import JSON, PATH, THREADS
from stickslip.cli.progress import ProgressBar
from stickslip.cli.targets import check_folder_target
from stickslip.errors import ScenarioError

if TYPE_CHECKING:
    from stickslip.reproduction.study import Reproduction


@click.command(
    "reproduce",
    epilog="\b\nExample:\n  stickslip reproduce --out reproduction --only fig8,fig12",
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
@THREADS
@JSON
def command(
    out: Path, only: str | None, measured: Path | None, threads: int | None, as_json: bool
) -> None:
    """Redo the paper's simulations and test its statements.

    Tries what the paper leaves open, says for each of its statements S1 to S17 whether it is
    reproduced, and with which settings, and draws Figs. 2 (e) to (h) and 4 to 15.
    """
    from stickslip.reproduction.study import FIGURES, PAGE, SETTINGS, reproduce

    names = None if only is None else [name.strip() for name in only.split(",") if name.strip()]
    if names == []:
        raise ScenarioError(f'--only "{only}": allowed are names of figures, such as fig8,fig12')
    figures = [f"{name}{suffix}" for name in names or FIGURES for suffix in (".png", ".csv")]
    check_folder_target(out, [PAGE, SETTINGS, *figures])
    with ProgressBar("trying settings") as bar:
        result = reproduce(out, only=names, measured=measured, threads=threads, progress=bar)
    click.echo(json_text(result.as_dict()) if as_json else _table(result))


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
