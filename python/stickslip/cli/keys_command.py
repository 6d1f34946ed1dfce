"""``stickslip keys``."""

from __future__ import annotations

import textwrap

import click

from stickslip._util.strict_json import json_text
from stickslip.cli.common import JSON
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import FILE, Key, known_keys, section_hint, shown

_FILE_MEANING = (
    'CSV file of voltages, relative to the scenario, with mode = "program": columns t (s), xp, xm, '
    "yp, ym, clamp (V), straight lines between the rows, a repeated t is a jump"
)


@click.command("keys", epilog="\b\nExample:\n  stickslip keys drive")
@click.argument("section", required=False)
@JSON
def command(section: str | None, as_json: bool) -> None:
    """List all keys of a scenario, or those of one SECTION, such as drive or effects.

    Each with its unit, its default, its range and what it means. A key is set by its section in a
    scenario, by --set SECTION.KEY=VALUE, or varied by --vary.
    """
    keys = [
        key
        for key in known_keys().values()
        if section in (None, key.section) or key.section.startswith(f"{section}.")
    ]
    if not keys:
        raise ScenarioError(f"{section}: there is no such section; {section_hint(str(section))}")
    if as_json:
        click.echo(json_text({"keys": [as_dict(key) for key in keys]}))
        return
    blocks = [
        "\n".join([f"[{name}]", *(_as_text(key) for key in keys if key.section == name)])
        for name in dict.fromkeys(key.section for key in keys)
    ]
    click.echo("\n\n".join(blocks))


def as_dict(key: Key) -> dict[str, object]:
    """A key as an object of JSON."""
    fields = ("unit", "low", "high", "allowed", "default", "meaning")
    return {"key": key.name, **{name: getattr(key, name) for name in fields}}


def _as_text(key: Key) -> str:
    name = key.name.rpartition(".")[2]
    unit = "" if key.unit == "-" or isinstance(key.default, str) else f" {key.unit}"
    lines = indented(f"{name} = {shown(key.default)}{unit}: {key.meaning}; {key.allowed}")
    if key.name == "drive.mode":
        lines += indented(f"{FILE.rpartition('.')[2]}: {_FILE_MEANING}")
    return "\n".join(lines)


def indented(text: str) -> list[str]:
    """Lines of a text, those after the first further in."""
    # Chosen: like the width of the help texts, 100, with a margin.
    return textwrap.wrap(text, 96, initial_indent="    ", subsequent_indent="        ")
