"""Files that are written whole or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Iterator
from os import PathLike
from pathlib import Path

NETCDF_SUFFIXES = (".nc", ".nc4", ".h5")


def check_suffix(path: str | PathLike[str], allowed: tuple[str, ...]) -> None:
    """Refuse a name that does not end as its format does.

    Raises
    ------
    ValueError
        Naming the suffixes that are allowed.
    """
    if Path(path).suffix.lower() not in allowed:
        raise ValueError(f"{path}: allowed are names that end in {', '.join(allowed)}")


def check_writable(path: str | PathLike[str]) -> None:
    """Refuse a path to which `replacing` could not write.

    Raises
    ------
    OSError
        If the path is a folder or a device, or its folder is missing or cannot be written to.
    """
    target = Path(path)
    folder = target.parent
    if target.is_dir():
        raise IsADirectoryError(f"cannot write {target}: it is a folder")
    if target.exists() and not target.is_file():
        raise OSError(f"cannot write {target}: it is not an ordinary file")
    if not folder.is_dir():
        raise FileNotFoundError(f"cannot write {target}: there is no folder {folder}")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"cannot write {target}: no permission to write in {folder}")


def check_folder(path: str | PathLike[str]) -> None:
    """Refuse a folder that could not be made or written to; it need not be there yet.

    Raises
    ------
    OSError
        Naming what is in the way.
    """
    target = Path(path)
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(f"cannot write {target}: it is not a folder")
    made: list[Path] = []
    try:
        # Rights alone do not tell: some file systems take no new folder from anyone.
        for folder in reversed([target.absolute(), *target.absolute().parents]):
            if not folder.exists():
                folder.mkdir()
                made.append(folder)
    except OSError as error:
        raise type(error)(f"cannot write {target}: {error.strerror}") from None
    finally:
        for folder in reversed(made):
            folder.rmdir()
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(f"cannot write {target}: no permission to write in it")


@contextlib.contextmanager
def replacing(path: str | PathLike[str]) -> Iterator[Path]:
    """A temporary path in the same folder that becomes `path` when the block ends without error.

    Raises
    ------
    OSError
        If the file cannot be written; then `path` is as it was before.
    """
    check_writable(path)
    target = Path(path).resolve()
    # A suffix is kept: matplotlib takes the format from it.
    temporary = target.with_name(f".{secrets.token_hex(8)}.tmp{target.suffix}")
    try:
        yield temporary
        os.replace(temporary, target)
    except OSError as error:
        reason = error.strerror or str(error)
        raise OSError(f"cannot write {path}: {reason}") from error
    finally:
        temporary.unlink(missing_ok=True)
