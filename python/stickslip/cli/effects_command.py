"""``stickslip effects``."""

from __future__ import annotations

import click

from stickslip._util.text import json_text
from stickslip.cli.common import JSON
from stickslip.cli.completion import effect
from stickslip.cli.keys_command import as_dict, has_word, indented, words_of
from stickslip.errors import ScenarioError
from stickslip.scenario.named_effects import (
    PREFIX,
    Effect,
    effects,
    is_free_shape,
    suggested_effect,
)


@click.command(
    "effects", epilog="\b\nExample:\n  stickslip effects surface_tilt\n  stickslip effects drag"
)
@click.argument("word", required=False, shell_complete=effect)
@JSON
def command(word: str | None, as_json: bool) -> None:
    """List the named extensions of the model, or those that a WORD stands for.

    WORD is the name of one, or else any text that is in the name of one or in what it adds; laws of
    a free shape are among those only where no others are.

    Each is printed with what it does, its parameters with unit, range and default, and its source.
    An extension is used by a section [effects.NAME] in a scenario, or by --set
    effects.NAME.PARAMETER=VALUE.
    """
    chosen = _chosen(word)
    if as_json:
        click.echo(json_text({"effects": [_as_dict(effect) for effect in chosen]}))
        return
    click.echo("\n\n".join(_as_text(effect) for effect in chosen))


def _chosen(word: str | None) -> list[Effect]:
    """All extensions; or one, or those that have a word."""
    if word is None:
        return list(effects())
    name = word.removeprefix(PREFIX)
    one = [each for each in effects() if each.name == name]
    found = one or [each for each in effects() if has_word(name, each.name, each.meaning)]
    if not found:
        hint = suggested_effect(name, words_of((each.name for each in effects()), name))
        raise ScenarioError(f"{word}: there is no such extension, and none has this word; {hint}")
    return [each for each in found if not is_free_shape(each.name)] or found


def _as_dict(effect: Effect) -> dict[str, object]:
    return {
        "name": effect.name,
        "meaning": effect.meaning,
        "source": effect.source,
        "parameters": [
            {"name": key.name.rpartition(".")[2], **as_dict(key)} for key in effect.parameters
        ],
    }


def _as_text(effect: Effect) -> str:
    lines = [f"[{PREFIX}{effect.name}]", *indented(effect.meaning)]
    for key in effect.parameters:
        name = key.name.rpartition(".")[2]
        default = f"default {key.default} {key.unit}".removesuffix(" -")
        lines += indented(f"{name}: {key.meaning}; {key.allowed}; {default}")
    return "\n".join([*lines, *indented(f"source: {effect.source}")])
