"""``stickslip effects``."""

from __future__ import annotations

import click

from stickslip._util.strict_json import json_text
from stickslip.cli.common import JSON
from stickslip.cli.keys_command import as_dict, indented
from stickslip.errors import ScenarioError
from stickslip.scenario.named_effects import PREFIX, Effect, effects, suggested_effect


@click.command("effects", epilog="\b\nExample:\n  stickslip effects surface_tilt")
@click.argument("name", required=False)
@JSON
def command(name: str | None, as_json: bool) -> None:
    """List the named extensions of the model, or one of them by its NAME.

    What each does, its parameters with unit, range and default, and its source. An extension is
    used by a section [effects.NAME] in a scenario, or by --set effects.NAME.PARAMETER=VALUE.
    """
    chosen = [each for each in effects() if name is None or each.name == name]
    if not chosen:
        hint = suggested_effect(str(name))
        raise ScenarioError(f"{name}: there is no such extension; {hint}")
    if as_json:
        click.echo(json_text({"effects": [_as_dict(effect) for effect in chosen]}))
        return
    click.echo("\n\n".join(_as_text(effect) for effect in chosen))


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
        lines += indented(f"{name}: {key.meaning}; {key.allowed}; default {key.default}")
    return "\n".join([*lines, *indented(f"source: {effect.source}")])
