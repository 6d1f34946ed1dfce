"""Results of a run, a sweep and a prediction, as tables of text and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip._util.units import handy
from stickslip.scenario.keys import known_keys
from stickslip.simulation.columns import NUMBERS
from stickslip.simulation.note import lines_of_json, shown_lines
from stickslip.simulation.seen_from_drive import ACROSS, ALONG, VELOCITIES, shown_velocities

if TYPE_CHECKING:
    import xarray

    from stickslip.simulation.run import Run

_WORDS = {
    "turning_speed": ", by which turning may change the velocity",
    "slip_up": ", mean slip speed while theta rises",
    "slip_down": ", mean slip speed while theta falls",
    "slip_flat": ", mean slip speed on a face",
    "velocity_growth": ", from a quarter of the pulses to the next, at least",
    "pull_ratio": " of what friction holds, by the in-plane coils' gradient",
    "field_change": ", where the robot ends",
    "field_max": ", of |B| at the robot, in all of the run",
    "field_min": ", least in the measuring window",
    "current_max": "of any coil",
    "voltage_max": "of any coil",
    "power_mean": "in all coils",
}

_MOST_ROWS = 50  # chosen: about one page; a longer table is in the file only

# Where the robot leaves its plane.
_WORDS_OF_THE_PLANE = {
    ALONG: ", along the heading of the drive",
    ACROSS: ", to the left of it",
    "mean_velocity": ", along x",
    "mean_velocity_y": ", along y",
}

# Headings.
_LONE_VELOCITY = "mean velocity"
_SEVERAL_VELOCITIES = {
    ALONG: "velocity along",
    ACROSS: "across",
    "mean_velocity": "velocity along x",
    "mean_velocity_y": "along y",
}
_COLUMNS = {
    "theta_min": "theta from",
    "theta_max": "to",
    "slip_up": "slip up",
    "slip_down": "slip down",
    "airborne_fraction": "airborne",
}

# Every column says its unit: "1" is that of pure numbers, as in the files.
_OF_WORDS = "-"


def _shown_in(name: str) -> tuple[float, str]:
    """Factor and unit in which a number of a summary is shown beside its SI unit."""
    unit = {**NUMBERS, **VELOCITIES}[name].unit
    return (100.0, "%") if unit == "1" else handy(unit)


def summary_table(run: Run) -> str:
    """Names, SI values and handier units in columns."""
    summary = run.summary()
    leaves = run.scenario.turns
    columns = {**(VELOCITIES if ALONG in summary else {}), **NUMBERS} if leaves else NUMBERS
    words = {**_WORDS, **_WORDS_OF_THE_PLANE} if leaves else _WORDS
    measured = "nothing"
    if math.isfinite(summary["mean_velocity"]):
        measured = f"over {summary['window_start']:.6g} to {summary['window_end']:.6g} s"
    rows = [("status", summary["status"], "")]
    for name, (unit, _) in columns.items():
        if name in ("mean_velocity_y", "turning_speed") and not leaves:
            continue
        rows.append(_row(name, summary[name], unit, words.get(name, "")))
    if leaves:
        rows += _rows_of_the_plane(run)
    rows.append(("measured", measured, ""))
    counts = {**summary["events"], "painleve": summary["painleve_events"]}
    met = ", ".join(f"{name} {count}" for name, count in counts.items() if count)
    rows.append(("events", met or "none", ""))
    rows += [("note", line, "") for line in shown_lines(run.notes)]
    return "\n".join(f"{name:<19}{value:<22}{other}".rstrip() for name, value, other in rows)


def _row(name: str, value: float, unit: str, words: str) -> tuple[str, str, str]:
    """A number with its SI unit, in a handier unit, and what it is."""
    value += 0.0  # no negative zero
    factor, other = (100.0, "%") if unit == "1" else handy(unit)
    handier = f"{value * factor:.5g} {other}{words}" if other != unit else words
    return name, f"{value:.6g} {unit}".removesuffix(" 1"), handier


def _rows_of_the_plane(run: Run) -> list[tuple[str, str, str]]:
    """What else a robot does that leaves its plane."""
    end = run.final_state
    return [
        _row("final x", end.x, "m", ""),
        _row("final y", end.y, "m", ""),
        _row("final heading", end.heading, "rad", ", from +x to the left"),
    ]


def sweep_as_dict(data: xarray.Dataset) -> dict[str, Any]:
    """Counts, extremes and the points in order, in the words of a single run's summary."""
    columns = {**_varied_keys(data["status"]), "status": _statuses(data)}
    if "message" in data:
        columns["message"] = _listed(data["message"])
    for name in data.data_vars:
        if name not in ("status", "message", "events"):
            columns[str(name)] = _listed(data[name])
    kinds = data["event"].values.tolist()
    counts = data["events"].values.reshape(-1, len(kinds)).tolist()
    columns["events"] = [dict(zip(kinds, row, strict=True)) for row in counts]
    return {
        "points": data["status"].size,
        "failed": int(data.attrs["failed_points"]),
        "status": json.loads(data.attrs["statuses"]),
        "notes": json.loads(data.attrs["notes"]),
        **_extremes(data),
        "results": _records(columns),
    }


