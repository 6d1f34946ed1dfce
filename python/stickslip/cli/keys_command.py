"""``stickslip keys``."""

from __future__ import annotations

import re
import textwrap

import click

from stickslip import _core
from stickslip._util.messages import shown
from stickslip.cli.options import JSON, key_names
from stickslip.cli.output import print_json
from stickslip.errors import ScenarioError
from stickslip.scenario.held import OBJECTS, PATHS
from stickslip.scenario.keys import LAWS, SECTIONS_BESIDE, Key, key_hint, known_keys

FILES = {held.section: f"{held.about}; relative to the scenario" for held in OBJECTS.values()}
"""Keys that name a file, by their section."""

_OTHERS = {
    **{key: FILES[held.section] for key, held in PATHS.items()},
    **dict.fromkeys(
        ("coil.field_per_ampere", "coil.radius", "coil.rise_time"),
        "coils as they are measured, in place of turns: field_per_ampere (T/A), distance, side or "
        "radius, resistance, inductance or rise_time (s); in Python Coil.of",
    ),
    **dict.fromkeys(
        ("robot.material", "robot.density"),
        'material = "NdFeB N42", or density (kg/m^3), in place of mass, beside length, width and '
        "height; in Python Robot.of",
    ),
    **{f"[{section}]": about for section, about in SECTIONS_BESIDE.items()},
    **dict.fromkeys(
        ("[[velocity]]", "[[tracking]]", "[[angle]]", "[[field]]"),
        'sections of a measurement file, which "stickslip diagnose TABLE.csv" prints for the '
        "columns of a table",
    ),
}
"""Words of files that are no keys of a scenario."""


@click.command(
    "keys",
    help="""List all keys of a scenario, and other words of files, or those that have a WORD in
    their name.

    WORD is a word of names or their beginning, such as drive, frict or drive.frequency; where no
    name has it, meanings are searched.

    Each is printed with its unit, default, meaning, range and usual values. A key is set by its
    section in a scenario, by --set SECTION.KEY=VALUE, or varied by --vary.
    """,
    epilog="\b\nExample:\n  stickslip keys drive\n  stickslip keys friction",
)
@click.argument("word", required=False, default="", shell_complete=key_names)
@JSON
def command(word: str, as_json: bool) -> None:
    known = [*known_keys().values(), *(known_keys()[f"{LAWS}NAME.{key}"] for key in _core.law_keys)]
    names = having(word, {k.name: k.meaning for k in known} | _OTHERS)
    if not names and word in known_keys():  # of a law by its own name
        names = [word]
    if not names:
        raise ScenarioError(f"{word}: no key has this word; {key_hint(word)}")
    keys = [known_keys()[name] for name in names if name not in _OTHERS]
    others = {name: _OTHERS[name] for name in names if name in _OTHERS}
    if as_json:
        print_json({"keys": [as_dict(key) for key in keys], "others": others})
        return
    blocks = []
    for section in dict.fromkeys(key.section for key in keys):
        lines = [_line(key) for key in keys if key.section == section]
        blocks.append("\n".join([f"[{section}]", *lines]))
    for about in dict.fromkeys(others.values()):
        alike = ", ".join(name for name, text in others.items() if text == about)
        blocks.append(f"{alike}\n{indented(about)}")
    click.echo("\n\n".join(blocks))


def having(word: str, meanings: dict[str, str]) -> list[str]:
    """The names that have a word, in whatever case and number, or else those whose meanings do.

    Where no word is the whole one, those that begin so count: "oil" is no part of "coil".
    """
    if not word:
        return list(meanings)
    one = re.sub("(?<=..)s$", "", re.sub("ies$", "y", word.casefold()))
    forms = "|".join(map(re.escape, (word, one, f"{one}s", re.sub("y$", "ies", one))))
    for texts in ({name: name for name in meanings}, meanings):
        for form in (rf"(?:{forms})(?![^\W_])", re.escape(word)):
            has = re.compile(rf"(?<![^\W_]){form}", re.IGNORECASE)
            if names := [name for name, text in texts.items() if has.search(text)]:
                return names
    return []


def as_dict(key: Key) -> dict[str, object]:
    """A key as an object of JSON."""
    fields = ("unit", "low", "high", "usual", "allowed", "default", "meaning")
    row = {"key": key.name, **{name: getattr(key, name) for name in fields}}
    return row | {"default": None} if key.name.startswith(LAWS) else row


def indented(text: str) -> str:
    """A text in lines, those after the first further in."""
    # Chosen: like the width of the help texts, 100, with a margin.
    return textwrap.fill(text, 96, initial_indent="    ", subsequent_indent="        ")


def _line(key: Key) -> str:
    unit = "" if key.unit == "-" or isinstance(key.default, str) else f" {key.unit}"
    name = key.name.rpartition(".")[2]
    default = "" if key.name.startswith(LAWS) else f" = {shown(key.default)}{unit}"
    usual = "; usually {:g} to {:g} {}".format(*key.usual) if key.usual else ""
    return indented(f"{name}{default}: {key.meaning}; {key.allowed}{usual}")
