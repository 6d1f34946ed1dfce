"""A prediction as a table of text and as JSON."""

from __future__ import annotations

import json
import math
from typing import Any

from stickslip.cli.tables import (
    MOST_ROWS,
    aligned,
    figure_column,
    key_columns,
    listed,
    records,
    varied_keys,
)
from stickslip.control.prediction import Prediction

# Figures of the table, with their headings.
_COLUMNS = {"mean_velocity": "mean velocity", "airborne_fraction": "airborne"}


def prediction_as_dict(prediction: Prediction) -> dict[str, Any]:
    """The points in order: quantiles of each figure and their errors, lists as `quantiles`."""
    data = prediction.data
    columns = {**varied_keys(data["failed"]), "failed": listed(data["failed"])}
    for name, values in data.data_vars.items():
        if "quantile" in values.dims:
            columns[str(name)] = values.values.reshape(-1, data.sizes["quantile"]).tolist()
    return {
        "points": data["failed"].size,
        "draws": prediction.draws,
        "seed": int(data.attrs["seed"]),
        "redrawn": prediction.redrawn,
        "failed": prediction.failed,
        "status": json.loads(data.attrs["statuses"]),
        "quantiles": data["quantile"].values.tolist(),
        "results": records(columns),
    }


def prediction_table(prediction: Prediction) -> str:
    """Counts and the precision of the quantiles; the points too if they are few."""
    data = prediction.data
    points, draws = data["failed"].size, prediction.draws
    lowest = float(data["quantile"].values.min())
    error = math.sqrt(lowest * (1.0 - lowest) / draws)
    low, high = max(lowest - error, 0.0), lowest + error
    rows = [
        ("points", str(points)),
        ("draws", f"{draws} of each, {prediction.failed} of all failed"),
    ]
    if prediction.failed < points * draws:
        shares = f"{100 * low:.3g} to {100 * high:.3g} %"
        rows.append(("precision", f"the quantile of {100 * lowest:.4g} % is one of {shares}"))
    text = "\n".join(f"{name:<11}{value}" for name, value in rows)
    return f"{_rows(prediction)}\n\n{text}" if points <= MOST_ROWS else text


def prediction_failures(prediction: Prediction) -> list[str]:
    """How many draws failed, with what the first of them says, and how many were replaced."""
    lines = []
    data = prediction.data
    if prediction.redrawn:
        lines.append(
            f"note: {prediction.redrawn} more draws made no scenario, and others took their place: "
            "what is uncertain is cut off where values are not allowed"
        )
    if prediction.failed:
        count = data["failed"].size * prediction.draws
        lines.append(
            f"{prediction.failed} of {count} draws failed and are in no quantile; the first: "
            f"{data.attrs['message']}"
        )
    return lines


def _rows(prediction: Prediction) -> str:
    """A table of all points with three lines of heading: figure, unit, quantile."""
    data = prediction.data
    columns = key_columns(data["failed"], "")
    for name, title in _COLUMNS.items():
        for level in data["quantile"].values.tolist():
            values = data[name].sel(quantile=level)
            columns.append(figure_column(title, values, f"{100.0 * level:.4g} %"))
    columns.append(["failed", "", "", *map(str, listed(data["failed"]))])
    return aligned(columns)
