"""The file of a sweep: written while the sweep runs, by one sweep at a time, read to resume it."""

from __future__ import annotations

import contextlib
import io
import os
import time
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip._util.files import beside, replacing
from stickslip.errors import ScenarioError, prefixed
from stickslip.simulation.checked_file import FORMAT, opened, own_rows, seal

if TYPE_CHECKING:
    import xarray

try:
    import fcntl
except ImportError:  # on Windows and in browsers
    HAS_LOCKS = False
else:
    HAS_LOCKS = True

MIN_INTERVAL = 1.0
"""Least time between two checkpoints, s, as `sweep` promises."""

_MAX_SHARE = 0.03
"""Share of the time that may go into writing them, as `sweep` promises."""


def write(data: xarray.Dataset, path: str | PathLike[str]) -> None:
    """Write a netCDF file, whole or not at all; an OSError says that it cannot be written."""
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    # To memory first: where a disk is full, HDF5 can take the process down with it.
    image = io.BytesIO()
    with h5netcdf.File(image, "w", **FORMAT) as file:
        data.dump_to_store(H5NetCDFStore(file))
    seal(image)
    with replacing(path) as temporary:
        temporary.write_bytes(image.getbuffer())


def take_over(path: str | PathLike[str], data: xarray.Dataset) -> None:
    """Read the file of the same sweep into its empty Dataset."""
    with prefixed(f"{path} cannot be resumed"), opened(path) as file:
        if file.attrs.get("sweep") != data.attrs["sweep"]:
            raise ScenarioError(
                "it belongs to another sweep, whose scenario, points or version of stickslip differ"
            )
        for name, column in data.data_vars.items():
            if name in file:
                if own_rows(file, str(name), column.shape[1:]) != len(column):
                    raise ScenarioError(f"is damaged: {name} is of another sweep")
                stored = file[name]
                column.values[...] = (stored.asstr() if stored.dtype == object else stored)[()]


def checkpoint(data: xarray.Dataset, path: str | PathLike[str]) -> float:
    """Write the file; return when to write it next, s of the monotonic clock."""
    start = time.monotonic()
    write(data, path)
    end = time.monotonic()
    return end + max(MIN_INTERVAL, (end - start) / _MAX_SHARE)


@contextlib.contextmanager
def locked(path: str | PathLike[str] | None) -> Iterator[None]:
    """Keep every other sweep from writing the file `path`, if there is one.

    The lock is the kernel's, on a file ``.NAME.lock`` beside it, and ends with the process, also
    with one that is killed: the file that it leaves locks nothing. On a file system or a system
    without such locks there is none. A ScenarioError says that another sweep writes the file.
    """
    target = Path(os.path.realpath(path or ""))
    # Where nothing can be written, no other sweep writes, and a complete file can be read.
    if path is None or not HAS_LOCKS or not os.access(target.parent, os.W_OK):
        yield
        return
    lock = beside(target, ".", ".lock")
    descriptor = _acquired(lock, path)
    try:
        yield
    finally:
        lock.unlink(missing_ok=True)
        os.close(descriptor)


def _acquired(lock: Path, path: str | PathLike[str]) -> int:
    while True:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            raise ScenarioError(f"{path}: another sweep is writing this file") from None
        except OSError:  # a file system without locks
            return descriptor
        # Between the two calls its owner may have removed it, and another made a new one.
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(os.stat(lock), os.fstat(descriptor)):
                return descriptor
        os.close(descriptor)
