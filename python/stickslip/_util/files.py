"""Files that are written completely or not at all, and read up to a limit of their size."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from collections.abc import Callable, Iterable, Iterator, Mapping
from os import PathLike
from pathlib import Path

from stickslip.errors import ScenarioError

NETCDF_SUFFIXES = (".nc", ".nc4", ".h5")

_WRITABLE = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH


class NotWritten(OSError):
    """A file that could not be written; the message names it."""


def read_bytes(path: str | PathLike[str], most: int, kind: str) -> bytes:
    """The bytes of a file or a pipe; `kind` is a word of the errors.

    A ScenarioError of one line, which does not name the file, says that it cannot be read, is a
    device, or is longer than `most` bytes.
    """
    try:
        check_name(path)
        mode = os.stat(path).st_mode
        # Some devices never end, and opening others does something.
        if not (stat.S_ISREG(mode) or stat.S_ISFIFO(mode) or stat.S_ISDIR(mode)):
            raise ScenarioError("cannot be read: it is a device; allowed is a file or a pipe")
        with open(path, "rb") as file:
            data = file.read(most + 1)
    except OSError as error:
        raise ScenarioError(f"cannot be read: {error.strerror or error}") from None
    if len(data) > most:
        raise ScenarioError(f"is longer than {most} bytes, so it is no {kind}")
    return data


def check_name(path: str | PathLike[str]) -> None:
    """Raise an OSError for a name that no file can have, or that no text can hold."""
    name = os.fspath(path)
    if "\0" in name:
        raise OSError("the name has a character NUL")
    try:
        name.encode("utf-8")
    except UnicodeEncodeError:
        # Reports, scenarios and JSON name the files that they are of, and are UTF-8.
        raise OSError("the name is not UTF-8") from None


def check_suffix(path: str | PathLike[str], allowed: tuple[str, ...]) -> None:
    """Raise a ValueError, with the suffixes that are allowed, for a name that has none of them."""
    if Path(path).suffix.lower() not in allowed:
        raise ValueError(f"{path}: allowed are names that end in {', '.join(allowed)}")


def check_writable(path: str | PathLike[str]) -> None:
    """Raise an OSError for a path to which `replacing` could not write.

    It is a folder, a device or read-only, or its folder is missing or cannot be written to.
    """
    target = _resolved(path)
    folder = target.parent
    if target.is_dir():
        raise IsADirectoryError(f"cannot write {path}: it is a folder")
    if target.exists():
        if not target.is_file():
            raise OSError(f"cannot write {path}: it is not an ordinary file")
        # The folder decides who can replace it, and root always can: its mode says what is meant.
        if not target.stat().st_mode & _WRITABLE or not os.access(target, os.W_OK):
            raise PermissionError(f"cannot write {path}: it is read-only")
    if not folder.is_dir():
        raise FileNotFoundError(f"cannot write {path}: there is no folder {Path(path).parent}")
    _try_to_write(path, folder)


def _try_to_write(path: str | PathLike[str], folder: Path) -> None:
    """Make an empty file and remove it: rights alone do not tell what a file system takes."""
    trial = folder / f".{secrets.token_hex(8)}.tmp"
    try:
        trial.touch(exist_ok=False)
    except PermissionError:
        raise PermissionError(f"cannot write {path}: no permission to write in {folder}") from None
    except OSError as error:
        raise type(error)(f"cannot write {path}: {error.strerror}") from None
    finally:
        with contextlib.suppress(OSError):
            trial.unlink()


def _resolved(path: str | PathLike[str]) -> Path:
    """Where links lead."""
    try:
        check_name(path)
    except OSError as error:
        raise OSError(f"cannot write {path}: {error}") from None
    target = Path(os.path.realpath(path))
    try:
        mode = os.lstat(target).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return target
    except OSError as error:  # a name that is too long, say
        raise OSError(f"cannot write {path}: {error.strerror}") from None
    if stat.S_ISLNK(mode):
        raise OSError(f"cannot write {path}: its links lead in a circle")
    return target


def check_folder(path: str | PathLike[str], files: Iterable[str] = ()) -> None:
    """Raise an OSError for a folder that could not be made, or where `files` could not be written.

    It need not be there yet; the error names what is in the way.
    """
    target = _resolved(path)
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(f"cannot write {path}: it is not a folder")
    made: list[Path] = []
    try:
        for folder in reversed([target, *target.parents]):
            if not folder.exists():
                folder.mkdir()
                made.append(folder)
    except OSError as error:
        raise type(error)(f"cannot write {path}: {error.strerror}") from None
    finally:
        for folder in reversed(made):
            folder.rmdir()
    if target.exists():
        _try_to_write(path, target)
        for name in files:
            check_writable(Path(path) / name)


@contextlib.contextmanager
def replacing(path: str | PathLike[str]) -> Iterator[Path]:
    """A temporary path in the same folder that becomes `path` when the block ends without error.

    An OSError says that the file cannot be written; then `path` is as it was before.
    """
    check_writable(path)
    target = _resolved(path)
    # A suffix is kept: matplotlib takes the format from it.
    temporary = target.with_name(f".{secrets.token_hex(8)}.tmp{target.suffix}")
    try:
        yield temporary
        os.replace(temporary, target)
    except NotWritten:  # of another file, which it names
        raise
    except OSError as error:
        raise NotWritten(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)


def write_together(writers: Mapping[Path, Callable[[Path], object]]) -> None:
    """Write files that belong together: all are complete before the first takes its name.

    `writers` has for each path a function that writes what belongs there to the path that it gets.
    An OSError says that one cannot be written; then all are as they were before.
    """
    for path in writers:  # before another file's error could name this one
        check_writable(path)
    with contextlib.ExitStack() as stack:
        for path, write in writers.items():
            write(stack.enter_context(replacing(path)))


def text_writer(text: str) -> Callable[[Path], object]:
    """A function for `write_together` that writes a text."""
    return lambda path: path.write_text(text, encoding="utf-8")
