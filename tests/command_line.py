"""The real command, in a process of its own."""

import subprocess
import sys

COMMAND = [sys.executable, "-m", "stickslip"]


def stickslip(*arguments, **options):
    """The finished process, with standard output and standard error as text."""
    return subprocess.run(
        [*COMMAND, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options
    )
