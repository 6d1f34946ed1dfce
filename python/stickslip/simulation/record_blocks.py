"""The blocks of samples in which a record goes into a file, and what a file of one has to do."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from stickslip._util.files import NotWritten
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import recorded_fields
from stickslip.simulation.columns import PLANE_COLUMNS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from stickslip.scenario.scenario import Scenario
    from stickslip.simulation.run import Run

Block = Mapping[str, "NDArray[Any]"]
"""Arrays of the recorded quantities by name, all of one length."""

BLOCK = 65536
"""Samples of a block that is cut from arrays: as many as the core hands over at a time."""


class RecordFile(Protocol):
    """A file that takes a record block by block."""

    def write(self, block: Block) -> None:
        """Add samples; none of them, with an OSError, where there is no room for all."""

    def finish(self, run: Run) -> None:
        """Add what is known at the end: scenario, summary and how far the record goes."""


class RecordNotWritten(NotWritten):
    """The record of a run could not be written, or not to its end; `run` is the run."""

    def __init__(self, text: str, run: Run) -> None:
        super().__init__(text)
        self.run = run


def turns(scenario: Scenario) -> bool:
    """Whether the record of a scenario has `PLANE_COLUMNS`: `Scenario.turns`."""
    try:
        return scenario.turns
    except ScenarioError:
        return False  # with an effect of one's own, gone since, the robot stays in one plane


def recorded_names(scenario: Scenario) -> tuple[str, ...]:
    """The quantities that a run of a scenario keeps; none without a record."""
    record = scenario.record
    if record.rate == "none":
        return ()
    left_out = set() if record.rate == "events" else {"event"}
    if not turns(scenario):
        left_out |= {*PLANE_COLUMNS}
    return tuple(name for name in recorded_fields(str(record.fields)) if name not in left_out)


def kept(scenario: Scenario, arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """What the core recorded, in the precision that the scenario asks for."""
    return {
        name: arrays[name].astype(scenario.record.dtype, copy=False)
        if name != "t" and arrays[name].dtype.kind == "f"
        else arrays[name]
        for name in recorded_names(scenario)
    }


def write_run(run: Run, file: RecordFile) -> None:
    """Write a run whose arrays are at hand."""
    arrays = {name: getattr(run, name) for name in recorded_names(run.scenario) or ("t",)}
    for start in range(0, max(len(arrays["t"]), 1), BLOCK):  # a block at least, for the columns
        file.write({name: array[start : start + BLOCK] for name, array in arrays.items()})
    file.finish(run)


def is_csv(path: str | PathLike[str]) -> bool:
    """Whether a name is that of a CSV file; others are netCDF."""
    return Path(path).suffix.lower() == ".csv"


def record_file(
    path: str | PathLike[str], scenario: Scenario
) -> contextlib.AbstractContextManager[RecordFile]:
    """A file of the format that the suffix names, which takes its name as the block ends."""
    if is_csv(path):
        from stickslip.simulation.csv_export import csv_file

        return csv_file(path)
    from stickslip.simulation.netcdf import netcdf_file

    return netcdf_file(path, scenario)
