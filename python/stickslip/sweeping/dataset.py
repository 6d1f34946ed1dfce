"""The Dataset of a sweep: empty at first, filled in any order, then completed by its notes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip import _core
from stickslip._util.arrays import Indices
from stickslip._util.note import Note
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import known_keys
from stickslip.simulation.notes import by_seriousness, notes_json, scenario_notes
from stickslip.simulation.quantities import ASKED, NUMBERS
from stickslip.simulation.seen_from_drive import VELOCITIES, seen_from_drive
from stickslip.sweeping.points import DRAW, Points, name_of

if TYPE_CHECKING:
    import xarray

NOT_RUN, REFUSED, OK = -2, -1, 0
STATUSES = {NOT_RUN: "not_run", REFUSED: "refused", **dict(enumerate(_core.statuses))}
"""Names of all statuses by number; `refused` is a point whose values make no scenario."""

PAINLEVE = "painleve"
EVENTS = tuple(name for name in _core.events if name != PAINLEVE)
"""Kinds of event that are counted in `events`."""

# Half of a sweep's file are counts of events, most of them small.
_ENCODING = {"zlib": True, "complevel": 1, "shuffle": True}


def empty(points: Points) -> xarray.Dataset:
    """The Dataset of a sweep without a result."""
    import xarray

    dims, shape = tuple(points.sizes), points.shape

    def variable(values: NDArray[Any], *extra: str, **about: Any) -> tuple[Any, ...]:
        return (*dims, *extra), values, about, _ENCODING

    variables = {
        name: variable(np.full(shape, np.nan), units=unit, long_name=meaning)
        for name, (unit, meaning) in _core.summary_numbers.items()
        if name not in ASKED or np.any(points.at_each(ASKED[name]) != "no")
    }
    counts = np.zeros((*shape, len(EVENTS)), dtype=np.int64)
    variables["events"] = variable(counts, "event", units="1", long_name="events by kind")
    variables["painleve_events"] = variable(
        np.zeros(shape, dtype=np.int64), units="1", long_name=_core.events[PAINLEVE]
    )
    variables["status"] = variable(
        np.full(shape, NOT_RUN, dtype=np.int8),
        long_name="how the simulation ended",
        flag_values=np.array(list(STATUSES), dtype=np.int8),
        flag_meanings=" ".join(STATUSES.values()),
    )
    message = {"long_name": "what happened, of a point that failed"}
    variables["message"] = (dims, np.full(shape, "", dtype=object), message)
    coords: dict[str, Any] = {"event": ("event", list(EVENTS), {"long_name": "kind of event"})}
    for key, (dimension, values) in points.columns.items():
        known = known_keys()[key]
        about = {"long_name": known.meaning, "key": key}
        if known.kind != "word":
            about["units"] = "1" if known.unit == "-" else known.unit
        coords[name_of(key)] = (dimension, values, about)
    about = {
        "title": "stick-slip motion of a magnetic micro-robot",
        "created_by": f"stickslip {_core.__version__}",
        "sweep": points.identity(),
    }
    return xarray.Dataset(variables, coords, about)


def flat(data: xarray.Dataset, name: str) -> NDArray[Any]:
    """A view of a variable with one entry, or one row, for each point."""
    values, status = data.variables[name].values, data.variables["status"]
    return values.reshape(status.size, *values.shape[status.ndim :])


def put(
    data: xarray.Dataset,
    indices: Indices,
    columns: Mapping[str, NDArray[Any]],
    messages: Mapping[int, str],
) -> None:
    """Store results of some points; of a failed point only its time."""
    failed = columns["status"] != OK
    for name in _core.summary_numbers.keys() & data.keys():
        lost = failed & (name != "simulated_time")
        flat(data, name)[indices] = np.where(lost, np.nan, columns[name])
    flat(data, "events")[indices] = np.column_stack([columns[kind] for kind in EVENTS])
    flat(data, "painleve_events")[indices] = columns[PAINLEVE]
    flat(data, "status")[indices] = columns["status"]
    for row, text in messages.items():
        flat(data, "message")[indices[row]] = text


def finished(data: xarray.Dataset, points: Points) -> xarray.Dataset:
    """The Dataset with velocities, counts and notes of its results so far."""
    codes, counts = np.unique(data["status"], return_counts=True)
    by_status = dict(zip(codes.tolist(), counts.tolist(), strict=True))
    columns = {str(name): values.values for name, values in data.items()}
    about = {
        "finished_points": points.count - by_status.get(NOT_RUN, 0),
        "failed_points": sum(n for code, n in by_status.items() if code not in (NOT_RUN, OK)),
        "statuses": json.dumps({STATUSES[code]: n for code, n in by_status.items()}),
        "notes": notes_json(notes_of(points, columns, things_of(points))),
    }
    made = data.assign(_seen_from_drive(data, points)).assign_attrs(about)
    return made if np.any(data["message"] != "") else made.drop_vars("message")


def things_of(points: Points) -> str:
    """The points in words."""
    return "simulations" if DRAW in points.sizes else "points"


def _seen_from_drive(data: xarray.Dataset, points: Points) -> dict[str, Any]:
    """`VELOCITIES`, m/s, unless no robot went across x, or every drive is one without heading."""
    x, y = data["mean_velocity"], data["mean_velocity_y"]
    if not np.nan_to_num(y).any():
        return {}
    kind = np.vectorize(_core.drive_kinds.__getitem__, [str])(points.at_each("drive.mode"))
    if np.all(kind == "program"):
        return {}
    drive = kind, points.at_each("drive.direction"), points.at_each("drive.heading")
    columns = zip(VELOCITIES.items(), seen_from_drive(x.values, y.values, *drive), strict=True)
    return {
        name: (x.dims, values, {"units": unit, "long_name": meaning}, _ENCODING)
        for (name, (unit, meaning)), values in columns
    }


def notes_of(points: Points, columns: Mapping[str, NDArray[Any]], things: str) -> list[Note]:
    """The most serious first; the value of what the runs do is the number of `things` that do it.

    `columns` are those of the core by name, of all points. Notes on the scenario are those that do
    not depend on what is varied.
    """
    ok = columns["status"] == 0
    pulses = points.at_each("drive.pulses").reshape(ok.shape)[ok]
    numbers = {name: columns[name][ok] for name in NUMBERS if name in columns}
    counts = _core.count_notes(points.scenario.to_core(), numbers, pulses)
    still = (columns["mean_velocity"] == 0.0) & (columns["mean_velocity_y"] == 0.0)
    still &= columns["theta_min"] == columns["theta_max"]
    counts["rest"] = int((still & ok).sum())
    texts = {row["code"]: row["many"] for row in _core.note_rows if "many" in row}
    texts["rest"] = "the robot never moved; the notes of such a run alone say why"
    notes = [
        Note(code, f"{count} of {points.count} {things}: {texts[code]}", float(count))
        for code, count in counts.items()
        if count
    ]
    ends = []
    for end in (0, -1):
        changes = {key: points.at_each(key).flat[end].item() for key in points.keys}
        try:
            ends.append(scenario_notes(points.scenario.replace(changes)))
        except ScenarioError:  # a point that is refused
            return by_seriousness(notes)
    return by_seriousness([*notes, *(note for note in ends[0] if note in ends[1])])
