"""The netCDF file of a run: written block by block, and read back.

HDF5 ends the process where it cannot write, so writing is tried before, without HDF5.
"""

from __future__ import annotations

import contextlib
import importlib.metadata
import io
import json
import math
import os
import shutil
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip import _core
from stickslip._util.files import beside, check_writable, replacing
from stickslip._util.messages import refuse
from stickslip.errors import NotWritten, ScenarioError, prefixed
from stickslip.extras import naming_the_extra
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import State
from stickslip.simulation.checked_file import FORMAT, PART, opened, own_rows, seal
from stickslip.simulation.quantities import ASKED, COLUMNS, WORDS, recorded_names

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    Block = Mapping[str, NDArray[Any]]

BLOCK = 65536
"""Samples of a block: as many as the core hands over at a time."""

# zlib's fastest level after a shuffle of the bytes. Measured on 262 144 samples of a walking robot:
# the slowest level takes half as long again for a file that is 2 % smaller. The checksum of each
# block is for a file whose writer was killed, before it had those of `seal`.
_STORED: dict[str, Any] = {
    "compression": "gzip",
    "compression_opts": 1,
    "shuffle": True,
    "fletcher32": True,
}

# Of what HDF5 writes beside the samples, bytes; chosen: a block adds less than a tenth of it.
_MARGIN = 1 << 20


def origin(scenario: Scenario) -> dict[str, str]:
    """The origin of a file's numbers: versions, scenario, and the objects that it holds."""
    about = {"stickslip_version": _core.__version__, "numpy_version": np.__version__}
    with contextlib.suppress(importlib.metadata.PackageNotFoundError):  # it comes with an extra
        about["xarray_version"] = importlib.metadata.version("xarray")
    return {**about, **scenario.document()}


def dataset(arrays: Block, about: Mapping[str, Any]) -> xarray.Dataset:
    """See `Run.to_xarray`; `about` has the attributes."""
    with naming_the_extra("Run.to_xarray"):
        import xarray
    variables = {name: (_dimensions(name), array, _about(name)) for name, array in arrays.items()}
    coil = ("coil", list(_core.coil_names), {"long_name": "coil"})
    return xarray.Dataset(variables, {"t": variables.pop("t"), "coil": coil}, about)


def _dimensions(name: str) -> tuple[str, ...]:
    return ("t", "coil") if name == "current" else ("t",)


def _about(name: str) -> dict[str, Any]:
    """Attributes of a quantity."""
    column = COLUMNS[name]
    about: dict[str, Any] = {"units": column.unit, "long_name": column.meaning}
    if name in WORDS:
        about["flag_values"] = np.arange(len(WORDS[name]), dtype=np.int8)
        about["flag_meanings"] = " ".join(WORDS[name])
    return about


