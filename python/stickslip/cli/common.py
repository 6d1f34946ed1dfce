"""Options that several commands have, and how a line is printed."""

from __future__ import annotations

from pathlib import Path

import click

from stickslip._util.plain_text import printable

PATH = click.Path(path_type=Path)

SET = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change a key, in SI units without their names; repeatable.",
)
THREADS = click.option(
    "--threads",
    "--jobs",
    "threads",
    type=click.IntRange(1),
    help="Simulations at a time; default: processors.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")


def say(line: str, err: bool = False) -> None:
    """Print one line, in which control characters of file names and columns are escaped."""
    click.echo(printable(line), err=err)
