"""The file of a sweep: written at intervals while the sweep runs, and read to resume it."""

from __future__ import annotations

import json
import os
import time
from os import PathLike
from typing import Any

import h5netcdf
import numpy as np

from stickslip import _core
from stickslip._util.checksum import check_checksum
from stickslip.errors import ScenarioError
from stickslip.simulation.record_file import map_of, origin, write_netcdf
from stickslip.sweeping.dataset import dataset
from stickslip.sweeping.points import Points
from stickslip.sweeping.results import NOT_RUN, Results

_FIRST_AFTER = 0.5
"""Time to the first checkpoint, s. Chosen: a file is there early, and it costs as much as the last
one, which is written in any case."""

_MIN_INTERVAL = 1.0
"""Least time between two checkpoints, s, as `sweep` promises."""

_MAX_SHARE = 0.03
"""Share of the time that may go into writing the others; as `sweep` promises."""


class Checkpoint:
    """Writes a sweep's results to a file at intervals; the file is complete at any time."""

    def __init__(self, path: str | PathLike[str], points: Points, results: Results) -> None:
        self._path = path
        self._points = points
        self._results = results
        self._written = results.finished
        self._next = time.monotonic() + _FIRST_AFTER

    def write(self) -> None:
        """Write all results so far; if that fails, the file is as it was before."""
        start = time.monotonic()
        write_netcdf(dataset(self._points, self._results), self._path)
        end = time.monotonic()
        self._written = self._results.finished
        self._next = end + max(_MIN_INTERVAL, (end - start) / _MAX_SHARE)

    def write_if_due(self) -> None:
        """Write if there are new results and the last write was long enough ago."""
        if time.monotonic() >= self._next and self.has_unsaved_results:
            self.write()

    @property
    def has_unsaved_results(self) -> bool:
        """Whether there are results that the file does not hold."""
        return self._results.finished > self._written


def read(path: str | PathLike[str], points: Points) -> Results:
    """The results that a file of the same sweep and version holds, if it is as it was written."""
    try:
        if not check_checksum(path):
            raise ScenarioError(
                "it is not the file of a sweep, of an earlier version, damaged, or rewritten by "
                "another program: there is no checksum at its end"
            )
        with h5netcdf.File(os.fspath(path), "r") as file:
            _check_same({name: file.attrs[name] for name in file.attrs}, points)
            return _results(file, points)
    except ScenarioError as error:
        raise ScenarioError(f"{path} cannot be resumed: {error}") from None
    except Exception as error:  # whatever a damaged file makes HDF5 raise
        reason = " ".join(str(error).split())
        raise ScenarioError(
            f"{path} cannot be resumed: it is not the file of a sweep ({reason})"
        ) from None


def _check_same(found: dict[str, Any], points: Points) -> None:
    if "vary" not in found or "scenario" not in found:
        raise ScenarioError("it is not the file of a sweep")
    here = origin(points.scenario)
    version = str(found.get("stickslip_version"))
    if version != _core.__version__:
        raise ScenarioError(f"it is of stickslip {version}, and this is {_core.__version__}")
    if found["scenario"] != here["scenario"]:
        different = _difference(found["scenario"], here["scenario"])
        raise ScenarioError(f"its scenario differs: {different}")
    if found.get("voltage_blocks") != here.get("voltage_blocks"):
        raise ScenarioError("its voltages differ")
    if map_of(found) != points.scenario.coil.map:
        raise ScenarioError("its map of the field (coil.map) differs")
    if (found.get("arrangement"), found["vary"]) != (points.arrangement, points.vary()):
        raise ScenarioError(f"its points differ: {_other_points(found['vary'], points.vary())}")


def _difference(there: str, here: str) -> str:
    """The first line in which two scenarios differ."""
    section = ""
    for old, new in zip(there.splitlines(), here.splitlines(), strict=False):
        if old != new:
            theirs, ours = (line.partition("#")[0].strip() for line in (old, new))
            return f"{section} {theirs} there, {ours} here"
        section = old if old.startswith("[") else section
    return "other extensions of the model"


def _other_points(there: str, here: str) -> str:
    theirs, ours = json.loads(there), json.loads(here)
    if list(theirs) != list(ours):
        return f"{', '.join(theirs)} there, {', '.join(ours)} here"
    key = next((key for key in ours if theirs[key] != ours[key]), None)
    return "a list and a grid" if key is None else f"other values of {key}"


def _results(file: h5netcdf.File, points: Points) -> Results:
    results = Results(points.count)
    arrays = {**results.numbers, "status": results.status, "events": results.events}
    for name, values in {**arrays, "painleve_events": results.painleve_events}.items():
        values[:] = np.asarray(file[name]).reshape(values.shape)
    results.finished = int(np.count_nonzero(results.status != NOT_RUN))
    if "message" in file.variables:
        texts = np.asarray(file["message"]).ravel()
        for index in np.flatnonzero(texts != ""):
            text = texts[index]
            results.messages[int(index)] = text.decode() if isinstance(text, bytes) else str(text)
    return results
