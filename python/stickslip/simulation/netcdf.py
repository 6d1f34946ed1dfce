"""A run as an xarray Dataset and as a netCDF file."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util.checksum import append_checksum
from stickslip._util.extras import naming_the_extra
from stickslip._util.files import replacing
from stickslip._util.sheltered_file import ShelteredFile
from stickslip.scenario.keys import COIL_NAMES
from stickslip.simulation.columns import COLUMNS, WORDS
from stickslip.simulation.record_blocks import recorded_names
from stickslip.simulation.run import Run
from stickslip.simulation.run_attributes import attributes, origin

with naming_the_extra("a netCDF file or an xarray Dataset"):
    import h5netcdf
    import h5py
    import xarray
    from xarray.backends import H5NetCDFStore

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario
    from stickslip.simulation.record_blocks import Block

SAMPLES = "t"

# zlib's fastest level after a shuffle of the bytes. Measured on 262 144 samples of a walking robot:
# the slowest level takes half as long again for a file that is 2 % smaller.
_COMPRESSION: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}

# Of what HDF5 keeps beside the samples, bytes; chosen: a block adds less than a tenth of it.
_MARGIN = 1 << 20


def dataset(run: Run) -> xarray.Dataset:
    """See `Run.to_xarray`."""
    variables = {
        name: (_dimensions(name), getattr(run, name), _about(name))
        for name in recorded_names(run.scenario) or (SAMPLES,)
    }
    coil = ("coil", list(COIL_NAMES), {"long_name": "coil"})
    coords = {SAMPLES: variables.pop(SAMPLES), "coil": coil}
    return xarray.Dataset(variables, coords, attributes(run))


def _dimensions(name: str) -> tuple[str, ...]:
    return (SAMPLES, "coil") if name == "current" else (SAMPLES,)


def _about(name: str) -> dict[str, Any]:
    """Attributes of a quantity."""
    column = COLUMNS[name]
    about: dict[str, Any] = {"units": column.unit, "long_name": column.meaning}
    if name in WORDS:
        about["flag_values"] = np.arange(len(WORDS[name]), dtype=np.int8)
        about["flag_meanings"] = " ".join(WORDS[name])
    return about


class _NetcdfFile:
    """A `RecordFile` that is netCDF."""

    def __init__(self, file: io.FileIO, scenario: Scenario) -> None:
        self._bytes = ShelteredFile(file)
        self._file = h5netcdf.File(self._bytes, "w")
        self._about = origin(scenario)
        self._samples = 0

    def write(self, block: Block) -> None:
        about = sum(map(len, self._about.values()))
        self._bytes.reserve(sum(array.nbytes for array in block.values()) + about + _MARGIN)
        if SAMPLES not in self._file.variables:
            self._begin(block)
        end = self._samples + len(block[SAMPLES])
        self._file.resize_dimension(SAMPLES, end)
        for name, array in block.items():
            self._file.variables[name][self._samples : end] = array
        self._samples = end

    def _begin(self, block: Block) -> None:
        """Make the variables, whose chunks are as long as the first block."""
        chunk = max(len(block[SAMPLES]), 1)
        self._file.dimensions = {SAMPLES: None, "coil": len(COIL_NAMES)}
        coil = self._file.create_variable("coil", ("coil",), h5py.string_dtype())
        coil[:] = np.array(COIL_NAMES, dtype=object)
        coil.attrs["long_name"] = "coil"
        for name, array in block.items():
            variable = self._file.create_variable(
                name,
                _dimensions(name),
                array.dtype,
                fillvalue=None if name in WORDS else np.nan,
                chunks=(chunk, 1) if name == "current" else (chunk,),
                **_COMPRESSION,
            )
            variable.attrs.update(_about(name))

    def finish(self, run: Run) -> None:
        for name, value in attributes(run).items():
            self._file.attrs[name] = value if isinstance(value, str) else np.atleast_1d(value)
        self._file.close()
        append_checksum(self._bytes.finish())

    def close(self) -> None:
        with contextlib.suppress(Exception):  # of a file that is not kept
            self._file.close()


@contextlib.contextmanager
def netcdf_file(path: str | PathLike[str], scenario: Scenario) -> Iterator[_NetcdfFile]:
    """See `record_file`."""
    with (
        replacing(path) as temporary,
        open(temporary, "x+b", buffering=0) as file,
        contextlib.closing(_NetcdfFile(file, scenario)) as record,
    ):
        yield record


def write_netcdf(data: xarray.Dataset, path: str | PathLike[str]) -> None:
    """Write a netCDF file with its checksum, whole or not at all.

    Raises
    ------
    OSError
        If the file cannot be written; an older file of that name is then untouched.
    """
    # Written to memory first: where a disk is full, HDF5 can take the process down with it.
    image = io.BytesIO()
    with h5netcdf.File(image, "w") as file:
        data.dump_to_store(H5NetCDFStore(file))
    append_checksum(image)
    with replacing(path) as temporary:
        temporary.write_bytes(image.getbuffer())
