"""What a command prints and writes: lines, tables, JSON, a bar of progress, files."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import click
from tqdm import tqdm

from stickslip._util.files import check_writable
from stickslip._util.text import json_text, printable
from stickslip.errors import ScenarioError, prefixed

PATIENCE = 2.0
"""Time that passes without a bar, s. Chosen: a shorter wait needs no explanation."""

MOST_ROWS = 50
"""Points that are printed. Chosen: about one page; a longer table is in the file alone."""

_OF_A_PART = "{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}"


def say(line: object, err: bool = False) -> None:
    """Print one line, in which control characters of file names and columns are escaped."""
    click.echo(printable(line), err=err)


def print_json(found: Mapping[str, Any]) -> None:
    """Print one JSON object."""
    click.echo(json_text(found))


def print_rows(rows: Iterable[tuple[str, object]]) -> None:
    """Print names and what belongs to each."""
    rows = list(rows)
    width = max(len(name) for name, _ in rows)
    for name, text in rows:
        say(f"{name:<{width}}  {text}".rstrip())


@contextlib.contextmanager
def progress_bar(points: int = 0) -> Iterator[Callable[[float, str], None]]:
    """A function that takes the part that is done, 0 to 1, and the stage, and shows both.

    With a number of `points` the bar shows their count and rate.
    """
    with tqdm(
        total=points or 1.0,
        delay=PATIENCE,
        leave=False,
        bar_format=None if points else _OF_A_PART,
        unit=" points",
        mininterval=0.1 if sys.stderr.isatty() else PATIENCE,  # in a log each update is a line
    ) as bar:

        def show(fraction: float, stage: str) -> None:
            bar.set_description_str(stage, refresh=False)
            bar.update(round(fraction * points) - bar.n if points else fraction - bar.n)

        yield show


def check_files(written: Mapping[str, Path | None], read: Iterable[Path]) -> None:
    """Refuse, before the work, files of options that cannot be written, or are another's."""
    taken = {path.resolve(): "is read, and would be overwritten" for path in read}
    for option, path in written.items():
        if path is None:
            continue
        with prefixed(option, OSError):
            check_writable(path)
        place = path.resolve()
        if place in taken:
            raise ScenarioError(f"{option}: {path} {taken[place]}")
        taken[place] = f"is that of {option} too"


def drawn(option: str, draw: Callable[[], object]) -> bool:
    """Whether there was something to draw; else it says why not."""
    try:
        draw()
    except (AttributeError, RuntimeError, ValueError) as error:  # a run that ended too early, say
        say(f"stickslip: {option}: nothing drawn: {error}", err=True)
        return False
    return True


def print_points(columns: Mapping[tuple[str, ...], Sequence[Any]]) -> None:
    """Print columns with a row for each point, if these are few; a heading is several lines."""
    import pandas

    table = pandas.DataFrame(columns)
    if 0 < len(table) <= MOST_ROWS:
        click.echo(table.to_string(index=False, sparsify=False, float_format="%.6g") + "\n")
