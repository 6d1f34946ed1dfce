"""The command: in this process, which costs no start, and as a process where that is tested."""

import contextlib
import io
import math
import os
import re
import resource
import signal
import subprocess
import sys
import warnings
from unittest import mock

from stickslip.__main__ import main

COMMAND = [sys.executable, "-m", "stickslip"]


class _Left(BaseException):
    """Exit status with which the command meant to end its process."""


def _leave(code):
    raise _Left(code)


def _show(message, category, filename, lineno, file=None, line=None):
    sys.stderr.write(warnings.formatwarning(message, category, filename, lineno, line))


def stickslip(*arguments, cwd=None):
    """Run the command in this process; the exit status and output that its own would have.

    Warnings are printed to standard error, as a process does, and not turned into errors. There is
    no progress bar, which comes after two seconds and so on a busy machine only.
    """
    before = os.getcwd()
    output = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    errors = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", errors="backslashreplace")
    code = 0
    with (
        mock.patch.multiple(sys, stdout=output, stderr=errors),
        mock.patch.object(os, "_exit", _leave),
        mock.patch("stickslip.cli.output.PATIENCE", math.inf),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("default")
        for kind in (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning):
            warnings.simplefilter("ignore", kind)
        warnings.showwarning = _show
        try:
            os.chdir(cwd or before)
            main([*map(str, arguments)])
        except SystemExit as end:
            code = end.code
        except _Left as end:
            (code,) = end.args
        finally:
            os.chdir(before)
            output.flush()
            errors.flush()
    texts = [each.buffer.getvalue().decode() for each in (output, errors)]
    return subprocess.CompletedProcess([*map(str, arguments)], code, *texts)


@contextlib.contextmanager
def files_up_to(largest):
    """No file of this process can become larger, bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (largest, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def python_process(*arguments, path=(), variables=(), timeout=120, **options):
    """The finished process of Python, with standard output and standard error as text.

    It finds modules as this process does, those of the folders `path` first, and has these
    variables of the environment.
    """
    others = {key: each for key, each in os.environ.items() if not key.startswith("STICKSLIP_")}
    own = {**others, "PYTHONPATH": os.pathsep.join([*map(str, path), *sys.path]), **dict(variables)}
    command, how = [sys.executable, *map(str, arguments)], {"capture_output": True, "text": True}
    return subprocess.run(command, env=own, timeout=timeout, **how, **options)


def stickslip_process(*arguments, largest_file=None, **options):
    """The finished process of the command.

    Files cannot become larger than `largest_file`, bytes, if that is given.
    """
    if largest_file is not None:
        limits = (largest_file, largest_file)
        options["preexec_fn"] = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    return python_process("-m", "stickslip", *arguments, timeout=300, **options)


def ended_at_the_bar(*arguments, shows=b"%", signals=(signal.SIGINT,), cwd=None):
    """The finished process that got signals once its bar showed some bytes, and what it had shown.

    Standard output and standard error, after those bytes, are bytes too.
    """
    command = [*COMMAND, *map(str, arguments)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, cwd=cwd) as process:
        try:
            seen = b""
            while not re.search(shows, seen):
                more = os.read(process.stderr.fileno(), 256)
                assert more, "the command ended before its bar appeared"
                seen += more
            for each in signals:
                process.send_signal(each)
            texts = process.communicate(timeout=60)
        finally:
            process.kill()
    return subprocess.CompletedProcess(command, process.returncode, *texts), seen


def check(done, *words):
    """Bad input is refused in one line, which has some words."""
    assert done.returncode == 2, done
    assert done.stdout == ""
    assert done.stderr.startswith("stickslip: ")
    assert done.stderr.endswith("\n")
    assert done.stderr.count("\n") == 1, done.stderr
    assert "Traceback" not in done.stderr
    for word in words:
        assert word in done.stderr, done.stderr