class RecordFile:
    """A netCDF file that takes the record of a run block by block, as NAME.part until its end.

    It is closed after each block. If the process ends, even within a block, NAME.part can be
    opened with all earlier blocks.

    Parameters
    ----------
    path : path-like
    scenario : Scenario
    about : mapping
        `Run.attributes` as they are before the run; with them the file is made.

    Attributes
    ----------
    samples : int
        Samples written.
    recorded_until : float
        Time of the last one, s; NaN without one.

    Raises
    ------
    OSError
        If the file cannot be made, and by `write` and `finish` where there is no room.
    """

    def __init__(
        self, path: str | PathLike[str], scenario: Scenario, about: Mapping[str, Any]
    ) -> None:
        with naming_the_extra("a netCDF file"):
            import h5netcdf
            import h5py

        self.path, self.part = Path(path), beside(Path(path), "", PART)
        self.samples, self.recorded_until = 0, math.nan
        self._scenario = scenario
        record = scenario.record
        chunk = 1024  # events; chosen: a run has some thousand
        if isinstance(record.rate, float):
            span = scenario.duration - record.from_
            chunk = max(1, min(BLOCK, math.ceil(record.rate * span) + 1))
        image = io.BytesIO()
        with h5netcdf.File(image, "w", **FORMAT) as file:
            file.dimensions = {"t": None, "coil": len(_core.coil_names)}
            coil = file.create_variable("coil", ("coil",), h5py.string_dtype())
            coil[:] = np.array(_core.coil_names, dtype=object)
            coil.attrs["long_name"] = "coil"
            for name in recorded_names(scenario):
                file.create_variable(
                    name,
                    _dimensions(name),
                    np.int8 if name in WORDS else "float64" if name == "t" else record.dtype,
                    fillvalue=None if name in WORDS else np.nan,
                    chunks=(chunk, 1) if name == "current" else (chunk,),
                    **_STORED,
                ).attrs.update(_about(name))
            _set_attributes(file, {**about, "complete": 0})
        check_writable(path)
        with replacing(self.part) as temporary:
            temporary.write_bytes(image.getbuffer())
        self._inode = os.stat(self.part).st_ino

    def write(self, recording: Block) -> None:
        """Add samples as the core recorded them, or raise an OSError and add none."""
        import h5py

        block = {name: recording[name] for name in recorded_names(self._scenario)}
        self._try(sum(array.nbytes for array in block.values()))
        end = self.samples + len(block["t"])
        access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
        access.set_libver_bounds(h5py.h5f.LIBVER_V110, h5py.h5f.LIBVER_LATEST)
        access.set_file_locking(False, True)  # a reader must not stop the run
        flags = h5py.h5f.ACC_RDWR | h5py.h5f.ACC_SWMR_WRITE
        with h5py.File(h5py.h5f.open(os.fsencode(self.part), flags, access)) as file:
            self._check_own(file.id.get_vfd_handle(access))
            for name, array in block.items():
                file[name].resize(end, axis=0)
                file[name][self.samples :] = array
        if end > self.samples:
            self.samples, self.recorded_until = end, float(block["t"][-1])

    def describe(self, about: Mapping[str, Any], path: Path | None = None) -> None:
        """Add the attributes of a run that ended, and checksums."""
        import h5netcdf

        self._try(0, path)
        path = path or self.part
        with h5netcdf.File(str(path), "r+", locking=False, **FORMAT) as file:
            _set_attributes(file, about)
        with path.open("r+b") as sealed:
            seal(sealed)

    def finish(self, about: Mapping[str, Any]) -> None:
        """The same for a run that came to its end, and give the file its name."""
        self._try(0)
        try:
            with replacing(self.path) as temporary:  # a kill within this leaves NAME.part
                shutil.copyfile(self.part, temporary)
                self.describe(about, temporary)
            self.part.unlink()
        except OSError:  # there is no room for a copy
            self.describe(about)
            os.replace(self.part, self.path)

    def discard(self) -> None:
        """Remove NAME.part, unless another process has written one."""
        with contextlib.suppress(OSError):
            if os.stat(self.part).st_ino == self._inode:
                self.part.unlink()

    @property
    def extent(self) -> str:
        """How far the record goes, for an error."""
        return f"{self.part} has the record up to {self.recorded_until:.6g} s"

    def _check_own(self, file: int) -> None:
        """Raise an OSError for an open file that is not the one that was made."""
        if os.fstat(file).st_ino != self._inode:
            raise NotWritten(f"cannot write {self.part}: another process has replaced it")

    def _try(self, size: int, path: Path | None = None) -> None:
        """Write so many bytes and remove them; an OSError says that there is no room."""
        try:
            with open(path or self.part, "r+b", buffering=0) as file:
                if path is None:
                    self._check_own(file.fileno())
                end = file.seek(0, os.SEEK_END)
                rest = memoryview(bytes(size + _MARGIN))
                try:
                    while rest:
                        rest = rest[file.write(rest) :]
                finally:
                    file.truncate(end)
        except NotWritten:
            raise
        except OSError as error:
            text = f"cannot write {self.part}: {error.strerror or error}"
            raise NotWritten(f"{text}; {self.extent}" if self.samples else text) from None


