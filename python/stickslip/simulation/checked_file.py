"""HDF5 files with checksums, and how any HDF5 file is opened.

HDF5 believes most of what it reads: in a damaged file it can loop, or try again, for ever. So the
checksums of a file's pieces follow its end, where no other program looks, and every piece is
checked when HDF5 asks for it: what is read is what was written, and opening a large file reads
little. A file without checksums, which another program wrote or whose writer was killed, is first
opened in a process of its own, whose time is limited.
"""

from __future__ import annotations

import contextlib
import functools
import io
import math
import os
import struct
import subprocess
import sys
import zlib
from collections.abc import Iterator
from os import PathLike
from typing import Any, BinaryIO

from stickslip.errors import ScenarioError
from stickslip.extras import MissingExtra, naming_the_extra

PART = ".part"
"""The end of a file's name until the file is complete."""

# The first format that can be read while it is written, or where its writer was killed (SWMR), and
# whose first bytes have a checksum.
FORMAT = {"libver": "v110"}

_PIECE = 1 << 16  # bytes; chosen: the checksums are 6e-5 of a file, and a piece takes 20 us
_TAIL = struct.Struct("<QI8s")  # bytes of HDF5, CRC-32 of the checksums and that number, mark
_MARK = b"CRC-32s\n"

_SUPERBLOCK = struct.Struct("<8sBxxB16xQ")  # signature, version, flags, bytes of HDF5
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_VERSION = 2  # the first that such flags and a checksum belong to
_WRITING = 4  # the flag of a file that is open for SWMR, or was when its writer was killed

_DAMAGED = "is damaged: its checksums are those of another content"

_LIMITS = 3, 10.0
"""Processor time and time of a trial, s; chosen: ten times what a busy machine needs for it."""

_TRIAL = """
import sys
swmr, limit, path, *sys.path = sys.argv[1:]
try:
    import resource
    resource.setrlimit(resource.RLIMIT_CPU, (int(limit),) * 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
except ImportError:  # on Windows
    pass
import h5py
def visit(name, found):
    dict(found.attrs)
    if isinstance(found, h5py.Dataset):
        found.id.get_num_chunks() if found.chunks and found.dtype.kind != "O" else found[()]
with h5py.File(path, "r", swmr=bool(swmr)) as file:
    visit("", file)
    file.visititems(visit)
"""


def seal(file: BinaryIO) -> None:
    """Add the checksums to an HDF5 file that is open to be read and written."""
    file.seek(0)
    size, sums = 0, b""
    while piece := file.read(_PIECE):
        size, sums = size + len(piece), sums + zlib.crc32(piece).to_bytes(4, "little")
    file.write(sums + _TAIL.pack(size, _sum_of_all(sums, size), _MARK))


def _sum_of_all(sums: bytes, size: int) -> int:
    return zlib.crc32(size.to_bytes(8, "little"), zlib.crc32(sums))


class _Checked(io.RawIOBase):
    """The bytes of HDF5 of a file with checksums; an OSError for those that are not as written."""

    def __init__(self, file: BinaryIO, size: int, sums: bytes) -> None:
        self._file, self._size, self._sums, self._at = file, size, sums, 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        self._at = offset + (0, self._at, self._size)[whence]
        return self._at

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        number, within = divmod(self._at, _PIECE)
        self._file.seek(number * _PIECE)
        piece = self._file.read(min(_PIECE, max(0, self._size - number * _PIECE)))
        if piece and zlib.crc32(piece).to_bytes(4, "little") != self._sums[4 * number :][:4]:
            raise OSError(_DAMAGED)
        part = piece[within : within + len(buffer)]
        buffer[: len(part)] = part
        self._at += len(part)
        return len(part)


@contextlib.contextmanager
def checked(path: str | PathLike[str]) -> Iterator[tuple[BinaryIO | str, bool]]:
    """The file for HDF5 in place of a path, and whether to open it as one that grows.

    Whatever is wrong with the file, also if it is found while it is read within the block, becomes
    a ScenarioError of one line, which does not name the file.
    """
    try:
        with open(path, "rb") as file:  # whose errors say more than those of HDF5
            source, grows = _sealed(file), False
            if source is None:
                grows = _grows(file, path)
                _try_as_it_grows(file, os.path.abspath(path), grows)
            yield source or os.fspath(path), grows
    except (ScenarioError, MissingExtra):
        raise
    except Exception as error:  # whatever HDF5, its readers and a file raise
        if isinstance(error, OSError) and error.strerror is not None:
            raise ScenarioError(f"cannot be read: {error.strerror}") from None
        if not os.path.exists(path):
            raise ScenarioError(
                "no longer exists: its run has ended, or someone removed it"
            ) from None
        raise ScenarioError(
            "is no netCDF file, or a damaged one; allowed is one that stickslip wrote"
        ) from None


