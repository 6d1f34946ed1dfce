"""``stickslip reproduce``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip._util.text import json_text
from stickslip.cli.common import JSON, PATH, THREADS, say
from stickslip.cli.progress import ProgressBar
from stickslip.cli.targets import check_folder_target

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
    help="Folder for figures (PNG and CSV) and the tables of statements and settings (CSV).",
)
@click.option("--only", metavar="FIGURES", help="Figures to make, such as fig8,fig12; else all.")
@THREADS
@JSON
def command(out: Path, only: str | None, threads: int | None, as_json: bool) -> None:
    """Redo the paper's simulations and test its statements.

    Tries what the paper leaves open, says for each of its statements S1 to S17 whether it is
    reproduced, and with which settings, and draws Figs. 2 (e) to (h) and 4 to 15.
    """
    from stickslip.reproduction.study import chosen, output_files, reproduce

    names = chosen(None if only is None else [name.strip() for name in only.split(",")])
    check_folder_target(out, output_files(names))
    with ProgressBar("trying settings") as bar:
        result = reproduce(out, only=names, threads=threads, progress=bar)
    click.echo(json_text(result.as_dict()) if as_json else _table(result))
    say(f"{len(names)} figures: {out}", err=as_json)


def _table(result: Reproduction) -> str:
    from stickslip.reproduction.study import numbers_text

    lines = [f"{mode}  {setting}" for mode, setting in result.reference.items()]
    for each in result.statements.to_dict("records"):
        share = (
            "" if each["share"] != each["share"] else f"; holds for {each['share']:.1%} of pairs"
        )
        depends = each["settings"] and f", most often with {each['settings']}"
        lines += [
            "",
            f"{each['statement']:<4} {each['text']}",
            f"     {each['verdict']}{share}{depends}",
            f"     {numbers_text(each['numbers'])}",
        ]
    return "\n".join(lines)
