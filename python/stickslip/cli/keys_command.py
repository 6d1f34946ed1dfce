"""``stickslip keys``."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

import click

from stickslip._util.text import json_text
from stickslip.cli.common import JSON
from stickslip.cli.completion import key_or_section
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Key, full_name, key_hint, known_keys, shown
from stickslip.scenario.path_keys import COIL_MAP, FILE

_PATHS = {
    "drive.mode": (
        FILE,
        'CSV file of voltages, relative to the scenario, with mode = "program": columns t (s), xp, '
        "xm, yp, ym, clamp (V), straight lines between the rows, a repeated t is a jump",
    ),
    "coil.turns": (
        COIL_MAP,
        "CSV or netCDF file of the measured field per ampere, relative to the scenario, in place "
        "of that of side, distance and turns: columns x, y, z (m), coil, Bx, By, Bz (T/A)",
    ),
}
"""Keys that hold a path, with their meaning, by the key that they are shown beside."""


@click.command("keys", epilog="\b\nExample:\n  stickslip keys drive\n  stickslip keys friction")
@click.argument("word", required=False, shell_complete=key_or_section)
@JSON
def command(word: str | None, as_json: bool) -> None:
    """List all keys of a scenario, or those that a WORD stands for.

    WORD is a section, such as drive or effects; a key, such as drive.frequency; or else any text
    that is in the name or the meaning of a key.

    Each is printed with its unit, its default, its range and what it means. A key is set by its
    section in a scenario, by --set SECTION.KEY=VALUE, or varied by --vary.
    """
    keys = _chosen(word)
    if as_json:
        click.echo(json_text({"keys": [as_dict(key) for key in keys]}))
        return
    blocks = [
        "\n".join([f"[{name}]", *(_as_text(key) for key in keys if key.section == name)])
        for name in dict.fromkeys(key.section for key in keys)
    ]
    click.echo("\n\n".join(blocks))


def _chosen(word: str | None) -> list[Key]:
    """All keys; or one, those of a section, or those that have a word, in this order."""
    keys = known_keys()
    if word is None:
        return list(keys.values())
    beside = [key for key, (name, _) in _PATHS.items() if word == name]
    name = beside[0] if beside else full_name(word)
    if name in keys:
        return [keys[name]]
    found = [each for each in keys.values() if f"{each.section}.".startswith(f"{word}.")]
    found = found or [each for each in keys.values() if has_word(word, each.name, each.meaning)]
    if not found:
        sections = {each.section for each in keys.values()}
        hint = key_hint(word, [*sections, *words_of(keys, word)])
        raise ScenarioError(
            f"{word}: there is no such section or key, and none has this word; {hint}"
        )
    return found


def words_of(names: Iterable[str], word: str) -> list[str]:
    """What names are put together from, any of which may be meant by a word that is itself one."""
    if "_" in word or "." in word:
        return []
    return sorted({part for name in names for part in name.replace("_", ".").split(".")})


def has_word(word: str, *texts: str) -> bool:
    """Whether one of some texts has a word, in whatever case; a space in it may stand for _."""
    wanted = word.casefold().replace("_", " ").strip()
    return any(wanted in text.casefold().replace("_", " ") for text in texts)


def as_dict(key: Key) -> dict[str, object]:
    """A key as an object of JSON."""
    fields = ("unit", "low", "high", "allowed", "default", "meaning")
    return {"key": key.name, **{name: getattr(key, name) for name in fields}}


def _as_text(key: Key) -> str:
    name = key.name.rpartition(".")[2]
    unit = "" if key.unit == "-" or isinstance(key.default, str) else f" {key.unit}"
    lines = indented(f"{name} = {shown(key.default)}{unit}: {key.meaning}; {key.allowed}")
    if key.name in _PATHS:
        path, meaning = _PATHS[key.name]
        lines += indented(f"{path.rpartition('.')[2]}: {meaning}")
    return "\n".join(lines)


def indented(text: str) -> list[str]:
    """Lines of a text, those after the first further in."""
    # Chosen: like the width of the help texts, 100, with a margin.
    return textwrap.wrap(text, 96, initial_indent="    ", subsequent_indent="        ")