def sweep_table(data: xarray.Dataset) -> str:
    """Counts and extremes; the points too if they are few."""
    sizes = " x ".join(f"{size} {name}" for name, size in data["status"].sizes.items())
    statuses = json.loads(data.attrs["statuses"])
    rows = [
        ("points", f"{data['status'].size} ({sizes})"),
        ("status", ", ".join(f"{name} {count}" for name, count in statuses.items())),
    ]
    velocities = shown_velocities(data)
    figure = next(iter(velocities))
    direction = f" {velocities[figure]}".rstrip()
    for name, point in _extremes(data).items():
        velocity = point.pop(figure)
        where = ", ".join(
            f"{key} = {_value_text(value)} {_key_unit(key)}".rstrip()
            for key, value in point.items()
        )
        rows.append((name, f"{velocity * 1e3:.6g} mm/s{direction} at {where}"))
    rows += [("note", line) for line in lines_of_json(data.attrs["notes"])]
    text = "\n".join(f"{name:<10}{value}" for name, value in rows)
    if data["status"].size > _MOST_ROWS:
        return text
    columns = [*_key_columns(data["status"]), ["status", _OF_WORDS, *_statuses(data)]]
    titles = {**_velocity_titles(data), **_COLUMNS}
    columns += [_figure_column(title, data[name]) for name, title in titles.items()]
    return f"{_aligned(columns)}\n\n{text}"


def sweep_failure(data: xarray.Dataset) -> str:
    """How many points failed, and what the first of them says; empty if none did."""
    failed = int(data.attrs["failed_points"])
    if not failed:
        return ""
    messages = data["message"].values.ravel()
    first = int(np.flatnonzero(messages != "")[0])
    return f"{failed} of {messages.size} points failed; the first: {messages[first]}"


def prediction_as_dict(data: xarray.Dataset) -> dict[str, Any]:
    """The points in order: quantiles of each figure and their errors, lists as `quantiles`."""
    columns = {**_varied_keys(data["failed"]), "failed": _listed(data["failed"])}
    for name, values in data.data_vars.items():
        if "quantile" in values.dims:
            columns[str(name)] = values.values.reshape(-1, data.sizes["quantile"]).tolist()
    return {
        "points": data["failed"].size,
        "draws": int(data.attrs["draws"]),
        "seed": int(data.attrs["seed"]),
        "redrawn": int(data.attrs["redrawn"]),
        "failed": int(data.attrs["failed_draws"]),
        "status": json.loads(data.attrs["statuses"]),
        "notes": json.loads(data.attrs["notes"]),
        "quantiles": data["quantile"].values.tolist(),
        "results": _records(columns),
    }


def prediction_table(data: xarray.Dataset) -> str:
    """Counts and the precision of the quantiles; the points too if they are few."""
    points, draws = data["failed"].size, int(data.attrs["draws"])
    lowest = float(data["quantile"].values.min())
    error = math.sqrt(lowest * (1.0 - lowest) / draws)
    low, high = max(lowest - error, 0.0), lowest + error
    rows = [
        ("points", str(points)),
        ("draws", f"{draws} of each, {int(data.attrs['failed_draws'])} of all failed"),
    ]
    if int(data.attrs["failed_draws"]) < points * draws:
        shares = f"{100 * low:.3g} to {100 * high:.3g} %"
        rows.append(("precision", f"the quantile of {100 * lowest:.4g} % is one of {shares}"))
    rows += [("note", line) for line in lines_of_json(data.attrs["notes"])]
    text = "\n".join(f"{name:<11}{value}" for name, value in rows)
    if points > _MOST_ROWS:
        return text
    # Three lines of heading: figure, unit, quantile.
    columns = _key_columns(data["failed"], "")
    velocity, title = next(iter(_velocity_titles(data).items()))
    for name, heading in ((velocity, title), ("airborne_fraction", "airborne")):
        for level in data["quantile"].values.tolist():
            values = data[name].sel(quantile=level)
            columns.append(_figure_column(heading, values, f"{100.0 * level:.4g} %"))
    columns.append(["failed", "draws", "", *map(str, _listed(data["failed"]))])
    return f"{_aligned(columns)}\n\n{text}"


