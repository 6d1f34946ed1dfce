"""The results of a sweep or of a prediction as a pandas table."""

from __future__ import annotations

from typing import Any

import pandas as pd
import xarray

from stickslip._util.messages import refuse


def sweep_dataframe(data: xarray.Dataset) -> pd.DataFrame:
    """The results of a sweep or of a prediction as a table, a row for each point.

    Parameters
    ----------
    data : xarray.Dataset
        What `sweep` or `predict` gave, also read back from its file, or a part of it by ``.sel``.

    Returns
    -------
    pandas.DataFrame
        Columns are the keys that were varied, by their names in the Dataset, the word `status`, the
        numbers of the summary such as `mean_velocity` (m/s), counts of events such as
        `events_stick`, and, if a point failed, `message`. Of a prediction `failed`, and of each
        number a column for each quantile, such as `mean_velocity_q10`. The attribute
        ``attrs["units"]`` has the SI unit of each column, "1" for a pure number and "" for words.

    Raises
    ------
    ScenarioError
        If the Dataset is not one of a sweep or of a prediction.

    Examples
    --------
    >>> table = sweep_dataframe(sweep(Scenario(drive=Drive(pulses=2)), {"drive.peak": [0.0, 1e-3]}))
    >>> table[["drive_peak", "status"]]
       drive_peak status
    0       0.000     ok
    1       0.001     ok
    >>> table.attrs["units"]["mean_velocity"]
    'm/s'
    """
    names = {*getattr(data, "data_vars", ())}
    counted = "status" if "status" in names else "failed"
    if not ("failed" in names or {"status", "mean_velocity"} <= names):
        refuse("data", data, "what sweep or predict gave")
    like = data[counted]
    columns: dict[str, Any] = {}
    units: dict[str, str] = {}

    def add(name: str, values: xarray.DataArray) -> None:
        columns[name] = values.broadcast_like(like).transpose(*like.dims).values.ravel()
        units[name] = str(values.attrs.get("units", ""))

    for name, coordinate in like.coords.items():
        if "key" in coordinate.attrs:
            add(str(name), coordinate)
    add(counted, like)
    if counted == "status":
        words = like.attrs["flag_meanings"].split()
        by_code = dict(zip(like.attrs["flag_values"].tolist(), words, strict=True))
        columns["status"] = [by_code[code] for code in columns["status"].tolist()]
    for name, values in data.drop_vars(counted).data_vars.items():
        over = [str(name) for name in values.dims if name not in like.dims]
        if not over:
            add(str(name), values)
        for label in values[over[0]].values.tolist() if over else ():
            word = label if over[0] == "event" else f"q{100.0 * label:g}"
            add(f"{name}_{word}", values.sel({over[0]: label}))
    table = pd.DataFrame(columns)
    table.attrs["units"] = units
    return table
