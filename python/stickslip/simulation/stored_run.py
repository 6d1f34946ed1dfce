"""Runs that are read back from the files that `Run.save` and ``--out`` write."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping
from itertools import islice
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip import _core
from stickslip._util.checksum import check_checksum, sha256_of
from stickslip._util.extras import naming_the_extra
from stickslip._util.files import read_bytes
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.scenario import scenario_of
from stickslip.scenario.sections import State
from stickslip.simulation.columns import WORDS
from stickslip.simulation.csv_export import beside, headings
from stickslip.simulation.record_blocks import BLOCK, is_csv, recorded_names
from stickslip.simulation.run import Outcome, Run
from stickslip.simulation.run_attributes import map_of, program_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from stickslip.scenario.scenario import Scenario

_YES_OR_NO = {0: False, 1: True}

_ALLOWED = "allowed is a netCDF file that Run.save or --out wrote"

# Of the file beside a CSV file, bytes; chosen: voltages of two million rows and more fit into it.
_MOST_BYTES = 1 << 30

# Text of a cell: the longest are doubles such as -2.2250738585072014e-308, of 24 characters.
_CELL = "U32"


class StoredRecord:
    """The record of a run in its file, of which each quantity is read when it is wanted."""

    def __init__(self, path: str | PathLike[str], scenario: Scenario, samples: int) -> None:
        self.samples = samples
        self._path = Path(path).absolute()
        self._dtype = scenario.record.dtype
        self._identity = self._identified()

    def read(self, name: str) -> NDArray[Any]:
        """The array of a quantity; a ScenarioError if the file is not the one that it was."""
        try:
            if self._identified() != self._identity:
                raise ScenarioError(f"{self._path}: has changed since this run was opened")
            if is_csv(self._path):
                return _csv_column(self._path, name, self._dtype)
            import h5py

            with h5py.File(self._path) as file:
                array: NDArray[Any] = file[name][()]
                return array
        except OSError as error:
            raise ScenarioError(
                f"{self._path}: cannot be read: {error.strerror or error}"
            ) from None

    def _identified(self) -> tuple[int, int, int]:
        found = os.stat(self._path)
        return found.st_ino, found.st_size, found.st_mtime_ns


def open_run(path: str | PathLike[str]) -> Run:
    """Read a run from a file that `Run.save`, `simulate` or ``stickslip run --out`` wrote.

    Parameters
    ----------
    path : path-like
        A netCDF file; or a CSV file, with the ``.csv.json`` that was written beside it.

    Returns
    -------
    Run
        As it was, with scenario, summary and arrays. These are read when they are first asked for,
        so the file has to stay as it is until then.

    Raises
    ------
    ScenarioError
        If the file cannot be read, holds no run, or is not as it was written; also when a quantity
        is read later.
    """
    try:
        with prefixed(path):
            about = (_csv_attributes if is_csv(path) else _netcdf_attributes)(path)
            scenario = scenario_of(about["scenario"], program_of(about), map_of(about))
            outcome = _outcome(about)
    except ScenarioError:
        raise
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (KeyError, TypeError, ValueError):
        raise ScenarioError(f"{path}: is no run of this version; {_ALLOWED}") from None
    missing = [name for name in recorded_names(scenario) if name not in about["columns"]]
    if missing:
        raise ScenarioError(f"{path}: is no whole run: it has no {', '.join(missing)}")
    return Run(scenario, outcome, StoredRecord(path, scenario, about["samples"]))


def _netcdf_attributes(path: str | PathLike[str]) -> dict[str, Any]:
    """What a file says beside its samples, with the names of its `columns` and its `samples`."""
    with naming_the_extra("a netCDF file"):
        import h5py

    check_checksum(path)
    try:
        with h5py.File(path) as file:
            about = {name: _plain(value) for name, value in file.attrs.items()}
            columns = {name: len(item) if item.shape else 1 for name, item in file.items()}
    except Exception:  # whatever HDF5 and its readers raise for another file
        raise ScenarioError(f"is no netCDF file; {_ALLOWED}") from None
    if "t" not in columns or "scenario" not in about:
        raise ScenarioError(
            f"is no run; {_ALLOWED}; of a sweep it is opened with xarray.open_dataset"
        )
    return {**about, "columns": columns, "samples": columns["t"]}


def _plain(value: Any) -> Any:
    """A number or a text of an attribute, which netCDF keeps as an array of one."""
    return value.item() if isinstance(value, np.ndarray) and value.size == 1 else value


def _csv_attributes(path: str | PathLike[str]) -> dict[str, Any]:
    with open(path, "rb") as file:
        first = file.readline().decode("utf-8", "replace").rstrip("\r\n").split(",")
        file.seek(0)
        checksum = sha256_of(file)
    side = beside(path)
    if not side.exists():
        raise ScenarioError(
            f"{side.name} is missing beside it: allowed is a CSV file of a run with the file of "
            "scenario and summary that was written with it"
        )
    try:
        about = json.loads(read_bytes(side, _MOST_BYTES, "file of a run"))
        if about["stickslip_run"] != 1:
            raise ValueError
        expected = about["sha256"]
    except ScenarioError as error:
        raise ScenarioError(f"{side.name} {error}") from None
    except (ValueError, TypeError, KeyError):
        raise ScenarioError(f"{side.name} beside it is no file of a run") from None
    if checksum != expected:
        raise ScenarioError(
            f"its checksum is not that of {side.name}: it has been changed, or one of the two is "
            "of another run"
        )
    columns = [name for name in _core.record_columns if {*headings(name)} <= {*first}]
    return {**about, "columns": columns}


def _csv_column(path: Path, name: str, dtype: str) -> NDArray[Any]:
    codes = {word: code for code, word in enumerate(WORDS.get(name, ()))}

    def parsed(cells: NDArray[Any]) -> NDArray[Any]:
        if codes:
            return np.array([[codes[word]] for word in cells[:, 0]], dtype=np.int8).reshape(-1, 1)
        # By way of a double, as the numbers were made; an empty cell is no number for numpy.
        numbers = np.where(cells == "", "nan", cells).astype("float64")
        return numbers if name == "t" else numbers.astype(dtype)

    array = np.concatenate([parsed(cells) for cells in _cells(path, headings(name))])
    return array if name == "current" else array[:, 0]


def _cells(path: Path, titles: list[str]) -> Iterator[NDArray[Any]]:
    """Some columns as text, a block at a time, as text takes ten times the room of the numbers."""
    with open(path, encoding="utf-8") as file:
        first = file.readline().rstrip("\n").split(",")
        places = [first.index(title) for title in titles]
        yield np.empty((0, len(titles)), dtype=_CELL)
        while lines := list(islice(file, BLOCK)):
            yield np.loadtxt(
                lines, dtype=_CELL, comments=None, delimiter=",", usecols=places, ndmin=2
            )


def _outcome(about: Mapping[str, Any]) -> Outcome:
    summary: dict[str, Any] = {}
    empty: dict[str, Any] = {**_core.RunResult().summary()}
    for name, like in empty.items():
        value = about[name]
        if isinstance(like, dict):
            summary[name] = json.loads(value)
        else:
            summary[name] = math.nan if value is None else type(like)(value)
    until = about["recorded_until"]
    return Outcome(
        status=about["status"],
        message=about["message"],
        numbers=summary,
        final_state=State(**json.loads(about["final_state"])),
        condition_met=_YES_OR_NO[about["condition_met"]],
        complete=_YES_OR_NO[about["complete"]],
        recorded_until=math.nan if until is None else until,
        condition=about.get("condition", ""),
    )