def _set_attributes(file: Any, about: Mapping[str, Any]) -> None:
    for name, value in about.items():
        file.attrs[name] = value if isinstance(value, str) else np.atleast_1d(value)


def write_run(
    path: str | PathLike[str], scenario: Scenario, about: Mapping[str, Any], arrays: Block
) -> None:
    """Write a run whose arrays are at hand, whole or not at all."""
    with replacing(path) as temporary:  # and NAME.part, which may be what is saved, stays
        part = beside(temporary, "", PART)
        try:
            file = RecordFile(temporary, scenario, about)
            for start in range(0, len(arrays["t"]), BLOCK):
                file.write({name: array[start : start + BLOCK] for name, array in arrays.items()})
            file.describe(about)
            part.replace(temporary)
        except NotWritten as error:
            reason: Any = error.__context__ or error
            text = f"cannot write {path}: {reason.strerror or reason}"
            raise NotWritten(text) from None
        finally:
            part.unlink(missing_ok=True)


class StoredRecord(Mapping[str, "NDArray[Any]"]):
    """The record of a file; each quantity is read at its first use."""

    def __init__(self, path: str | PathLike[str], names: tuple[str, ...]) -> None:
        self._path = Path(path).absolute()
        self._names = names
        with opened(path) as file:
            missing = [name for name in names if name not in file]
            if missing:
                raise ScenarioError(f"is no whole run: it has no {', '.join(missing)}")
            # A process that was killed may have written the last block of some columns only.
            self.samples = min(
                own_rows(file, name, (len(_core.coil_names),) * (len(_dimensions(name)) - 1), BLOCK)
                for name in names
            )
            self.recorded_until = float(file["t"][self.samples - 1]) if self.samples else math.nan
            self._identity = self._identified()

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._names:
            raise KeyError(name)
        with prefixed(self._path), opened(self._path) as file:
            if self._identified() != self._identity:
                raise ScenarioError("is not the file that was opened: open it again")
            array: NDArray[Any] = file[name][: self.samples]
            return array

    def __contains__(self, name: object) -> bool:  # else it is read to see whether it is there
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def _identified(self) -> tuple[int, int]:
        status = os.stat(self._path)
        # One that is being written may grow.
        return status.st_ino, 0 if self._path.suffix == PART else status.st_mtime_ns


_ALLOWED = "allowed is a netCDF file that Run.save or --out wrote"


def stored(path: str | PathLike[str]) -> tuple[Scenario, dict[str, Any], StoredRecord]:
    """Scenario, outcome and record of a run's file, as `Run` takes them."""
    if not isinstance(path, str | PathLike):  # a number is an open file
        refuse("path", path, "the name of a file")
    with prefixed(path):
        with opened(path) as file:
            about = {
                name: value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
                for name, value in file.attrs.items()
            }
            if "t" not in file or "scenario" not in about:
                raise ScenarioError(
                    f"is no run; {_ALLOWED}; a sweep is opened with xarray.open_dataset"
                )
        try:
            scenario = Scenario.of_document(about)
            record = StoredRecord(path, recorded_names(scenario))
            about = {**dict.fromkeys(ASKED, math.nan), **about}
            outcome = {
                "status": about["status"],
                "message": about["message"],
                "numbers": {
                    name: json.loads(about[name]) if isinstance(like, dict) else about[name]
                    for name, like in _core.RunResult().summary().items()
                },
                "condition_met": bool(int(about["condition_met"])),
                "condition": about["condition"],
                "complete": bool(int(about["complete"])),
                "samples": record.samples,
                "recorded_until": record.recorded_until,
            }
            if "final_state" in about:
                outcome["final_state"] = State(**json.loads(about["final_state"]))
        except ScenarioError:
            raise
        except (KeyError, TypeError, ValueError):
            raise ScenarioError(f"is no run of this version; {_ALLOWED}") from None
    return scenario, outcome, record
