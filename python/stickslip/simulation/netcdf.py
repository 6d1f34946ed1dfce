"""A run as an xarray Dataset and as a netCDF file."""

from __future__ import annotations

import io
import json
from os import PathLike
from typing import TYPE_CHECKING, Any

import h5netcdf
import numpy as np
import xarray
from xarray.backends import H5NetCDFStore

from stickslip import _core
from stickslip._util.atomic_files import replacing
from stickslip._util.checksum import append_checksum, check_checksum
from stickslip.errors import ScenarioError
from stickslip.scenario.sections import COIL_NAMES
from stickslip.scenario.waveform_json import voltage_blocks
from stickslip.simulation.run import WORDS, Run, recorded_columns

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

SAMPLES = "t"

_ALLOWED = "allowed is a netCDF file that Run.save or --out wrote"


def dataset(run: Run) -> xarray.Dataset:
    """See `Run.to_xarray`."""
    variables: dict[str, Any] = {}
    for name, column in recorded_columns(run).items():
        attributes: dict[str, Any] = {"units": column.unit, "long_name": column.meaning}
        if name in WORDS:
            attributes["flag_values"] = np.arange(len(WORDS[name]), dtype=np.int8)
            attributes["flag_meanings"] = " ".join(WORDS[name])
        dimensions = (SAMPLES, "coil") if name == "current" else (SAMPLES,)
        variables[name] = (dimensions, getattr(run, name), attributes)
    return xarray.Dataset(
        {name: variable for name, variable in variables.items() if name != SAMPLES},
        coords={
            SAMPLES: variables[SAMPLES],
            "coil": ("coil", list(COIL_NAMES), {"long_name": "coil"}),
        },
        attrs=_attributes(run),
    )


def _attributes(run: Run) -> dict[str, Any]:
    summary = run.summary()
    numbers = {name: value for name, value in summary.items() if not isinstance(value, dict | list)}
    return {
        "title": "stick-slip motion of a magnetic micro-robot",
        "source": f"stickslip {_core.__version__}",
        **origin(run.scenario),
        **numbers,
        "notes": json.dumps(summary["notes"]),
        "events": json.dumps(summary["events"]),
    }


def origin(scenario: Scenario) -> dict[str, str]:
    """What a file says of where its numbers come from: versions, scenario and its voltages."""
    about = {
        "stickslip_version": _core.__version__,
        "xarray_version": xarray.__version__,
        "numpy_version": np.__version__,
        "scenario": scenario.to_toml(),
    }
    # A scenario's text names a file in place of the voltages.
    voltages = voltage_blocks(scenario.drive.program)
    return {**about, "voltage_blocks": voltages} if voltages else about


def open_run(path: str | PathLike[str]) -> xarray.Dataset:
    """Read a run that `Run.to_netcdf` wrote; the pictures of one motion take it as they take a Run.

    Returns
    -------
    xarray.Dataset
        What `Run.to_xarray` gave, in memory: the file is closed.

    Raises
    ------
    ScenarioError
        If the file cannot be read, is no netCDF file, holds no run, or is not as it was written.
    """
    try:
        check_checksum(path)
    except ScenarioError as error:
        raise ScenarioError(f"{path}: {error}") from None
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror or error}") from None
    try:
        with xarray.open_dataset(path, engine="h5netcdf") as file:
            data = file.load()
    except Exception:  # whatever HDF5 and its readers raise for another file
        raise ScenarioError(f"{path}: is no netCDF file; {_ALLOWED}") from None
    if SAMPLES not in data.coords or "scenario" not in data.attrs:
        raise ScenarioError(f"{path}: is no run; {_ALLOWED}")
    return data


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
