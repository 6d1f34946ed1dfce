"""Files that are written completely or not at all, and read up to a limit of their size."""

from __future__ import annotations

import contextlib
import csv
import hashlib
import itertools
import os
import re
import secrets
import stat
from collections.abc import Callable, Iterable, Iterator, Mapping
from os import PathLike
from pathlib import Path

from stickslip.errors import NotWritten, ScenarioError

NETCDF_SUFFIXES = (".nc", ".nc4", ".h5")

_LONGEST_NAME = 255  # bytes, of most file systems
_LONGEST_STEM = 50  # characters of up to four bytes, with room for an ending


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
    """Raise an OSError for a name that no file can have or that is not UTF-8."""
    name = os.fspath(path)
    if "\0" in name:
        raise OSError("the name has a character NUL")
    try:
        os.fsencode(name).decode("utf-8")
    except UnicodeError:
        # Reports, scenarios and JSON name the files that they are of, and are UTF-8.
        raise OSError("the name is not UTF-8, or not of the locale's characters") from None


def beside(path: Path, before: str, after: str) -> Path:
    """A file that belongs to another, with more before and after its name.

    Where that is longer than a name can be, a digest is in place of the name.
    """
    name = os.fsencode(path.name)
    if len(name) + len(before) + len(after) > _LONGEST_NAME:
        return path.with_name(f"{before}{hashlib.sha256(name).hexdigest()}{after}")
    return path.with_name(f"{before}{path.name}{after}")


def file_names(names: Iterable[str]) -> list[str]:
    """Names of files for texts of a user, in the same order, each of its own."""
    made: dict[str, str] = {}  # by what a system that ignores case sees
    for name in names:
        plain = stem = re.sub(r"[^\w.-]+", "-", name)[:_LONGEST_STEM]
        while plain.casefold() in made:
            plain = f"{stem}-{len(made)}"
        made[plain.casefold()] = plain
    return list(made.values())


def check_suffix(path: str | PathLike[str], allowed: tuple[str, ...]) -> None:
    """Raise a ValueError, with the suffixes that are allowed, for a name that has none of them."""
    if Path(path).suffix.lower() not in allowed:
        raise ValueError(f"{path}: allowed are names that end in {', '.join(allowed)}")


@contextlib.contextmanager
def replacing(path: str | PathLike[str]) -> Iterator[Path]:
    """A new file in the same folder that becomes `path` when the block ends without error.

    An OSError names `path` and the obstacle; `path` is then unchanged.
    """
    temporary = None
    try:
        check_name(path)
        target = Path(os.path.realpath(path))
        if target.is_dir():
            raise OSError("it is a folder")
        if target.exists() and not target.is_file():
            raise OSError("it is not an ordinary file")
        if not target.parent.is_dir():
            raise FileNotFoundError(f"there is no folder {Path(path).parent}")
        # matplotlib takes the format from the suffix.
        suffix = target.suffix if target.suffix.isascii() and len(target.suffix) < 9 else ""
        temporary = target.with_name(f".{secrets.token_hex(8)}.part{suffix}")
        temporary.touch(exist_ok=False)
        yield temporary
        os.replace(temporary, target)
    except NotWritten as error:  # of another file, or of the temporary one
        raise NotWritten(str(error).replace(str(temporary), str(path))) from None
    except OSError as error:
        raise NotWritten(f"cannot write {path}: {error.strerror or error}") from None
    finally:
        if temporary is not None:
            with contextlib.suppress(OSError):
                temporary.unlink()


def check_writable(path: str | PathLike[str]) -> None:
    """Raise an OSError for a path to which `replacing` could not write."""
    with contextlib.suppress(EOFError), replacing(path):
        raise EOFError  # ends the trial without a file


def check_folder(path: str | PathLike[str], files: Iterable[str] = ()) -> None:
    """Raise an OSError for a folder that could not be made, or where `files` could not be written.

    It need not exist yet, but the folder around it; the error names the obstacle.
    """
    folder = Path(path)
    if folder.is_dir():
        for name in files or (secrets.token_hex(8),):
            check_writable(folder / name)
        return
    try:
        check_name(path)
        if folder.exists():
            raise NotADirectoryError("it is not a folder")
        if not folder.parent.is_dir():
            raise FileNotFoundError(f"there is no folder {folder.parent}")
        folder.mkdir()
        folder.rmdir()
    except OSError as error:
        raise NotWritten(f"cannot write {path}: {error.strerror or error}") from None


def write_together(writers: Mapping[Path, Callable[[Path], object]]) -> None:
    """Write files that belong together: all are complete before the first takes its name.

    `writers` has for each path a function that writes its content to the path that it gets.
    An OSError says that one cannot be written; then all are unchanged.
    """
    with contextlib.ExitStack() as stack:
        for path, write in writers.items():
            write(stack.enter_context(replacing(path)))


def write_rows(path: str | PathLike[str], *rows: Iterable[Iterable[object]]) -> None:
    """Write rows as CSV, whole or not at all."""
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(itertools.chain(*rows))


def text_writer(text: str) -> Callable[[Path], object]:
    """A function for `write_together` that writes a text."""
    # The names of files in it are the bytes of their names, also where the locale has only ASCII.
    return lambda path: path.write_text(text, encoding="utf-8", errors="surrogateescape")
