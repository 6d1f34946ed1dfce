"""One sweep at a time for a file."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from os import PathLike
from pathlib import Path

from stickslip.errors import ScenarioError

try:
    import fcntl
except ImportError:  # on Windows and in some browsers
    HAS_LOCKS = False
else:
    HAS_LOCKS = True


@contextlib.contextmanager
def file_lock(path: str | PathLike[str] | None) -> Iterator[None]:
    """Keep every other sweep from writing the file `path`, if there is one.

    The lock is the kernel's, on a file ``.NAME.lock`` beside it, and ends with the process, also
    with one that is killed: the file that it leaves locks nothing. On a file system or a system
    without such locks there is none. A ScenarioError says that another sweep writes the file.
    """
    target = Path(os.path.realpath(path or ""))
    # Where nothing can be written, no other sweep writes, and a file that is complete can be read.
    if path is None or not HAS_LOCKS or not os.access(target.parent, os.W_OK):
        yield
        return
    lock = target.with_name(f".{target.name}.lock")
    descriptor = _acquire(lock, path)
    try:
        yield
    finally:
        lock.unlink(missing_ok=True)
        os.close(descriptor)


def _acquire(lock: Path, path: str | PathLike[str]) -> int:
    while True:
        try:
            descriptor = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise ScenarioError(f"cannot write {path}: its lock: {error.strerror}") from None
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            raise ScenarioError(f"{path}: another sweep is writing this file") from None
        except OSError:
            return descriptor
        # Between the two calls its owner may have removed it, and another made a new one.
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(os.stat(lock), os.fstat(descriptor)):
                return descriptor
        os.close(descriptor)
