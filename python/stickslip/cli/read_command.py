"""``stickslip read``."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import numpy as np

from stickslip import models
from stickslip._util.cells import number
from stickslip._util.columns import Column, Source, SourceTable
from stickslip._util.recipes import VALID, Match
from stickslip._util.text import counted, plain, shortened
from stickslip._util.units import Units, split_unit
from stickslip.cli import BAD_INPUT
from stickslip.cli.log_models import LogFile, load_model
from stickslip.cli.options import MODEL, PATH, SET_OF_MODEL, UNITS
from stickslip.cli.output import say, write_new
from stickslip.errors import ScenarioError
from stickslip.models.kinds import KINDS
from stickslip.models.log import Columns, LogRecipe

_WIDE = 24  # characters of a cell; chosen: six of them fit on a line


@click.command(
    "read",
    help="""Print how the columns of a LOG are understood, and what is missing, as options to add.

    Each column has its meaning for the model, its unit, gaps, first values and range. The exit
    status is 2 if "stickslip diagnose" would refuse the log.
    """,
    epilog="\b\nExample:\n  stickslip read log.csv --model joint\n"
    "  stickslip read log.csv --model joint --set inertia=0.1,0.002 --write joint.toml",
)
@click.argument("log", type=PATH)
@MODEL
@SET_OF_MODEL
@UNITS
@click.option(
    "--write",
    type=PATH,
    metavar="FILE.toml",
    help='Keep the file, the model, units and constants for "stickslip diagnose FILE.toml".',
)
def command(
    log: Path, model: str | None, set: dict[str, Any], units: Units, write: Path | None
) -> None:
    if write is not None and (model is None or write.suffix != ".toml"):
        raise click.UsageError("--write: allowed is the name of a .toml, with --model")
    source, made, absent, lacks = Source(log), None, dict[str, float](), list[str]()
    for term in KINDS[model].every.values() if model in KINDS else ():
        if term.absent is None and term.name not in {*set, *KINDS[str(model)].inputs}:
            lacks.append(f"--set {term.name}=VALUE,ERROR  ({term.meaning}, {term.unit})")
            absent[term.name] = 1.0
    if model is None:
        lacks.append(f"--model NAME, such as {', '.join(KINDS)}")
    else:
        made = load_model(model, set | absent, [source])
        with explained(source, made, units, lacks):
            models.read_log(source, made, units)
    _say_columns(source, made, units, lacks)
    if write is not None:
        write_new("--write", write, LogFile(log, str(model), units, set).text(write.parent))


@contextlib.contextmanager
def explained(source: Source, model: Any, units: Units, add: Sequence[str] = ()) -> Iterator[None]:
    """Where a log is refused, print why and how it is understood, and exit."""
    try:
        yield
    except ScenarioError as error:
        say(f"stickslip: {error}", err=True)
        with contextlib.suppress(ScenarioError):  # no table: the reason says all
            _say_columns(source, model, units, add, err=True)
        raise click.exceptions.Exit(BAD_INPUT) from None


@dataclass(frozen=True)
class _Tolerant(LogRecipe):
    """The recipe of a log that refuses nothing: why a column is `missing` is noted by its name."""

    missing: dict[str, str] = field(default_factory=dict)

    def matched(self, headings: Sequence[str]) -> list[Match]:
        try:
            return super().matched(headings)
        except ScenarioError:  # such as two of one name
            return [Match(text, f"{k} {text}", known=False) for k, text in enumerate(headings)]

    def _match(self, name: str, heading: Any) -> Match:
        with contextlib.suppress(ScenarioError):
            return super()._match(name, heading)
        return Match(heading.text, heading.text, known=False)

    def _missing(self, name: str, *more: Any) -> None:  # type: ignore[override]
        try:
            super()._missing(name, *more)
        except ScenarioError as error:
            self.missing[name] = str(error)

    def _check_meaning(self, *more: Any) -> None:
        pass


def _say_columns(
    source: Source, model: Any, units: Units, lacks: Sequence[str], err: bool = False
) -> None:
    """Print how the columns of a log are understood, and the options to add."""
    of = LogRecipe.of_model(model or SimpleNamespace(columns=Columns("", "-", {})), units)
    recipe = _Tolerant(of.entries, wanted=of.wanted, also_reads=of.also_reads, units=units)
    table = source.read(recipe, check=False)
    lines = [f"{table.name}: {counted(len(table), 'row')}, from {table.word} {table.lines[0]} to "
             f"{table.lines[-1]}"]  # fmt: skip
    lines += [f"{counted(len(table.ragged), 'row')} cannot be read, the first {table.word} "
              f"{table.lines[k]}: {wrong}" for k, wrong in [*table.ragged.items()][:1]]  # fmt: skip
    heads = "column", "is", "unit", "gaps", "first", "range"
    rows = [heads, *(_row(column, recipe.wanted) for column in table.columns.values())]
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    lines += ["  " + "  ".join(map(str.ljust, row, widths)) for row in rows]
    for line in (*lines, *(f"add {text}" for text in (*_lacks(recipe, table), *lacks))):
        say(line.rstrip(), err=err)


def _row(column: Column, wanted: Columns) -> tuple[str, ...]:
    what, values = column.what, column.numbers * column.what.per
    means = {"t": "time", "sd": "error of a reading", wanted.reads: f"reading: {wanted.reads}"}
    is_used = means.get(what.name, f"input: {what.name}") if what.known else "not used"
    cells = [*map(number, column.odd.values() if what.known else column.texts)]
    wrong = 0 if what.clock or not what.known else cells.count(None)
    gaps = sum(each is not None and math.isnan(each) for each in cells)
    known = values[np.isfinite(values)]
    return tuple(shortened(each, _WIDE) for each in (
        what.heading, "valid rows" if plain(what.name) in VALID else is_used,
        what.unit or split_unit(what.heading)[1] or ("" if len(known) else "date" * what.clock),
        f"{gaps}, {wrong} no number" if wrong else str(gaps),
        ", ".join(column.cell(k) for k in range(min(3, len(values)))),
        f"{known.min():.5g} to {known.max():.5g}" if len(known) else "",
    ))  # fmt: skip


def _lacks(recipe: _Tolerant, table: SourceTable) -> Iterator[str]:
    """What is missing of a log, as options to add or columns to name."""
    units = recipe.without_unit(table)
    if units:
        option = ",".join(f"{name}={unit}" for name, unit in units.items())
        yield f'--units "{option}"  (or the units that these have; si if all are SI)'
    for name, why in recipe.missing.items() if recipe.wanted.reads else ():
        options = re.findall(r"--set \w+=\w+(?:,\w+)?", why)
        yield ", or ".join([f'a column "{name} ({recipe.wanted.units[name][0]})"', *options])
