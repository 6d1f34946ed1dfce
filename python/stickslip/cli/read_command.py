"""``stickslip read``."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from stickslip import models
from stickslip._util.columns import Source
from stickslip._util.units import Units
from stickslip.cli import BAD_INPUT
from stickslip.cli.log_models import format_recipe, load_model
from stickslip.cli.options import MODEL, PATH, SET_OF_MODEL, UNITS
from stickslip.cli.output import say, write_new
from stickslip.diagnosis.data.series import Series
from stickslip.errors import ScenarioError
from stickslip.models.kinds import KINDS
from stickslip.models.log import explain_log


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
    help='Keep the log, model, units and constants for "stickslip diagnose FILE.toml".',
)
def command(
    log: Path, model: str | None, set: dict[str, Any], units: Units, write: Path | None
) -> None:
    if write is not None and (model is None or write.suffix != ".toml"):
        raise click.UsageError("--write: allowed is the name of a .toml, with --model")
    source, made, notes = Source(log), None, list[Any]()
    lacks = [f"--model NAME, such as {', '.join(KINDS)}"]
    if model is not None:
        terms = KINDS[model].every.values() if model in KINDS else ()
        absent = [term for term in terms if term.absent is None
                  and term.name not in {*set, *KINDS[model].inputs}]  # fmt: skip
        lacks = [f"--set {each.name}=VALUE,ERROR  ({each.meaning}, {each.unit})" for each in absent]
        made = load_model(model, set | {term.name: 1.0 for term in absent}, [source])
        notes = read_or_explain(source, made, units, lacks).notes
    _explain(source, made, units, lacks)
    for note in notes:
        say(f"note: {note}")
    if write is not None:
        write_new("--write", write, format_recipe(log, str(model), units, set, write.parent))
    if lacks and model:
        raise click.exceptions.Exit(BAD_INPUT)


def read_or_explain(source: Source, model: Any, units: Units, lacks: Sequence[str] = ()) -> Series:
    """Return the log of a model, or print why it is refused and how it is understood, and exit."""
    try:
        model.terms(log := models.read_log(source, model, units))
        return log
    except ScenarioError as error:
        say(f"stickslip: {error}", err=True)
        with contextlib.suppress(ScenarioError):  # no table: the reason says all
            _explain(source, model, units, lacks, err=True)
        raise click.exceptions.Exit(BAD_INPUT) from None


def _explain(
    source: Source, model: Any, units: Units, lacks: Sequence[str], err: bool = False
) -> None:
    columns, needed = explain_log(source, model, units)
    for line in (*columns, *(f"needed: {text}" for text in (*needed, *lacks))):
        say(line, err=err)
