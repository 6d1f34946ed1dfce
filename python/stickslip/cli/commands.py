"""The group of commands. A command's module is imported when it is called."""

from __future__ import annotations

import importlib

import click

_COMMANDS = (
    *("diagnose", "effects", "init", "keys", "optimise", "predict", "reproduce", "run"),
    "sweep",
)


class LazyGroup(click.Group):
    """Imports the module of a command when it is called, and not those of the others."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _COMMANDS:
            return None
        module = importlib.import_module(f"stickslip.cli.{cmd_name}_command")
        command: click.Command = module.command
        return command


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="\b\nExample:\n"
    "  stickslip init scenario.toml\n"
    "  stickslip run scenario.toml --set drive.frequency=30 --plot run.png",
)
@click.version_option(
    package_name="stickslip", prog_name="stickslip", message="%(prog)s %(version)s"
)
def stickslip() -> None:
    """Simulate magnetic micro-robots that walk by stick-slip in the field of five coils."""
