"""The results of a sweep as an xarray Dataset."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from stickslip import _core
from stickslip.scenario.keys import known_keys
from stickslip.simulation.columns import NUMBERS
from stickslip.simulation.note import notes_json
from stickslip.simulation.record_file import origin
from stickslip.simulation.seen_from_drive import VELOCITIES
from stickslip.sweeping.notes import notes_of_points
from stickslip.sweeping.plane_velocities import plane_velocities
from stickslip.sweeping.points import LIST_DIMENSION, Points, short_name
from stickslip.sweeping.results import EVENTS, NOT_RUN, OK, STATUSES, Results


def dataset(points: Points, results: Results) -> xarray.Dataset:
    """See `stickslip.sweep`. Arrays are views of those of `results`."""
    dimensions, shape = points.dimensions, points.shape

    def variable(values: NDArray[Any], **attributes: Any) -> tuple[Any, ...]:
        extra = ("event",) if values.ndim == 2 else ()
        shaped = values.reshape(*shape, *values.shape[1:])
        # Half of a sweep's file are counts of events, most of them small.
        encoding = {"zlib": True, "complevel": 1, "shuffle": True}
        return (*dimensions, *extra), shaped, attributes, encoding

    columns = {**NUMBERS, **VELOCITIES}
    numbers = {**results.numbers, **plane_velocities(points, results.numbers)}
    variables = {
        name: variable(values, units=columns[name].unit, long_name=columns[name].meaning)
        for name, values in numbers.items()
    }
    variables["events"] = variable(results.events, units="1", long_name="events by kind")
    variables["painleve_events"] = variable(
        results.painleve_events, units="1", long_name="contacts without a consistent force"
    )
    variables["status"] = variable(
        results.status,
        long_name="how the simulation ended",
        flag_values=np.array(list(STATUSES), dtype=np.int8),
        flag_meanings=" ".join(STATUSES.values()),
    )
    if results.messages:
        messages = np.full(points.count, "", dtype=object)
        for index, text in results.messages.items():
            messages[index] = text
        variables["message"] = (
            dimensions,
            messages.reshape(shape),
            {"long_name": "what happened, of a point that failed"},
        )
    kinds = ("event", list(EVENTS), {"long_name": "kind of event"})
    return xarray.Dataset(
        variables,
        coords={**coordinates(points), "event": kinds},
        attrs={
            **about(points, "parameter sweep", "sweep"),
            "finished_points": results.finished,
            "failed_points": int(np.sum(~np.isin(results.status, (OK, NOT_RUN)))),
            "statuses": json.dumps(results.counts()),
            "notes": notes_json(notes_of_points(points, results)),
        },
    )


def about(points: Points, what: str, command: str) -> dict[str, Any]:
    """Attributes that say where the numbers of some points come from."""
    return {
        "title": f"stick-slip motion of a magnetic micro-robot, {what}",
        "created_by": f"stickslip {_core.__version__}, {command}",
        **origin(points.scenario),
        "arrangement": points.arrangement,
        "vary": points.vary(),
        "points": points.count,
    }


def coordinates(points: Points) -> dict[str, Any]:
    """The values along each dimension, as `xarray.Dataset` takes them."""
    found = {}
    for key in points.keys:
        known = known_keys()[key]
        attributes = {"long_name": known.meaning, "key": key}
        if known.kind != "word":
            attributes["units"] = "1" if known.unit == "-" else known.unit
        name = short_name(key)
        dimension = LIST_DIMENSION if points.arrangement == "list" else name
        found[name] = (dimension, points.labels(key), attributes)
    return found
