"""Single lines of output, with what they say about names of files and columns."""

from __future__ import annotations

import click

from stickslip._util.plain_text import printable


def say(line: str, err: bool = False) -> None:
    """Print one line, in which nothing can steer the terminal."""
    click.echo(printable(line), err=err)
