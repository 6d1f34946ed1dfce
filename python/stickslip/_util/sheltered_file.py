"""A file that HDF5 writes to through Python, so that no failing write reaches HDF5.

Where the disk is full, HDF5 can take the process down as it closes a file that it could not write.
"""

from __future__ import annotations

import errno
import io
import os
from typing import Any


class ShelteredFile(io.RawIOBase):
    """An unbuffered file that is open to be read and written.

    `reserve` makes sure of room on the disk before HDF5 wants it. A write that fails all the same,
    or is interrupted, passes as done; `finish` then raises what happened.
    """

    def __init__(self, file: io.FileIO) -> None:
        super().__init__()
        self._file = file
        self._end = 0
        self._failure: BaseException | None = None

    def reserve(self, more: int) -> None:
        """Take room for some bytes behind the end; an OSError if there is none.

        Where a system cannot, `finish` tells of a full disk.
        """
        if not hasattr(os, "posix_fallocate"):  # macOS, Windows
            return
        try:
            os.posix_fallocate(self._file.fileno(), 0, self._end + more)
        except OSError as error:
            if error.errno not in (errno.EINVAL, errno.EOPNOTSUPP):  # of the file system
                raise

    def finish(self) -> io.FileIO:
        """The file as it was written, without its reserve; raises what a write met."""
        if self._failure is not None:
            raise self._failure
        self._file.truncate(self._end)
        return self._file

    def write(self, data: Any) -> int:
        rest = memoryview(data).cast("B")
        count = len(rest)
        self._end = max(self._end, self._file.tell() + count)
        try:
            while self._failure is None and rest:
                rest = rest[self._file.write(rest) :]
        except BaseException as error:
            self._failure = error
        return count

    def readinto(self, buffer: Any) -> int:
        return self._file.readinto(buffer)

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        if whence == io.SEEK_END:  # of what was written, not of what is reserved
            offset, whence = offset + self._end, io.SEEK_SET
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        return self._file.tell()

    def truncate(self, size: int | None = None) -> int:
        # Not of the file: its reserve would be gone.
        self._end = self.tell() if size is None else size
        return self._end

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True
