"""Checksums of files: of a netCDF file, in a line at its end, where HDF5 does not look.

HDF5 trusts what it opens: damaged bytes make it loop for ever, or pass as other values. A file is
therefore compared with its checksum before HDF5 sees it. Other programs read it as it is; one that
writes to it leaves a file whose checksum is wrong or gone.
"""

from __future__ import annotations

import hashlib
import os
import sys
from os import PathLike
from typing import BinaryIO

from stickslip.errors import ScenarioError

_MARK = b"\nstickslip sha256 "
_LENGTH = len(_MARK) + 2 * hashlib.sha256().digest_size + 1
_PIECE = 1 << 20  # bytes read at a time; chosen: files of any size need little memory


def sha256_of(file: BinaryIO, most: int = sys.maxsize) -> str:
    """The SHA-256 of an open file from where it stands, or of so many bytes; hexadecimal."""
    digest = hashlib.sha256()
    while piece := file.read(min(_PIECE, most)):
        digest.update(piece)
        most -= len(piece)
    return digest.hexdigest()


def append_checksum(file: BinaryIO) -> None:
    """Add the line to a file that is open to be read and written, on a disk or in memory."""
    file.seek(0)
    file.write(_line(sha256_of(file)))


def check_checksum(path: str | PathLike[str]) -> bool:
    """Whether the file has the line; a ScenarioError, without its name, if it is not its own."""
    with open(path, "rb") as file:
        left = max(os.fstat(file.fileno()).st_size - _LENGTH, 0)
        file.seek(left)
        line = file.read(_LENGTH)
        if not line.startswith(_MARK):
            return False
        file.seek(0)
        digest = sha256_of(file, left)
    if line != _line(digest):
        raise ScenarioError(
            "its checksum does not match: it is damaged, or a program has changed it"
        )
    return True


def _line(digest: str) -> bytes:
    return _MARK + digest.encode("ascii") + b"\n"
