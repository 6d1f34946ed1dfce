"""The output of commands: lines, tables, JSON, files, and a bar while they work."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import stickslip
from stickslip._util import files
from stickslip._util.text import json_text, printable
from stickslip.errors import ScenarioError, prefixed

if TYPE_CHECKING:
    import pandas as pd

MOST_ROWS = 50
"""Points that are printed. Chosen: about one page; of a longer table the ends of each column."""

PATIENCE = 2.0
"""Time that passes without a bar, s. Chosen: a shorter wait needs no explanation."""

_OF_A_PART = "{desc}: {percentage:3.0f}% |{bar}| {elapsed} < {remaining}"


def say(line: object, err: bool = False) -> None:
    """Print one line, in which control characters of file names and columns are escaped."""
    click.echo(printable(line), err=err)


def print_json(values: Mapping[str, Any]) -> None:
    """Print one JSON object."""
    click.echo(json_text(values))


def print_rows(rows: Iterable[tuple[str, object]]) -> None:
    """Print names and what belongs to each."""
    rows = list(rows)
    width = max(len(name) for name, _ in rows)
    for name, text in rows:
        say(f"{name:<{width}}  {text}".rstrip())


def print_points(columns: Mapping[Any, Sequence[Any]]) -> None:
    """Print columns with a row for each point, or the ends of the numbers where these are many.

    A name is a tuple of lines.
    """
    import pandas

    table = pandas.DataFrame(columns)
    if is_long := len(table) > MOST_ROWS:
        say(f"{len(table)} points, too many to print: each column by itself; --out has them all")
        table = table.select_dtypes("number").agg(["min", "max"]).set_axis(["lowest", "highest"])
    if not table.empty:
        shown = table.to_string(index=is_long, sparsify=False, float_format="%.6g")
        click.echo(f"{shown}\n")


def check_files(read: Iterable[Path], /, **written: tuple[Path | None, tuple[str, ...]]) -> None:
    """Refuse, before the work, files of options that cannot be written, or are another's.

    `written` has the path and the suffixes of each option; () are those of a picture.
    """
    taken = {path.resolve(): "is read, and would be overwritten" for path in read}
    for name, (path, suffixes) in written.items():
        if path is None:
            continue
        with prefixed(f"--{name}", OSError):
            files.check_writable(path)
        target = path.resolve()
        if target in taken:
            raise ScenarioError(f"--{name}: {path} {taken[target]}")
        with prefixed(f"--{name}", ValueError):
            files.check_suffix(path, suffixes) if suffixes else stickslip.plot.check_format(path)
        taken[target] = f"is that of --{name} too"


def choose_folder(
    out: Path | None, as_json: bool, usual: str, written: Sequence[str] = ()
) -> Path | None:
    """Return the folder of ``--out``, in which files can be `written`; None for JSON alone."""
    folder = Path(usual) if out is None and not as_json else out
    if folder is not None:
        with prefixed("--out", OSError):
            files.check_folder(folder, written)
    return folder


def write_new(name: str, path: Path, text: str) -> None:
    """Write a text to a path that is not there; `name` is that of the argument in errors."""
    if path.is_file() or path.is_symlink():
        raise ScenarioError(f"{path} already exists: choose another name, or remove it")
    with prefixed(name, OSError):
        files.check_writable(path)
    files.write_together({path: files.text_writer(text)})
    say(f"wrote {path}")


def write_frame(frame: pd.DataFrame, path: Path) -> None:
    """Write a table as CSV, whole or not at all; headings name the units of ``attrs["units"]``."""
    units = frame.attrs.get("units", {})
    named = {name: f"{name} ({unit})" for name, unit in units.items() if unit not in ("", "-", "1")}
    with files.replacing(path) as temporary:
        frame.rename(columns=named).to_csv(temporary, index=False)


def drawn(option: str, path: Path | None, draw: Callable[[Path], object]) -> bool:
    """Whether a picture, if it is wanted, could be drawn; else it says why not."""
    try:
        if path is not None:
            draw(path)
    except (AttributeError, RuntimeError, ValueError) as error:  # a run that ended too early, say
        say(f"stickslip: {option}: nothing drawn: {error}", err=True)
        return False
    return True


def save_plot(figure: str, *what: Any) -> Callable[[Path], object]:
    """A function that draws by one of `stickslip.plot` and writes to a path."""
    return lambda path: stickslip.plot.save(getattr(stickslip.plot, figure)(*what), path)


@contextlib.contextmanager
def progress_bar(points: int = 0) -> Iterator[Callable[[float, str], None]]:
    """A function that takes the part that is done, 0 to 1, and the stage, and shows both.

    With a number of `points` the bar shows their count and rate.
    """
    from tqdm import tqdm  # 40 ms that most commands do not need

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