@contextlib.contextmanager
def opened(path: str | PathLike[str]) -> Iterator[Any]:
    """The file as HDF5 reads it; errors are those of `checked`."""
    with naming_the_extra("a netCDF file"):
        import h5py
    with checked(path) as (source, grows), h5py.File(source, "r", swmr=grows) as file:
        yield file


def own_rows(file: Any, name: str, across: tuple[int, ...] = (), more: int = 0) -> int:
    """Rows of a dataset for which an HDF5 file has room.

    A ScenarioError says that it is in another file, that its rows are not of the shape `across`, or
    that the file states over `more` rows besides.
    """
    import h5py

    is_own = isinstance(file.get(name, getlink=True), h5py.HardLink)
    data = file[name] if is_own else None
    if not isinstance(data, h5py.Dataset) or data.external or data.is_virtual:
        raise ScenarioError(f"is damaged: {name} is not in it, but a link")
    if data.shape[1:] != across:
        raise ScenarioError(f"is damaged: a row of {name} is of shape {data.shape[1:]}")
    if data.chunks:
        parts = math.prod(-(-n // part) for n, part in zip(across, data.chunks[1:], strict=True))
        held = data.id.get_num_chunks() // parts * data.chunks[0]
    else:
        held = data.id.get_storage_size() // (data.id.get_type().get_size() * math.prod(across))
    if len(data) > held + more:
        raise ScenarioError(f"is damaged: it states {len(data)} rows of {name}, and has {held}")
    return min(len(data), int(held))


def _sealed(file: BinaryIO) -> BinaryIO | None:
    """The HDF5 within a file with checksums; None for a file without."""
    length = file.seek(0, os.SEEK_END)
    file.seek(max(0, length - _TAIL.size))
    tail = file.read(_TAIL.size)  # and no more: a file that is written may have grown
    if len(tail) < _TAIL.size:
        return None
    size, total, mark = _TAIL.unpack(tail)
    many = 4 * -(-size // _PIECE)
    if mark != _MARK or length != size + many + len(tail):
        return None
    file.seek(size)
    sums = file.read(many)
    if _sum_of_all(sums, size) != total:
        raise ScenarioError(_DAMAGED)
    return io.BufferedReader(_Checked(file, size, sums), _PIECE)


def _grows(file: BinaryIO, path: str | PathLike[str]) -> bool:
    """Whether a file without checksums is being written, or its writer was killed."""
    length = file.seek(0, os.SEEK_END)
    file.seek(0)
    head = file.read(_SUPERBLOCK.size)
    if os.fspath(path).endswith(PART) or len(head) < _SUPERBLOCK.size:
        return len(head) == _SUPERBLOCK.size
    signature, version, flags, size = _SUPERBLOCK.unpack(head)
    if signature != _SIGNATURE or version < _VERSION:
        return False
    if size < length and not flags & _WRITING:  # what follows were the checksums
        raise ScenarioError(_DAMAGED)
    return bool(flags & _WRITING)


def _try_as_it_grows(file: BinaryIO, path: str, grows: bool) -> None:
    """Open a file in another process, again where it has grown meanwhile: a block was half done."""
    for last in (False, False, True):
        state = os.fstat(file.fileno())
        try:
            return _try(path, grows, (state.st_ino, state.st_size, state.st_mtime_ns))
        except OSError:
            if last or os.fstat(file.fileno()).st_mtime_ns == state.st_mtime_ns:
                raise


@functools.lru_cache(maxsize=8)
def _try(path: str, grows: bool, state: tuple[int, ...]) -> None:
    """Open a file in another process; an OSError for one that cannot be opened in time."""
    if getattr(sys, "frozen", False) or not sys.executable:
        return  # there is no Python to start
    command = [sys.executable, "-I", "-c", _TRIAL, grows * "swmr", str(_LIMITS[0]), path, *sys.path]
    try:
        done = subprocess.run(command, capture_output=True, timeout=_LIMITS[1], check=False)
    except subprocess.TimeoutExpired:
        raise OSError("no end") from None
    if done.returncode:
        raise OSError(done.stderr)
