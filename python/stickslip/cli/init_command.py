"""``stickslip init``."""

from __future__ import annotations

import textwrap
from pathlib import Path

import click

from stickslip._util.files import replacing
from stickslip._util.text import json_text
from stickslip.cli.common import PATH, say
from stickslip.cli.targets import check_target
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Key, known_keys
from stickslip.scenario.path_keys import PROGRAM
from stickslip.scenario.section_table import SECTIONS
from stickslip.scenario.toml_file import FORMAT_VERSION

_HEAD = f"""\
# A robot that walks: all keys at their defaults, but drive.base. SI units and radians; what is left
# out has its default.
stickslip = {FORMAT_VERSION}  # version of the format, required
"""

_WALKS = {"drive.base": 0.5e-3}
"""What is not at its default, so that the first run of a new user walks. From README.md."""

_REMARKS = {
    "drive": """\
# base, hold, edge and clamp are not stated in the paper: their defaults are this package's. That of
# base is 0, with which the holding coil alone turns the robot upright and it rolls over.
# With mode = "program", the other keys but direction are left out, and
# file = "voltages.csv"  # columns t (s), xp, xm, yp, ym, clamp (V); relative to this file""",
    "coil": """\
# A measured field takes the place of side, distance and turns, which then keep their defaults:
# map = "map.csv"  # columns x, y, z (m), coil, Bx, By, Bz (T/A); relative to this file""",
}

_TAIL = """\
# Named extensions of the model; "stickslip effects" lists them.
# [effects.surface_tilt]
# angle = 0.02  # rad
"""

_WIDTH = 100  # as the help of the commands


@click.command("init", epilog="\b\nExample:\n  stickslip init scenario.toml")
@click.argument("file", type=PATH, default=Path("scenario.toml"))
def command(file: Path) -> None:
    """Write a scenario that walks, with all keys and what they mean, to FILE.

    FILE is scenario.toml where none is given; one that is there is not overwritten.
    """
    if file.is_file() or file.is_symlink():
        raise ScenarioError(f"{file} is already there: choose another name, or remove it")
    check_target("FILE", file, {})
    with replacing(file) as temporary:
        temporary.write_text(_commented_scenario(), encoding="utf-8")
    say(f"wrote {file}")


def _commented_scenario() -> str:
    """The text of a scenario file with every key."""
    blocks = [_HEAD]
    for section in SECTIONS:
        lines = [f"[{section}]"]
        if section in _REMARKS:
            lines.append(_REMARKS[section])
        for key in known_keys().values():
            if key.section == section and key.name != PROGRAM:
                lines += _lines(key)
        blocks.append("\n".join(lines) + "\n")
    return "\n".join([*blocks, _TAIL])


def _lines(key: Key) -> list[str]:
    """The setting with its meaning beside it, or above it where that is too long."""
    setting = f"{key.name.rpartition('.')[2]} = {json_text(_WALKS.get(key.name, key.default))}"
    comment = f"# {key.meaning}; {key.allowed}"
    line = f"{setting}  {comment}"
    if len(line) <= _WIDTH:
        return [line]
    return [*textwrap.wrap(comment, _WIDTH, subsequent_indent="# "), setting]
