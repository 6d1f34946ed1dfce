"""``stickslip reproduce``."""

from __future__ import annotations

from pathlib import Path

import click

import stickslip
from stickslip.cli.options import FOLDER, JSON, THREADS
from stickslip.cli.output import print_json, progress_bar, say
from stickslip.errors import prefixed


@click.command(
    "reproduce",
    help="""Redo the paper's simulations and test its statements.

    Tries what the paper leaves open, says for each of its statements S1 to S17 whether it is
    reproduced, and with which settings, and draws Figs. 2 (e) to (h) and 4 to 15.
    """,
    epilog="\b\nExample:\n  stickslip reproduce --out reproduction --only fig8,fig12",
)
@click.option(
    "--out",
    type=FOLDER,
    default=Path("reproduction"),
    help="Folder for figures (PNG and CSV), statements.csv and settings.csv.",
)
@click.option("--only", metavar="FIGURES", help="Figures to make, such as fig8,fig12; else all.")
@THREADS
@JSON
def command(out: Path, only: str | None, threads: int | None, as_json: bool) -> None:
    names = None if only is None else [name.strip() for name in only.split(",")]
    with progress_bar() as bar, prefixed("--out", OSError):
        result = stickslip.reproduce(out, only=names, threads=threads, progress=bar)
    if as_json:
        print_json(result.as_dict())
    else:
        click.echo(result.summary())
    say(f"{len(result.figures)} figures: {out}", err=as_json)
