"""What one simulation gives: a summary, and the recorded motion."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any, NamedTuple

from stickslip import _core
from stickslip._util.files import NETCDF_SUFFIXES, check_suffix
from stickslip.scenario.sections import State
from stickslip.simulation.columns import COLUMNS, PLANE_COLUMNS, WORDS
from stickslip.simulation.note import Note, by_seriousness
from stickslip.simulation.record_blocks import is_csv, recorded_names, turns, write_run
from stickslip.simulation.run_notes import run_notes

if TYPE_CHECKING:
    import numpy as np
    import xarray
    from numpy.typing import NDArray
    from pandas import DataFrame

    from stickslip._util.numbers import Array
    from stickslip.scenario.scenario import Scenario
    from stickslip.simulation.stored_run import StoredRecord


def resting_force(scenario: Scenario) -> float:
    """Normal force on a body that lies still without field: weight and adhesion, N."""
    weight = scenario.robot.mass * scenario.environment.gravity
    return weight + scenario.contact.adhesion


SUFFIXES = (*NETCDF_SUFFIXES, ".csv")
"""Suffixes of the files that a run can be saved as."""


class Outcome(NamedTuple):
    """What a run comes to, beside its record: see `Run`."""

    status: str
    message: str
    numbers: Mapping[str, Any]  # the summary without status, notes and window
    final_state: State
    condition_met: bool
    complete: bool
    recorded_until: float
    condition: str  # `until` of `simulate`; "" without one

    @staticmethod
    def of(
        result: _core.RunResult, recorded_until: float, until: str | None, cut: bool = False
    ) -> Outcome:
        """What the core found; `cut`: whether the record could not be kept to its end."""
        return Outcome(
            result.status,
            result.message,
            result.summary(),
            State.view(result.final_state),
            result.stopped,
            result.status == "ok" and not cut,
            recorded_until,
            "" if until is None else " ".join(until.split()),
        )


class Run:
    """One simulation's result. SI units and radians; x and velocities in the world's frame.

    Arrays have one entry for each recorded sample; n is the number of samples. Those of a run that
    was recorded into a file, or is read back from one, are read when they are first asked for.

    Attributes
    ----------
    scenario : Scenario
        What was simulated.
    status : str
        ``"ok"``, or how the simulation failed; it never raises for that.
    message : str
        What happened and what to do about it.
    final_state : State
        Where the run ended; a scenario can begin there.
    condition_met : bool
        Whether the run ended where its condition `until` was met.
    condition : str
        That condition; "" for a run without one.
    complete : bool
        Whether the run came to its end, and its record too: not after a failure or Ctrl-C, or where
        a file could not be written on.
    recorded_until : float
        Time of the last recorded sample, s; NaN without one.
    t, x, z, theta, vx, vz, omega : numpy.ndarray, shape (n,)
        Time (s); position (m), tilt (rad) and their rates, at the centre of mass, Eqs. (10)-(14).
    normal_force, friction_force : numpy.ndarray, shape (n,)
        Forces of the surface on the body, N; zero in flight.
    contact_x, slip_velocity : numpy.ndarray, shape (n,)
        Position (m) and velocity (m/s) of the contact point, P_x in Eq. (13); NaN in flight.
    bx, by, bz : numpy.ndarray, shape (n,)
        Field at the centre of mass, T, Eqs. (2)-(7).
    y, vy, heading : numpy.ndarray, shape (n,)
        Position (m) and velocity (m/s) across the x axis, and where the robot faces (rad from +x to
        the left). The heading is from -pi to pi, and jumps where it passes these: ``np.unwrap``
        gives it without the jumps, as the pictures draw it. Recorded of runs in the whole plane
        alone (`Scenario.turns`), as are the next; in other runs these three are constant.
    friction_across, contact_y, slip_across : numpy.ndarray, shape (n,)
        Beside `friction_force` and `slip_velocity`, which are along the heading there, those to its
        left (N, m/s); y of the contact point (m).
    current : numpy.ndarray, shape (n, 5)
        Currents of the coils xp, xm, yp, ym, clamp, A, Eq. (1).
    contact : numpy.ndarray of int8, shape (n,)
        Mode of the contact, an index of `contact_names`.
    event : numpy.ndarray of int8, shape (n,)
        Kind of the event, an index of `event_names`; with ``record.rate = "events"`` only.
    """

    contact_names = WORDS["contact"]
    event_names = WORDS["event"]

    scenario: Scenario
    final_state: State
    condition_met: bool
    condition: str
    status: str
    message: str
    numbers: Mapping[str, Any]
    complete: bool
    recorded_until: float
    t: Array
    x: Array
    z: Array
    theta: Array
    vx: Array
    vz: Array
    omega: Array
    normal_force: Array
    friction_force: Array
    contact_x: Array
    slip_velocity: Array
    bx: Array
    by: Array
    bz: Array
    y: Array
    vy: Array
    heading: Array
    friction_across: Array
    contact_y: Array
    slip_across: Array
    current: Array
    contact: NDArray[np.int8]
    event: NDArray[np.int8]

    def __init__(
        self,
        scenario: Scenario,
        outcome: Outcome,
        record: Mapping[str, NDArray[Any]] | StoredRecord | None,
    ) -> None:
        self.scenario = scenario
        vars(self).update(outcome._asdict())
        self._stored: StoredRecord | None = None
        if isinstance(record, Mapping):
            vars(self).update(record)
        else:
            self._stored = record

    # Hidden from type checkers, which would else take any name for an attribute.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name not in COLUMNS:
                raise AttributeError(f"a Run has no attribute {name!r}")
            record = self.scenario.record
            if self._stored is not None and name in recorded_names(self.scenario):
                vars(self)[name] = self._stored.read(name)
                return vars(self)[name]
            if self.recorded and name in PLANE_COLUMNS and not turns(self.scenario):
                return self._in_one_plane(name)
            needed = 'record.rate to "events"' if name == "event" else "record.fields to name it"
            if record.rate == "none":
                needed = 'record.rate to a number of Hz, or "events"'
            raise AttributeError(f"this run did not record {name}: set {needed}")

    def _in_one_plane(self, name: str) -> Array:
        """A quantity of `PLANE_COLUMNS` of a robot that stays in the plane y = 0."""
        import numpy as np

        if name not in ("y", "vy", "heading"):
            raise AttributeError(
                f"this run has no {name}: the robot stays in the plane y = 0, where it is zero"
            )
        constant: float = getattr(self.final_state, name)
        return np.full(self.samples, constant, dtype=self.scenario.record.dtype)

    def __repr__(self) -> str:
        samples = f"{self.samples} samples" if self.recorded else "no record"
        from stickslip.simulation.run_display import velocities

        velocity = ", ".join(
            f"{value:.6g} m/s {words}".rstrip() for words, value in velocities(self).items()
        )
        return f"<Run: {self.status}, {velocity}, {samples}>"

    def _repr_html_(self) -> str:
        from stickslip.simulation.run_display import run_html

        return run_html(self)

    @property
    def ok(self) -> bool:
        """Whether the simulation reached its end."""
        return self.status == "ok"

    @property
    def recorded(self) -> bool:
        """Whether there are arrays."""
        return self._stored is not None or "t" in vars(self)

    @property
    def samples(self) -> int:
        """Number of recorded samples, n; 0 without a record."""
        if self._stored is not None:
            return self._stored.samples
        return len(self.t) if self.recorded else 0

    @property
    def mean_velocity(self) -> float:
        """dx/dt over the measuring window, m/s (section VII of the paper); NaN if not measured.

        Of a robot that is driven another way than along x see `velocity`.
        """
        velocity: float = self.numbers["mean_velocity"]
        return velocity

    @property
    def velocity(self) -> tuple[float, float]:
        """Mean velocity over the measuring window as seen from the drive, m/s.

        Returns
        -------
        along, across : float
            Along the heading of the drive (``+x`` of a program) and to its left; NaN if not
            measured.
        """
        from stickslip.simulation.seen_from_drive import seen_from_drive

        drive = self.scenario.drive
        x, y = self.numbers["mean_velocity"], self.numbers["mean_velocity_y"]
        along, across = seen_from_drive(x, y, drive.mode, drive.direction, drive.heading)
        return float(along), float(across)

    @functools.cached_property
    def notes(self) -> list[Note]:
        """What a reader of the numbers should know, the most serious first; mostly none.

        Each has a code, one line of text with what to do, and the number that it is about. Of the
        run: not measured whole, a condition `until` that was never met, a robot at rest and what
        holds it, one that hops, is pulled by the field's gradient, rolls over, walks out of the
        field or has no steady velocity. Of the scenario: values that are probably mistakes, such as
        no pulses, lengths in another unit, pulses far shorter than the coils' time constant, or a
        loose tolerance. Why a robot rests is found by a few short simulations.
        """
        notes = run_notes(self.scenario, self.status, self.numbers, self.condition_met)
        if self.complete and self.condition and not self.condition_met:
            text = f"the condition {self.condition} was not met until the end of the run"
            notes.append(Note("condition-not-met", text))
        if self.ok and not self.complete and self.recorded:
            until = self.recorded_until
            text = f"the record ends at {until:.6g} s: it could not be written on"
            notes.append(Note("record-cut", text, until))
        return by_seriousness(notes)

    def summary(self) -> dict[str, Any]:
        """What the run comes to.

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
            before its window does.
        """
        core: dict[str, Any] = {**self.numbers}
        core["events"] = dict(core["events"])
        core["steps"] = dict(core["steps"])
        start, end = self.scenario.window
        if self.condition_met:
            end = max(start, min(end, core["simulated_time"]))
        if turns(self.scenario) and self.scenario.drive.mode != "program":
            core |= dict(zip(("velocity_along", "velocity_across"), self.velocity, strict=True))
        return {
            "status": self.status,
            "message": self.message,
            "notes": [note.as_dict() for note in self.notes],
            "window_start": start,
            "window_end": end,
            **core,
        }

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
        from stickslip.simulation.netcdf import dataset

        return dataset(self)

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
        from stickslip.simulation.run_table import run_table

        return run_table(self)

    def to_netcdf(self, path: str | PathLike[str]) -> None:
        """Write `to_xarray` to a netCDF file, whole or not at all; errors are those of `save`."""
        from stickslip.simulation.netcdf import netcdf_file

        with netcdf_file(path, self.scenario) as file:
            write_run(self, file)

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Write the recorded columns to a CSV file, whole or not at all.

        The headings name the units, such as ``t (s)``; contact and event are words. A cell without
        a value, such as the slip of a contact in flight, is empty. What no column says, scenario
        and summary, goes beside it, to ``<name>.csv.json``. Errors are those of `save`.
        """
        from stickslip.simulation.csv_export import csv_file

        with csv_file(path) as file:
            write_run(self, file)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the record in the format that the suffix names: `to_netcdf` or `to_csv`.

        Parameters
        ----------
        path : path-like
            Ends in ``.nc``, ``.nc4``, ``.h5`` (netCDF) or ``.csv``.

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
        if is_csv(path):
            self.to_csv(path)
        else:
            self.to_netcdf(path)
