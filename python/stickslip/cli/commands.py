"""The group of commands. A command's module is imported when it is called."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Any

import click

from stickslip._util.text import printable
from stickslip.cli import BAD_INPUT, INTERRUPTED
from stickslip.errors import ScenarioError
from stickslip.extras import MissingExtra, check_extras, naming_the_extra

COMMANDS = {
    "coils": "Tell what the coils and amplifiers of a scenario can do.",
    "diagnose": "Find what in measured data the model does not explain.",
    "effects": "List or search the effects of the model.",
    "init": "Write a scenario with all keys, or a model of a log.",
    "keys": "List or search the keys of a scenario.",
    "optimise": "Find the drive of a scenario that is best under limits.",
    "predict": "Predict the summary of a scenario with error bars.",
    "read": "Tell how the columns of a log are understood, and what is missing.",
    "run": "Simulate one scenario and print its summary.",
    "sweep": "Simulate a scenario at all combinations of some values.",
}
"""A line on each command for a terminal of 80 columns. It stands here and not beside the
command, whose import would cost up to a second for the list of all."""

_HELP = ("-h", "--help")


def loaded(name: str) -> click.Command:
    """The command of that name."""
    command: click.Command = importlib.import_module(f"stickslip.cli.{name}_command").command
    return command


class LazyCommand(click.Command):
    """A command that is known by its name and its line until it is called."""

    def make_context(
        self, info_name: str | None, args: list[str], parent: Any = None, **extra: Any
    ) -> click.Context:
        name = str(self.name)
        if not extra.get("resilient_parsing") and not {*_HELP} & {*args}:
            check_extras(f"stickslip {name}", name)
            if name in ("diagnose", "read"):
                args = importlib.import_module("stickslip.cli.log_models").expand_recipes(args)
            _check_once(loaded(name), args)
        return loaded(name).make_context(info_name, args, parent, **extra)


def _check_once(command: click.Command, args: Sequence[str]) -> None:
    """Refuse an option that is there twice and has one value, of which the last would count."""
    context = click.Context(command)
    _, _, order = command.make_parser(context).parse_args([*args])
    for number, one in enumerate(order):
        single = isinstance(one, click.Option) and not (one.multiple or one.is_flag)
        if single and one in order[:number]:
            raise click.BadParameter("is there twice: allowed is one", context, one)


@click.group(
    help="Simulate magnetic micro-robots that walk by stick-slip in the field of five coils.",
    commands=[LazyCommand(name, help=line) for name, line in COMMANDS.items()],
    context_settings={
        "help_option_names": [*_HELP],
        "max_content_width": 100,
        "show_default": True,
    },
    epilog="\b\nExample:\n"
    "  stickslip init scenario.toml\n"
    "  stickslip run scenario.toml --set drive.frequency=30 --plot run.png",
)
@click.version_option(
    package_name="stickslip", prog_name="stickslip", message="%(prog)s %(version)s"
)
def stickslip() -> None:
    pass


def run(arguments: Sequence[str] | None) -> tuple[int, str]:
    """Run the command; its exit status and the line for standard error, "" for none."""
    try:
        with naming_the_extra("this command"):
            done = stickslip.main(arguments, prog_name="stickslip", standalone_mode=False)
        return int(done or 0), ""
    except click.exceptions.NoArgsIsHelpError as error:
        error.show()
        return BAD_INPUT, ""
    except (click.ClickException, ScenarioError, MissingExtra) as error:
        text = error.format_message() if isinstance(error, click.ClickException) else str(error)
        return BAD_INPUT, printable(" ".join(text.split()))
    except click.Abort as error:  # Ctrl-C, with a text that says what was kept
        kept = error.__cause__.args if error.__cause__ else ()
        return INTERRUPTED, printable(", ".join(["interrupted", *map(str, kept)]))
