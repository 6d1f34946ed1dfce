"""Options that several commands have, and how a line is printed and a picture drawn."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from stickslip._util.text import printable
from stickslip.cli.completion import setting, settings

_F = TypeVar("_F", bound=Callable[..., Any])


class WholeNumber(click.IntRange):
    """A whole number of an option, refused with the ones that are allowed."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number, or a usage error."""
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter:
            allowed = f"from {self.min}" if self.max is None else f"from {self.min} to {self.max}"
            self.fail(f"{value!r}; allowed is a whole number {allowed}.", param, ctx)


PATH = click.Path(path_type=Path)

SET = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="KEY=VALUE",
    shell_complete=setting,
    help="Change a key, in SI units without their names; repeatable.",
)


def vary_option(required: bool) -> Callable[[_F], _F]:
    """``--vary``, of which a sweep needs one."""
    return click.option(
        "--vary",
        "vary",
        multiple=True,
        required=required,
        metavar="KEY=VALUES",
        shell_complete=settings,
        help="A key and its values, start:stop:count with both ends, or a,b,c; repeatable.",
    )


UNCERTAIN = click.option(
    "--uncertain",
    type=PATH,
    help="A TOML file whose [uncertain] takes the place of the scenario's: a measurement, another "
    "scenario, or the extended.toml of a diagnosis.",
)
THREADS = click.option(
    "--threads",
    "--jobs",
    "threads",
    type=WholeNumber(1),
    help="Simulations at a time; default: processors.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")


def say(line: str, err: bool = False) -> None:
    """Print one line, in which control characters of file names and columns are escaped."""
    click.echo(printable(line), err=err)


def draw(path: Path, figure: str, *what: Any) -> bool:
    """Write the picture of a function of `stickslip.plot`; False if there is nothing to draw."""
    from stickslip import plot

    try:
        drawn = getattr(plot, figure)(*what)
    except ValueError as error:  # for instance of a run that failed before the time that is drawn
        return nothing_drawn("--plot", error)
    plot.save(drawn, path)
    return True


def nothing_drawn(option: str, error: ValueError) -> bool:
    """Say why an option gave no picture; False."""
    say(f"stickslip: {option}: nothing drawn: {error}", err=True)
    return False
