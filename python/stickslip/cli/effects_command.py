"""``stickslip effects``."""

from __future__ import annotations

import click

from stickslip.cli.keys_command import as_dict, having, indented
from stickslip.cli.options import JSON
from stickslip.cli.output import print_json
from stickslip.errors import ScenarioError
from stickslip.scenario.effects import Effect, effects, suggested_effect
from stickslip.scenario.keys import PREFIX


@click.command(
    "effects",
    help="""List the effects of the model, or those that have a WORD in their name.

    Where no name has it, meanings are searched.

    Each is printed with its meaning, its parameters with unit, range and default, and its source.
    An effect is used by a section [effects.NAME] in a scenario, or by --set
    effects.NAME.PARAMETER=VALUE.
    """,
    epilog="\b\nExample:\n  stickslip effects surface_tilt\n  stickslip effects drag",
)
@click.argument("word", required=False, default="")
@JSON
def command(word: str, as_json: bool) -> None:
    names = having(word.removeprefix(PREFIX), {effect.name: effect.meaning for effect in effects()})
    if not names:
        raise ScenarioError(f"{word}: no effect has this word; {suggested_effect(word)}")
    chosen = [effect for effect in effects() if effect.name in names]
    if as_json:
        print_json({"effects": [_as_dict(effect) for effect in chosen]})
    else:
        click.echo("\n\n".join(map(_text, chosen)))


def _as_dict(effect: Effect) -> dict[str, object]:
    fields = {name: getattr(effect, name) for name in ("name", "meaning", "source")}
    names = {key.name.rpartition(".")[2]: key for key in effect.parameters}
    return {**fields, "parameters": [{"name": name, **as_dict(key)} for name, key in names.items()]}


def _text(effect: Effect) -> str:
    lines = [f"[{PREFIX}{effect.name}]", indented(effect.meaning)]
    for key in effect.parameters:
        name = key.name.rpartition(".")[2]
        default = f"default {key.default} {key.unit}".removesuffix(" -")
        lines.append(indented(f"{name}: {key.meaning}; {key.allowed}; {default}"))
    return "\n".join([*lines, indented(f"source: {effect.source}")])
