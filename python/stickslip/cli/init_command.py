"""``stickslip init``."""

from __future__ import annotations

import textwrap
from pathlib import Path

import click

from stickslip._util.text import json_text
from stickslip.cli.keys_command import FILES
from stickslip.cli.options import PATH
from stickslip.cli.output import write_new
from stickslip.scenario.keys import COIL_NAMES, Key, is_of_one_coil, known_keys
from stickslip.scenario.toml_file import FORMAT_VERSION

_HEAD = f"""\
# A robot that walks: all keys at their defaults, but drive.base. SI units and radians; what is left
# out has its default.
stickslip = {FORMAT_VERSION}  # version of the format, required
"""

_WALKS = {"drive.base": 0.5e-3}
"""Keys that are not at their defaults, so that a new user's first run walks. From README.md."""

_DRIVE = """\
# base, hold, edge and clamp are not stated in the paper: their defaults are this package's. That of
# base is 0, with which the holding coil alone turns the robot upright and it rolls over."""

_ONE_COIL = f"""\
# A coil that differs ({", ".join(COIL_NAMES)}) has a table of its own:
# [coil.clamp]
# resistance = 10.5  # ohm"""

_TAIL = """\
# Effects; "stickslip effects" lists them.
# [effects.surface_tilt]
# angle = 0.02  # rad
"""

_WIDTH = 100  # as the help of the commands


@click.command(
    "init",
    help="""Write a scenario that walks, with all keys and what they mean, to FILE.

    FILE is scenario.toml; one that is there is not overwritten.
    """,
    epilog="\b\nExample:\n  stickslip init scenario.toml",
)
@click.argument("file", type=PATH, required=False)
def command(file: Path | None) -> None:
    write_new("FILE", file or Path("scenario.toml"), _commented_scenario())


def _commented_scenario() -> str:
    """The text of a scenario file with every key."""
    keys = [
        key
        for key in known_keys().values()
        if not key.name.startswith("effects.") and not is_of_one_coil(key.name)
    ]
    blocks = [_HEAD]
    for section in dict.fromkeys(key.section for key in keys):
        lines = [f"[{section}]", *([_DRIVE] if section == "drive" else [])]
        if section in FILES:
            lines += _comment(f"# {FILES[section]}")
        for key in keys:
            if key.section == section:
                lines += _setting(key)
        if section == "coil":
            lines.append(_ONE_COIL)
        blocks.append("\n".join(lines) + "\n")
    return "\n".join([*blocks, _TAIL])


def _setting(key: Key) -> list[str]:
    """The setting with its meaning beside it, or above it where that is too long."""
    setting = f"{key.name.rpartition('.')[2]} = {json_text(_WALKS.get(key.name, key.default))}"
    comment = f"# {key.meaning}; {key.allowed}"
    line = f"{setting}  {comment}"
    return [line] if len(line) <= _WIDTH else [*_comment(comment), setting]


def _comment(text: str) -> list[str]:
    return textwrap.wrap(text, _WIDTH, subsequent_indent="# ")