def prediction_failures(data: xarray.Dataset) -> list[str]:
    """How many draws failed, with what the first of them says, and how many were replaced."""
    lines = []
    if data.attrs["redrawn"]:
        lines.append(
            f"note: {data.attrs['redrawn']} more draws made no scenario, and others took their "
            "place: what is uncertain is cut off where values are not allowed"
        )
    if data.attrs["failed_draws"]:
        count = data["failed"].size * int(data.attrs["draws"])
        lines.append(
            f"{data.attrs['failed_draws']} of {count} draws failed and are in no quantile; the "
            f"first: {data.attrs['message']}"
        )
    return lines


def _varied_keys(like: xarray.DataArray) -> dict[str, list[Any]]:
    """For each swept key its value at every point."""
    return {
        each.attrs["key"]: _listed(each.broadcast_like(like).transpose(*like.dims))
        for each in like.coords.values()
        if "key" in each.attrs
    }


def _records(columns: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """A table by its columns as one by its rows."""
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _listed(array: xarray.DataArray) -> list[Any]:
    """The value at each point, in the order of the points."""
    values: list[Any] = array.values.ravel().tolist()
    return values


def _statuses(data: xarray.Dataset) -> list[str]:
    about = data["status"].attrs
    names = dict(zip(about["flag_values"].tolist(), about["flag_meanings"].split(), strict=True))
    return [names[code] for code in _listed(data["status"])]


def _extremes(data: xarray.Dataset) -> dict[str, dict[str, Any]]:
    """The settings and the velocity of the slowest and of the fastest point."""
    figure = next(iter(shown_velocities(data)))
    velocity = data[figure].values.ravel()
    if np.isnan(velocity).all():
        return {}
    columns = {**_varied_keys(data["status"]), figure: velocity.tolist()}
    places = {"lowest": int(np.nanargmin(velocity)), "highest": int(np.nanargmax(velocity))}
    return {
        name: {key: values[index] for key, values in columns.items()}
        for name, index in places.items()
    }


def _velocity_titles(data: xarray.Dataset) -> dict[str, str]:
    """Headings of the columns of the velocities that tell the motion."""
    names = shown_velocities(data)
    if len(names) == 1:
        return dict.fromkeys(names, _LONE_VELOCITY)
    return {name: _SEVERAL_VELOCITIES[name] for name in names}


def _key_columns(like: xarray.DataArray, *heading: str) -> list[list[str]]:
    """Of each swept key a column: name, unit, other lines of `heading`, and its values."""
    columns = _varied_keys(like)
    words = [key.rpartition(".")[2] for key in columns]
    return [
        [
            word if words.count(word) == 1 else key,
            _column_unit(key),
            *heading,
            *map(_value_text, values),
        ]
        for word, (key, values) in zip(words, columns.items(), strict=True)
    ]


def _figure_column(title: str, values: xarray.DataArray, *heading: str) -> list[str]:
    """The column of a number of the summary: title, unit, other lines of `heading`, and values."""
    factor, unit = _shown_in(str(values.name))
    numbers = values.values.ravel() * factor
    # Rounded first: what rounds to zero has no sign.
    return [
        title,
        unit,
        *heading,
        *(f"{round(number, 4) + 0.0:.4f}" for number in numbers.tolist()),
    ]


def _aligned(columns: Sequence[Sequence[str]]) -> str:
    """Columns of cells, each as wide as the widest of its cells."""
    widths = [max(map(len, column)) for column in columns]
    lines = zip(*columns, strict=True)
    return "\n".join(
        "  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True))
        for line in lines
    )


def _key_unit(key: str) -> str:
    """The unit of a key as it is shown; "" for none."""
    known = known_keys()[key]
    return "" if known.kind == "word" or known.unit == "-" else known.unit


def _column_unit(key: str) -> str:
    """What stands below the heading of a key's column."""
    return _OF_WORDS if known_keys()[key].kind == "word" else _key_unit(key) or "1"


def _value_text(value: object) -> str:
    """A value of a key as it is shown."""
    return f"{value:.9g}" if isinstance(value, float) else str(value)
