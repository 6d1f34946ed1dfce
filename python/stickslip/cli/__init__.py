"""The command ``stickslip``. Only what `main` needs to answer an interrupt is imported here."""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False  # as in the package

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import NoReturn

# Exit statuses; the last two are those that shells give a program which a signal ends: 128 and its
# number.
BAD_INPUT = 2
FAILED = 1
INTERRUPTED = 130
BROKEN_PIPE = 141

COMPLETION = "_STICKSLIP_COMPLETE"
"""The variable by which a shell asks for what could come next; click gives it its name."""


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command and exit: 0; 1 if a simulation failed; 2 for bad input; 130 on Ctrl-C.

    SIGTERM, which clusters and ``timeout`` send, acts as Ctrl-C does.
    """
    try:
        _take_termination()
        code = _run(arguments)
        if sys.stdout is not None:
            sys.stdout.flush()
    except KeyboardInterrupt:
        _leave(INTERRUPTED)
    except BrokenPipeError:
        _leave(BROKEN_PIPE)
    except OSError as error:
        # The own errors name the file in their text; the system's carry a number beside it.
        where = error.filename or "standard output"
        text = f"cannot write {where}: {error.strerror}" if error.errno else error
        print(f"stickslip: {_one_line(text)}", file=sys.stderr)
        _leave(FAILED)
    except MemoryError:
        print("stickslip: out of memory; set a lower record.rate", file=sys.stderr)
        _leave(FAILED)
    sys.exit(code)


def _take_termination() -> None:
    import signal
    import threading

    def interrupt(number: int, frame: object) -> None:
        # `timeout` sends it twice, and the second would undo what the first has left to do.
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        raise KeyboardInterrupt

    # Signals go to the main thread; who ignores them on purpose goes on doing so.
    if threading.current_thread() is threading.main_thread() and (
        signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
    ):
        signal.signal(signal.SIGTERM, interrupt)


def _run(arguments: Sequence[str] | None) -> int:
    import click

    from stickslip._util.extras import MissingExtra
    from stickslip.cli.commands import stickslip, unknown_option
    from stickslip.errors import ScenarioError

    if COMPLETION in os.environ:
        from stickslip.cli.completion import answer

        return answer(stickslip, os.environ[COMPLETION])
    try:
        return int(stickslip.main(arguments, prog_name="stickslip", standalone_mode=False) or 0)
    except click.exceptions.NoArgsIsHelpError as error:
        print(error.format_message(), file=sys.stderr)
        return BAD_INPUT
    except click.NoSuchOption as error:
        print(f"stickslip: {_one_line(unknown_option(error))}", file=sys.stderr)
        return BAD_INPUT
    except (click.ClickException, ScenarioError, MissingExtra) as error:
        message = error.format_message() if isinstance(error, click.ClickException) else error
        print(f"stickslip: {_one_line(message)}", file=sys.stderr)
        return BAD_INPUT
    except click.Abort:
        raise KeyboardInterrupt from None
    except SystemExit:
        # Not in standalone mode, click exits by itself for this alone.
        raise BrokenPipeError from None


def _one_line(message: object) -> str:
    from stickslip._util.text import printable

    return printable(" ".join(str(message).split()))


def _leave(code: int) -> NoReturn:
    """Exit without the flush of standard output, which would fail or wait again."""
    try:
        sys.stderr.flush()
    finally:
        os._exit(code)
