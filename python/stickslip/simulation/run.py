"""The result of one simulation: a summary and the recorded motion."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Iterable, Mapping
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip import _core
from stickslip._util.files import NETCDF_SUFFIXES, check_suffix, write_rows
from stickslip._util.html import html_table
from stickslip._util.note import Note
from stickslip._util.text import printable
from stickslip._util.units import handy
from stickslip.extras import naming_the_extra
from stickslip.scenario.sections import State
from stickslip.simulation.notes import by_seriousness, notes_json, run_notes, shown_lines
from stickslip.simulation.quantities import (
    ASKED,
    INNER_COLUMNS,
    NUMBERS,
    PLANE_COLUMNS,
    WORDS,
    column_units,
    headings,
    recorded_names,
)
from stickslip.simulation.record_file import dataset, origin, stored, write_run
from stickslip.simulation.recorded import Recorded
from stickslip.simulation.seen_from_drive import (
    ACROSS,
    ALONG,
    FROM_AXES,
    FROM_DRIVE,
    IN_ONE_PLANE,
    VELOCITIES,
    seen_from_drive,
)

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray
    from pandas import DataFrame

    from stickslip.scenario.scenario import Scenario

SUFFIXES = (*NETCDF_SUFFIXES, ".csv")
"""Suffixes of the files that a run can be saved as."""


class Run(Recorded):
    """One simulation's result. SI units and radians; x and velocities in the world's frame.

    Each number of the summary is an attribute, such as `mean_velocity` and `theta_max`; NaN if it
    was not measured. So is each recorded quantity, an array with an entry for each of the n
    samples: `t`, `x`, `theta`, ... of shape (n,), `current` of shape (n, 5) for the coils xp, xm,
    yp, ym, clamp. The page *What a run gives* lists all with units and meanings. `contact` and
    `event` are indices (int8) of `contact_names` and `event_names`. A contact without a value, in
    flight, is NaN. The heading jumps between -pi and pi; ``np.unwrap`` takes the jumps away. Arrays
    of a run that is in a file are read when they are first asked for.

    Attributes
    ----------
    scenario : Scenario
        What was simulated.
    status : str
        ``"ok"``, or how the simulation failed; it never raises for that.
    message : str
        What happened and what to do about it.
    numbers : mapping
        The numbers and counts of `summary`.
    final_state : State
        Where the run ended; a scenario can begin there. Not of a run whose process was killed.
    condition_met : bool
        Whether the run ended where its condition `until` was met.
    condition : str
        That condition; "" for a run without one.
    complete : bool
        Whether the run came to its end and its record with it: not after Ctrl-C, an error, or a
        disk that was full.
    samples : int
        Number of recorded samples, n; 0 without a record.
    recorded_until : float
        Time of the last recorded sample, s; NaN without one.
    """

    contact_names = WORDS["contact"]
    event_names = WORDS["event"]

    scenario: Scenario
    status: str
    message: str
    numbers: Mapping[str, Any]
    final_state: State
    condition_met: bool
    condition: str
    complete: bool
    samples: int
    recorded_until: float

    def __init__(
        self, scenario: Scenario, outcome: Mapping[str, Any], record: Mapping[str, NDArray[Any]]
    ) -> None:
        self.scenario = scenario
        self._record = record
        vars(self).update(outcome)

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        result: _core.RunResult,
        until: str | None = None,
        *,
        complete: bool = True,
        samples: int = 0,
        recorded_until: float = float("nan"),
        record: Mapping[str, NDArray[Any]] | None = None,
    ) -> Run:
        """The run of a result of the core; one that is not complete was interrupted."""
        message, _ = _core.statuses["interrupted"]
        outcome = {
            "status": result.status if complete else "interrupted",
            "message": result.message if complete else message,
            "numbers": result.summary(),
            "final_state": State.view(result.final_state),
            "condition_met": result.stopped,
            "condition": "" if until is None else " ".join(until.split()),
            "complete": complete,
            "samples": samples,
            "recorded_until": recorded_until,
        }
        return cls(scenario, outcome, {} if record is None else record)

    def _number(self, name: str) -> float:
        if name in self._unasked():
            raise AttributeError(f'this run has no {name}: set {ASKED[name]} to "yes"')
        return float(self.numbers[name])

    def _unasked(self) -> list[str]:
        return [name for name, key in ASKED.items() if self.scenario.get(key) == "no"]

    def _recorded(self, name: str) -> NDArray[Any]:
        if name in self._record:
            values = vars(self)[name] = self._record[name]
            return values
        if self.recorded and name in PLANE_COLUMNS and not self.scenario.whole_plane:
            return self._in_one_plane(name)
        if name in INNER_COLUMNS and self.scenario.inner.mass == 0.0:
            raise AttributeError(f"this run has no {name}: the robot has no inner mass")
        needed = 'record.rate to "events"' if name == "event" else "record.fields to name it"
        if self.scenario.record.rate == "none":
            needed = 'record.rate to a number of Hz, or "events"'
        raise AttributeError(f"this run did not record {name}: set {needed}")

    def _in_one_plane(self, name: str) -> NDArray[Any]:
        """A quantity of `PLANE_COLUMNS` of a robot that stays in the plane y = 0."""
        state = getattr(self, "final_state", self.scenario.initial)
        if not hasattr(state, name):
            raise AttributeError(
                f"this run has no {name}: the robot stays in the plane y = 0, where it is zero"
            )
        return np.full(self.samples, getattr(state, name), dtype=self.scenario.record.dtype)

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *NUMBERS, *self._record]

    def __repr__(self) -> str:
        return f"<Run: {self._headline()}>"

    def _headline(self) -> str:
        """Status, mean velocities in mm/s and number of samples, in one line."""
        words = IN_ONE_PLANE
        if self.scenario.whole_plane:
            words = FROM_AXES if self.scenario.drive.kind == "program" else FROM_DRIVE
        # Along x there is one, which `velocity` sees from the drive.
        velocities = self.velocity if self.scenario.whole_plane else (self.mean_velocity,)
        factor, unit = handy("m/s")
        velocity = ", ".join(
            f"{value * factor:.6g} {unit} {direction}".rstrip()
            for direction, value in zip(words.values(), velocities, strict=True)
        )
        samples = f"{self.samples} samples" if self.recorded else "no record"
        return f"{self.status}, {velocity}, {samples}"

    def _repr_html_(self) -> str:
        """The headline and notes, and a table of the numbers."""
        lines = [self._headline(), *([] if self.ok else [self.message]), *shown_lines(self.notes)]
        summary = self.summary()
        rows = [
            (name, f"{summary[name]:.6g} {unit}".removesuffix(" 1") + f": {meaning}")
            for name, (unit, meaning) in {**VELOCITIES, **NUMBERS}.items()
            if math.isfinite(summary.get(name, math.nan))
        ]
        events = ", ".join(f"{count} {kind}" for kind, count in summary["events"].items() if count)
        texts = "".join(f"<p>{escape(printable(line))}</p>\n" for line in lines)
        return texts + html_table("Summary", [*rows, ("events", events or "none")])

    @property
    def ok(self) -> bool:
        """Whether the simulation reached its end."""
        return self.status == "ok"

    @property
    def recorded(self) -> bool:
        """Whether there are arrays."""
        return bool(self._record)

    @property
    def velocity(self) -> tuple[float, float]:
        """Mean velocity over the measuring window as seen from the drive, m/s.

        Returns
        -------
        along, across : float
            Along the heading of the drive (``+x`` of a program) and to its left; NaN if not
            measured.
        """
        drive = self.scenario.drive
        x, y = self.numbers["mean_velocity"], self.numbers["mean_velocity_y"]
        along, across = seen_from_drive(x, y, drive.kind, drive.direction, drive.heading)
        return float(along), float(across)

    @functools.cached_property
    def notes(self) -> list[Note]:
        """Notes on the numbers, the most serious first; mostly none.

        Each has a code, one line of text with what to do, and the number that it is about. Of the
        run: not measured whole, a condition `until` that was never met, a robot at rest and what
        holds it, one that hops, is pulled by the field's gradient, rolls over, walks out of the
        field or has no steady velocity. Of the scenario: values that are probably mistakes, such as
        no pulses, an odd density, pulses far shorter than the coils' time constant, or a
        loose tolerance. Why a robot rests is found by a few short simulations.
        """
        notes = run_notes(self.scenario, self.status, self.numbers, self.condition_met)
        if self.ok and self.condition and not self.condition_met:
            end = f"{self.simulated_time:.6g} s: a longer drive may meet it"
            text = f"the condition {self.condition} was not met until the end of the run at {end}"
            notes.append(Note("condition-not-met", text))
        if self.recorded and not self.complete:
            until = self.recorded_until
            text = f"the record ends at {until:.6g} s, before the end of the run"
            notes.append(Note("record-cut", text, until))
        return by_seriousness(notes)

    def summary(self) -> dict[str, Any]:
        """The numbers of the run.

        Returns
        -------
        dict
            `status`, `message` and `notes` (list of dicts, see `Run.notes`); the measuring window
            from `window_start` to `window_end` (s; where the run was ended by its condition, if
            that was earlier); the numbers of the run, such as `mean_velocity` (m/s) and `theta_max`
            (rad), which the page *What a run gives* lists with units and meanings; of a pulsed
            drive in the whole plane also `velocity_along` and `velocity_across` (m/s, see
            `velocity`); `events` (counts by kind), `painleve_events`, and `steps` (of the
            integrator). What was not measured is NaN, such as the mean velocity of a run that ends
            before its window does. `pull_share` is there if the scenario asks for it.
        """
        start, end = self.scenario.window
        if self.condition_met:
            end = max(start, min(end, self.numbers["simulated_time"]))
        of_the_plane = {}
        if self.scenario.whole_plane and self.scenario.drive.kind != "program":
            of_the_plane = dict(zip((ALONG, ACROSS), self.velocity, strict=True))
        unasked = self._unasked()
        numbers = {name: number for name, number in self.numbers.items() if name not in unasked}
        counts = {name: dict(numbers[name]) for name in ("events", "steps")}
        return {
            "status": self.status,
            "message": self.message,
            "notes": [note.as_dict() for note in self.notes],
            "window_start": start,
            "window_end": end,
            **numbers,
            **counts,
            **of_the_plane,
        }

    def attributes(self) -> dict[str, Any]:
        """The attributes of its netCDF file, which with the arrays make it a `Run` again."""
        summary = self.summary()
        about = {
            "title": "stick-slip motion of a magnetic micro-robot",
            "source": f"stickslip {_core.__version__}",
            **origin(self.scenario),
            **{key: value for key, value in summary.items() if not isinstance(value, dict | list)},
            "notes": notes_json(self.notes),
            "events": json.dumps(summary["events"]),
            "steps": json.dumps(summary["steps"]),
            "condition_met": int(self.condition_met),
            "condition": self.condition,
            "complete": int(self.complete),
            "recorded_until": self.recorded_until,
        }
        if self.complete or self.numbers["simulated_time"]:  # else nobody knows where it is
            about["final_state"] = json.dumps(self.final_state.as_dict())
        return about

    def _arrays(self) -> dict[str, NDArray[Any]]:
        """The recorded quantities by name; an AttributeError without a record."""
        return {name: getattr(self, name) for name in recorded_names(self.scenario) or ("t",)}

    def to_xarray(self) -> xarray.Dataset:
        """The recorded motion, with units, meanings, the summary and the scenario as attributes.

        Returns
        -------
        xarray.Dataset
            One variable for each array, over ``t``; `current` over ``coil`` too.

        Raises
        ------
        AttributeError
            If the run has no record.
        """
        return dataset(self._arrays(), self.attributes())

    def to_dataframe(self) -> DataFrame:
        """The recorded motion as a table, a row for each sample.

        Returns
        -------
        pandas.DataFrame
            A column for each array that was recorded, by its name; of `current` one for each coil,
            ``current_xp`` to ``current_clamp``. Contact and event are words. The attribute
            ``attrs["units"]`` has the SI unit of each column, "" for words.

        Raises
        ------
        AttributeError
            If the run has no record.
        """
        with naming_the_extra("Run.to_dataframe"):
            import pandas as pd
        columns: dict[str, Any] = {}
        units: dict[str, str] = {}
        for name, values in self._arrays().items():
            units |= column_units(name)
            if name in WORDS:
                columns[name] = pd.Categorical.from_codes(values, list(WORDS[name]))
            else:
                parts = values.T if values.ndim == 2 else [values]
                columns |= dict(zip(column_units(name), parts, strict=True))
        table = pd.DataFrame(columns)
        table.attrs["units"] = units
        return table

    def to_netcdf(self, path: str | PathLike[str]) -> None:
        """Write `to_xarray` to a netCDF file, whole or not at all; errors are those of `save`."""
        write_run(path, self.scenario, self.attributes(), self._arrays())

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Write the record to a CSV file, as `save` does."""
        titles: list[str] = []
        columns: list[list[Any]] = []
        for name, values in self._arrays().items():
            titles += headings(name)
            if name in WORDS:
                columns.append([WORDS[name][code] for code in values])
            else:
                parts = values.T if values.ndim == 2 else [values]
                columns += [
                    np.where(np.isnan(part), "", part.astype(str)).tolist() for part in parts
                ]
        write_rows(path, [titles], zip(*columns, strict=True))

    def save(self, path: str | PathLike[str]) -> None:
        """Write the record in the format that the suffix names, whole or not at all.

        A CSV file is for other programs: its headings name the units, such as ``t (s)``, contact
        and event are words, and a cell without a value, such as the slip in flight, is empty.

        Parameters
        ----------
        path : path-like
            Ends in ``.nc``, ``.nc4``, ``.h5`` (netCDF) or ``.csv``. `open_run` reads netCDF only.

        Raises
        ------
        AttributeError
            If the run has no record.
        ValueError
            If the suffix is another.
        OSError
            If the file cannot be written; an older file of that name is then untouched.
        """
        check_suffix(path, SUFFIXES)
        write = self.to_csv if Path(path).suffix.lower() == ".csv" else self.to_netcdf
        write(path)


def open_run(path: str | PathLike[str]) -> Run:
    """Read a run from a netCDF file that `Run.save`, `simulate` or ``stickslip run --out`` wrote.

    Parameters
    ----------
    path : path-like
        Also the ``NAME.part`` of a run that goes on or was ended by Ctrl-C, a full disk or
        ``kill -9``: it has the samples of all whole blocks, is not `complete`, and has a note.

    Returns
    -------
    Run
        As it was, with scenario, summary and arrays. These are read when they are first asked for,
        so the file has to stay as it is until then.

    Raises
    ------
    ScenarioError
        If the file cannot be read or holds no run; also when a quantity is read later.
    """
    return Run(*stored(path))
