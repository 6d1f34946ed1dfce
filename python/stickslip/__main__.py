"""The command ``stickslip``, also ``python -m stickslip``.

`main` imports the rest, so that it can answer an interrupt.
"""

from __future__ import annotations

import os
import signal
import sys

from stickslip.cli import FAILED, INTERRUPTED

TYPE_CHECKING = False  # as in the package

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import NoReturn


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command and exit: 0; 1 if it failed; 2 for bad input; 130 if interrupted.

    SIGTERM, which clusters and ``timeout`` send, acts as Ctrl-C.
    """
    try:
        if signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
            signal.signal(signal.SIGTERM, _interrupt)
        from stickslip.cli.commands import run

        status, message = run(arguments)
        sys.stdout.flush()
    except KeyboardInterrupt:
        status, message = INTERRUPTED, "interrupted"
    except BrokenPipeError:  # who reads has seen enough
        status, message = FAILED, ""
    except OSError as error:
        where = error.filename or "standard output"
        text = f"cannot write {where}: {error.strerror}" if error.errno else str(error)
        status, message = FAILED, text
    if message:
        print(f"stickslip: {message}", file=sys.stderr)
    if status in (FAILED, INTERRUPTED):
        sys.stderr.flush()
        os._exit(status)  # a flush of standard output would fail again
    sys.exit(status)


def _interrupt(number: int, frame: object) -> None:
    signal.signal(number, signal.SIG_IGN)  # `timeout` sends it twice
    raise KeyboardInterrupt


if __name__ == "__main__":
    main()
