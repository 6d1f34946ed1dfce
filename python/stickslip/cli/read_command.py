"""``stickslip read``."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NoReturn

import click
import numpy as np

from stickslip import models
from stickslip._util.cells import number
from stickslip._util.columns import Column, Source, SourceTable
from stickslip._util.files import check_suffix
from stickslip._util.recipes import VALID, Match
from stickslip._util.text import counted, plain, shortened
from stickslip._util.units import Units, is_of, split_unit
from stickslip.cli import BAD_INPUT
from stickslip.cli.log_models import load_model
from stickslip.cli.log_recipe import Kept
from stickslip.cli.options import MODEL, PATH, SET_OF_MODEL, UNITS
from stickslip.cli.output import say, write_new
from stickslip.errors import ScenarioError, prefixed
from stickslip.models.kinds import KINDS
from stickslip.models.log import Columns, LogRecipe
from stickslip.models.model import Term

_HEADS = "column", "is", "unit", "gaps", "first", "range"
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
    if write is not None:
        with prefixed("--write", ValueError):
            check_suffix(write, (".toml",))
        if model is None:
            raise click.UsageError("--write: allowed with --model only")
    source, made = Source(log), None
    absent = _absent(model, set) if model in KINDS else {}
    if model is not None:
        made = load_model(model, set | dict.fromkeys(absent, 1.0), [source])
        try:
            models.read_log(source, made, units)
        except ScenarioError as error:
            refuse_log(source, made, units, error, absent.values())
    lacks = say_columns(source, made, units, absent.values())
    if write is not None:
        if lacks:
            raise ScenarioError(f"--write: allowed is a log that lacks nothing; add {lacks[0]}")
        write_new("--write", write, Kept(log, str(model), set, units).text(write.parent))


def refuse_log(
    source: Source, model: Any, units: Units, reason: object, absent: Iterable[Term] = ()
) -> NoReturn:
    """Print why a log cannot be read, and how it is understood, and exit."""
    say(f"stickslip: {reason}", err=True)
    with contextlib.suppress(ScenarioError):  # no table: the reason says all
        say_columns(source, model, units, absent, err=True)
    raise click.exceptions.Exit(BAD_INPUT)


@dataclass(frozen=True)
class _Tolerant(LogRecipe):
    """The recipe of a log that refuses nothing: what is `missing` is noted."""

    missing: list[str] = field(default_factory=list)

    def matched(self, headings: Sequence[str]) -> list[Match]:
        try:
            return super().matched(headings)
        except ScenarioError:  # two of one name, or a wrong unit
            return [Match(text, f"{k} {text}", known=False) for k, text in enumerate(headings)]

    def _missing(self, name: str, *more: Any) -> None:  # type: ignore[override]
        self.missing.append(name)

    def _check_meaning(self, *more: Any) -> None:
        pass

    def _check_needs(self, *more: Any) -> None:
        pass


def _tolerant(model: Any, units: Units) -> _Tolerant:
    made = LogRecipe.of_model(model or SimpleNamespace(columns=Columns("", "-", {})), units)
    return _Tolerant(made.entries, wanted=made.wanted, also_reads=made.also_reads, units=units)


def say_columns(
    source: Source, model: Any, units: Units, absent: Iterable[Term], err: bool = False
) -> list[str]:
    """Print how the columns of a log are understood, and return the options to add."""
    recipe = _tolerant(model, units)
    table = source.read(recipe, check=False)
    say(f"{table.name}: {counted(len(table), 'row')}, from {table.word} {table.lines[0]} to "
        f"{table.lines[-1]}", err=err)  # fmt: skip
    for k, wrong in [*table.ragged.items()][:1]:
        say(f"{counted(len(table.ragged), 'row')} cannot be read, the first {table.word} "
            f"{table.lines[k]}: {wrong}", err=err)  # fmt: skip
    rows = [_HEADS, *(_row(column, recipe.wanted) for column in table.columns.values())]
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    for row in rows:
        cells = (f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True))
        say(f"  {'  '.join(cells)}".rstrip(), err=err)
    lacks = [*_lacks(recipe, table, model), *map(_stated, absent)]
    for text in lacks:
        say(f"add {text}", err=err)
    return lacks


def _row(column: Column, wanted: Columns) -> tuple[str, ...]:
    what, values = column.what, column.numbers * column.what.per
    means = {"t": "time", "sd": "error of a reading", wanted.reads: f"reading: {wanted.reads}",
             **{name: f"input: {name}" for name in wanted.inputs}}  # fmt: skip
    is_used = "valid rows" if plain(what.name) in VALID else "not used"
    cells = [*map(number, column.odd.values() if what.known else column.texts)]
    wrong = 0 if what.clock or not what.known else cells.count(None)
    gaps = str(sum(each is not None and math.isnan(each) for each in cells))
    known = values[np.isfinite(values)]
    dated = what.clock and not len(known)
    return tuple(shortened(each, _WIDE) for each in (
        what.heading, means[what.name] if what.known else is_used,
        what.unit or split_unit(what.heading)[1] or ("date" if dated else ""),
        f"{gaps}, {wrong} no number" if wrong else gaps,
        ", ".join(column.cell(k) for k in range(min(3, len(values)))),
        f"{known.min():.5g} to {known.max():.5g}" if len(known) else "",
    ))  # fmt: skip


def _lacks(recipe: _Tolerant, table: SourceTable, model: Any) -> Iterator[str]:
    """What is missing of a log, as options to add or columns to name."""
    units = recipe.without_unit(table)
    if (time := table.known.get("t")) and not np.isfinite(time.values).any():  # dates
        units.pop(time.what.heading, None)
    if units:
        option = ",".join(f"{name}={unit}" for name, unit in units.items())
        yield f'--units "{option}"  (or the units that these have; si if all are SI)'
    kind = getattr(model, "kind", None)
    for name in filter(None, recipe.missing):
        call = f'a column "{name} ({recipe.wanted.units[name][0]})"'
        others = [other for other in (kind.reads if kind and name == recipe.wanted.reads else ())
                  if other not in _missing_of(table, kind.name, other)]  # fmt: skip
        more = f", or --set reads={others[0]}" if others else ""
        more += f", or --set {name}=VALUE" if name in recipe.wanted.constants else ""
        yield call + more
    free = [split_unit(text)[1] for text in table.others]
    if kind and any(unit and is_of(unit, "A") for unit in free):
        for term in kind.every.values():
            if term.unit.endswith("/A") and term.name not in model.known:
                yield _stated(term)
    if model is None:
        fit = [name for name, kind in KINDS.items()
               if not all(_missing_of(table, name, reads) for reads in kind.reads)]  # fmt: skip
        yield f"--model {' or '.join(fit or KINDS)}"


def _stated(term: Term) -> str:
    return f"--set {term.name}=VALUE,ERROR  ({term.meaning}, {term.unit})"


def _absent(name: str, known: Mapping[str, Any]) -> dict[str, Term]:
    """Constants of a ready-made model that have to be stated and are not."""
    kind = KINDS[name]
    return {term.name: term for term in kind.every.values()
            if term.absent is None and term.name not in {*known, *kind.inputs}}  # fmt: skip


def _missing_of(table: SourceTable, name: str, reads: str) -> list[str]:
    """Columns that a ready-made model misses of a table."""
    more = {"reads": reads} if len(KINDS[name].reads) > 1 else {}
    model = getattr(models, name)(**more, **dict.fromkeys(_absent(name, {}), 1.0))
    recipe = _tolerant(model, None)
    recipe.matched([column.what.heading for column in table.columns.values()])
    return recipe.missing
