"""The group of commands. A command's module is imported when it is called."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

import click

from stickslip._util.extras import check_extras, naming_the_extra

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

COMMANDS = {
    "diagnose": "Find what in measured data the model does not explain.",
    "effects": "List or search the named extensions of the model.",
    "init": "Write a scenario with all keys and their defaults.",
    "keys": "List or search the keys of a scenario.",
    "optimise": "Find the drive of a scenario that is best under limits.",
    "predict": "Predict the summary of a scenario with error bars.",
    "reproduce": "Redo the paper's simulations and test its statements.",
    "run": "Simulate one scenario and print its summary.",
    "sweep": "Simulate a scenario at all combinations of some values.",
}
"""What each command does, in a line of a terminal of 80 columns. It stands here and not beside the
command, whose import would cost up to a second for the list of all."""
_HELP = ["-h", "--help"]


class LazyGroup(click.Group):
    """Imports the module of a command when it is called, and not those of the others."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module = importlib.import_module(f"stickslip.cli.{cmd_name}_command")
        command: click.Command = module.command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name = args[0]
        if name not in COMMANDS and not ctx.resilient_parsing:
            from stickslip.scenario.keys import suggestion

            hint = suggestion(name, COMMANDS)
            raise click.UsageError(f"{name}: there is no such command; {hint}", ctx)
        if not ctx.resilient_parsing and not {*args} & {*_HELP}:
            check_extras(f"stickslip {name}", name)
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except ModuleNotFoundError:
            with naming_the_extra(f"stickslip {ctx.invoked_subcommand}"):
                raise

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        from click.shell_completion import CompletionItem

        found = [
            CompletionItem(name, help=text)
            for name, text in COMMANDS.items()
            if name.startswith(incomplete)
        ]
        return found + click.Command.shell_complete(self, ctx, incomplete)


def unknown_option(error: click.NoSuchOption) -> str:
    """The line that refuses an option which a command does not have."""
    from stickslip.scenario.keys import suggestion

    context = error.ctx or click.Context(stickslip)
    options = [
        name
        for each in context.command.get_params(context)
        if isinstance(each, click.Option)
        for name in each.opts
    ]
    hint = suggestion(error.option_name, options)
    return f"{error.option_name}: there is no such option of {context.command_path}; {hint}"


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": _HELP, "max_content_width": 100},
    epilog="\b\nExample:\n"
    "  stickslip init scenario.toml\n"
    "  stickslip run scenario.toml --set drive.frequency=30 --plot run.png",
)
@click.version_option(
    package_name="stickslip", prog_name="stickslip", message="%(prog)s %(version)s"
)
def stickslip() -> None:
    """Simulate magnetic micro-robots that walk by stick-slip in the field of five coils."""
