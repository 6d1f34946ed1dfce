"""The measurement file: TOML beside CSV tables."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip._util.arrays import Array
from stickslip._util.columns import NothingSound, read_table, sound_numbers
from stickslip._util.files import check_name
from stickslip._util.messages import known_arguments, refuse, shown, suggestion
from stickslip._util.note import Note
from stickslip._util.prior import Prior
from stickslip._util.recipes import Recipe
from stickslip._util.text import OneLine, printable
from stickslip.errors import ScenarioError, prefixed
from stickslip.scenario.keys import COIL_NAMES
from stickslip.scenario.scenario import Scenario, loaded
from stickslip.scenario.toml_file import read_document
from stickslip.scenario.uncertain import COVARIANCE, parse_priors
from stickslip.walker.first_lines import TableGiven, refuse_table
from stickslip.walker.read_tracking import REQUIRED, TrackingRun, read_tracking, stated_number
from stickslip.walker.read_velocity import (
    VelocityData,
    read_new_trials,
    read_velocity,
    velocities,
    with_index_columns,
)

if TYPE_CHECKING:
    from pandas import DataFrame

FORMAT_VERSION = 1

_ENTRIES = {
    "velocity": ("file", "velocity_sd"),
    "tracking": ("file", "frame_rate", "exposure", "noise_x", "noise_theta", "drive"),
    "angle": ("file",),
    "field": ("file",),
}
_KNOWN = ("stickslip_measurement", "name", "scenario", "uncertain", *_ENTRIES)

_COLUMNS = {
    "angle": {"Bx": "T", "Bz": "T", "theta": "rad"},
    "field": {
        **dict.fromkeys(COIL_NAMES, "A"),
        **dict.fromkeys(("x", "y", "z"), "m"),
        **dict.fromkeys(("Bx", "By", "Bz"), "T"),
    },
}

_RECIPES = {observable: Recipe.of(units, units) for observable, units in _COLUMNS.items()}

_REQUIRED = {"velocity": ("velocity",), "tracking": tuple(REQUIRED), **_COLUMNS}
"""The columns without which there is no table of an observable."""

Table = Mapping[str, Array]


@known_arguments
@dataclass(frozen=True, repr=False, eq=False)
class Measurement(OneLine):
    """All that was measured, and what the experimenter believes.

    Attributes
    ----------
    name : str
    scenario : Scenario
        The model as the experimenter believes it; what is uncertain stands in `uncertain` alone.
    uncertain : dict of Prior
        By dotted key.
    velocity : tuple of VelocityData
    tracking : tuple of TrackingRun
    angle, field : tuple of dict
        Columns by name, sound rows only, SI units and radians.
    left_out : tuple of Note
        What was not used and why; each is a sentence as a `str`.
    path : Path
        Of the file; of a table in memory ``DataFrame``.
    files : tuple of Path
        All that was read: the file, and what it and its scenario name.
    """

    name: str
    scenario: Scenario
    uncertain: Mapping[str, Prior]
    velocity: tuple[VelocityData, ...]
    tracking: tuple[TrackingRun, ...]
    angle: tuple[Table, ...]
    field: tuple[Table, ...]
    left_out: tuple[Note, ...]
    path: Path
    files: tuple[Path, ...] = ()

    def __repr__(self) -> str:
        trials = sum(len(data.velocity) for data in self.velocity)
        conditions = sum(len(data.conditions) for data in self.velocity)
        parts = [f"{trials} trials at {conditions} conditions"] if self.velocity else []
        others = (("film", self.tracking), ("table of angles", self.angle))
        for word, data in (*others, ("table of fields", self.field)):
            parts += [f"{len(data)} x {word}"] if data else []
        return (
            f"<Measurement {shown(self.name)}: {', '.join(parts)}, {len(self.left_out)} left out>"
        )

    def beside(self, earlier: Measurement) -> Measurement:
        """This one as a report tells it beside an earlier one, with what both have read."""
        return replace(
            self, name=f"{self.name} against {earlier.name}",
            left_out=(*earlier.left_out, *self.left_out), files=(*earlier.files, *self.files),
        )  # fmt: skip

    @staticmethod
    def from_dataframe(
        table: DataFrame,
        scenario: Scenario,
        uncertain: Mapping[str, Prior | Mapping[str, float]] | None = None,
        *,
        velocity_sd: float | None = None,
        name: str = "DataFrame",
    ) -> Measurement:
        """Mean velocities from a table in memory, with the columns and checks of the CSV file.

        Rows that are not sound are left out, and named in `left_out` by their index label.

        Parameters
        ----------
        table : DataFrame
            One row a trial: `velocity` in m/s; settings named like keys of ``[drive]``, in SI
            units; and, if known, `trial`, `block` (labels) and `order` (numbers or dates).
        scenario : Scenario
            The model as the experimenter believes it, with the settings that have no column.
        uncertain : mapping, optional
            What is not known exactly: for each dotted key, of effects also by short name, a
            `Prior`, or one of the tables of a measurement file, such as
            ``{"mean": 0.145, "sd": 0.01}``. If it is not given, what the scenario holds.
        velocity_sd : float, optional
            Relative standard deviation of one trial, such as 0.05, where trials are not repeated.
        name : str
            Title of the report.

        Raises
        ------
        ScenarioError
            With one line, if a column is missing or like a known one, no row is sound, or a key or
            a prior is not allowed.
        """
        if not isinstance(scenario, Scenario):
            refuse("scenario", scenario, "a Scenario")
        rows = read_table(with_index_columns(table), velocities())
        data, left_out = read_velocity(rows, scenario, _relative_sd(velocity_sd))
        priors = _uncertain(uncertain, scenario)
        scenario = scenario.with_uncertain(None)
        return Measurement(name, scenario, priors, (data,), (), (), (), tuple(left_out), rows.path)

    def with_velocities(self, table: DataFrame | str | PathLike[str]) -> Measurement:
        """The same with one more table of velocities, such as that of `propose_experiments`.

        Rows without a velocity were not measured, and are not used.

        Parameters
        ----------
        table : DataFrame or path of a CSV file
            As for `from_dataframe`: one row a trial.

        Raises
        ------
        ScenarioError
            With one line, if a column is missing or like a known one, a row with a velocity is not
            sound, no row has one, or all trials are in the measurement already.
        """
        rows = read_table(with_index_columns(table), velocities())
        more = () if rows.word == "row" else (rows.path,)
        files = (*self.files, *more)
        data, lost = read_new_trials(rows, self.scenario, self.velocity)
        velocity, left_out = (*self.velocity, data), (*self.left_out, *lost)
        return replace(self, velocity=velocity, left_out=left_out, files=files)


def read_measurement(path: str | PathLike[str]) -> Measurement:
    """Read a measurement file and its tables.

    Rows that are not sound are left out, and said to be in `Measurement.left_out`.

    Raises
    ------
    ScenarioError
        With one line, if the file or one of its tables cannot be used at all.
    """
    path = Path(path)
    try:
        try:
            has = '"stickslip_measurement = 1" and "scenario"'
            document = read_document(path, "measurement", has)
        except ScenarioError:
            if path.is_file():  # a pipe is read once
                refuse_table(path, _REQUIRED)
            raise
        return _measurement(document, path)
    except ScenarioError as error:
        text = str(error)
        if isinstance(error, TableGiven):
            error.args = (f"{path}: {text}",)
            raise
        raise ScenarioError(
            text if text.startswith(printable(path)) else f"{path}: {text}"
        ) from None


def _measurement(document: dict[str, Any], path: Path) -> Measurement:
    if "stickslip_measurement" not in document:
        hint = "; this is a scenario, not a measurement" if "stickslip" in document else ""
        raise ScenarioError(f"stickslip_measurement = {FORMAT_VERSION} is missing{hint}")
    version = document["stickslip_measurement"]
    if isinstance(version, bool) or version != FORMAT_VERSION:
        refuse("stickslip_measurement", version, f"{FORMAT_VERSION}, the version of the format")
    for key, value in document.items():
        if key not in _KNOWN:
            text = f"[[{key}]]" if _are_tables(value) else f"{key} = {shown(value)}"
            raise ScenarioError(f"{text}: there is no such entry; {suggestion(key, _KNOWN)}")
    name = document.get("name", path.stem)
    if not isinstance(name, str):
        refuse("name", name, "a text")
    nominal = _path_of(document, "scenario", "", "a scenario file")
    scenario, files = loaded(path.parent / nominal)
    uncertain = _uncertain(document.get("uncertain"), scenario)
    files.insert(0, path)
    tables, left_out = _tables(document, path, scenario, files)
    if not any(tables.values()):
        if left_out:
            raise ScenarioError(f"nothing sound is left. {left_out[-1]}")
        raise ScenarioError("there is none of [[velocity]], [[tracking]], [[angle]], [[field]]")
    return Measurement(
        name=name,
        scenario=scenario.with_uncertain(None),
        uncertain=uncertain,
        **{observable: tuple(data) for observable, data in tables.items()},
        left_out=tuple(left_out),
        path=path,
        files=tuple(dict.fromkeys(files)),
    )


def _tables(
    document: dict[str, Any], path: Path, scenario: Scenario, read: list[Path]
) -> tuple[dict[str, list[Any]], list[Note]]:
    """Usable rows of the tables of each observable, and what was left out of them.

    Their files join those that were `read`.
    """
    tables: dict[str, list[Any]] = {observable: [] for observable in _ENTRIES}
    left_out: list[Note] = []
    for observable in _ENTRIES:
        files: set[str] = set()
        for entry in _entries(document, observable):
            file = path.parent / entry["file"]
            if os.path.realpath(file) in files:
                twice = f"[[{observable}]] file = {shown(entry['file'])} is there twice"
                raise ScenarioError(f"{twice}: allowed is once, or its rows would count twice")
            files.add(os.path.realpath(file))
            read.append(file)
            try:
                data, lost = _table(observable, file, entry, scenario, tables["velocity"])
            except NothingSound as error:
                data, lost = None, [error.note]
            tables[observable] += [] if data is None else [data]
            left_out += lost
    return tables, left_out


def _table(
    observable: str,
    file: Path,
    entry: Mapping[str, Any],
    scenario: Scenario,
    earlier: Sequence[VelocityData],
) -> tuple[Any, list[Note]]:
    if observable == "velocity":
        rows, sd = read_table(file, velocities()), _relative_sd(entry.get("velocity_sd"))
        return read_velocity(rows, scenario, sd, earlier)
    if observable == "tracking":
        return read_tracking(file, entry, scenario)
    return sound_numbers(file, _RECIPES[observable])


def _path_of(table: Mapping[str, Any], key: str, section: str, what: str) -> str:
    """The path under a key that has to be there."""
    if key not in table:
        raise ScenarioError(f"{section}{key} is missing: allowed is the path of {what}")
    if not isinstance(table[key], str):
        refuse(f"{section}{key}", table[key], f"the path of {what}")
    return str(table[key])


def _are_tables(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(entry, dict) for entry in value)


def _uncertain(table: object, scenario: Scenario) -> dict[str, Prior]:
    """Priors of a measurement, or those of its scenario where it says nothing of them.

    The stated model is at their middles, which are to make a scenario together.
    """
    known = "allowed are priors of single keys, as a diagnosis takes its constants as independent"
    if table is None and scenario.uncertain is not None:
        if scenario.uncertain.keys:
            raise ScenarioError(
                f"the scenario's [uncertain.{COVARIANCE}]: {known}; a section [uncertain] of the "
                "measurement, even an empty one, takes its place"
            )
        table = scenario.uncertain.priors
    if isinstance(table, Mapping) and COVARIANCE in table:
        raise ScenarioError(f"[uncertain.{COVARIANCE}]: {known}")
    priors = parse_priors({} if table is None else table)
    try:
        scenario.replace({name: float(prior.value(0.0)) for name, prior in priors.items()})
    except ScenarioError as error:
        wrong = (f' "{name}" = {prior}' for name, prior in priors.items() if name in str(error))
        raise ScenarioError(f"[uncertain]{next(wrong, '')}: {error}") from None
    return priors


def _entries(document: dict[str, Any], observable: str) -> list[dict[str, Any]]:
    entries: list[dict[str, Any]] = document.get(observable, [])
    if not _are_tables(entries):
        raise ScenarioError(f"{observable}: allowed are sections [[{observable}]]")
    for entry in entries:
        for key, value in entry.items():
            if key not in _ENTRIES[observable]:
                raise ScenarioError(
                    f"[[{observable}]] {key} = {shown(value)}: there is no such key; "
                    f"{suggestion(key, _ENTRIES[observable])}"
                )
        file = _path_of(entry, "file", f"[[{observable}]] ", "a CSV file")
        with prefixed(f"[[{observable}]] file = {shown(file)}", OSError):
            check_name(file)
    return entries


def _relative_sd(value: object) -> float:
    """The stated relative error of one trial; NaN where none is stated."""
    return math.nan if value is None else stated_number("[[velocity]] velocity_sd", value, 1.0)
