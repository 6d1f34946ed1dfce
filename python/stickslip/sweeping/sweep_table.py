"""The results of a sweep as a pandas table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pandas as pd

from stickslip._util.messages import refuse

if TYPE_CHECKING:
    import xarray


def sweep_dataframe(data: xarray.Dataset) -> pd.DataFrame:
    """The results of a sweep as a table, a row for each point.

    Parameters
    ----------
    data : xarray.Dataset
        What `sweep` gave, also read back from its file, or a part of it by ``.sel``.

    Returns
    -------
    pandas.DataFrame
        Columns are the keys that were varied, by their names in the Dataset, the word `status`, the
        numbers of the summary such as `mean_velocity` (m/s), counts of events such as
        `events_stick`, and, if a point failed, `message`. The attribute ``attrs["units"]`` has the
        SI unit of each column, "1" for a pure number and "" for words.

    Raises
    ------
    ScenarioError
        If the Dataset is not one of a sweep.

    Examples
    --------
    >>> table = sweep_dataframe(sweep(Scenario(drive=Drive(pulses=2)), {"drive.peak": [0.0, 1e-3]}))
    >>> table[["peak", "status"]]
        peak status
    0  0.000     ok
    1  0.001     ok
    >>> table.attrs["units"]["mean_velocity"]
    'm/s'
    """
    if not hasattr(data, "data_vars") or not {"status", "events"} <= {*data.data_vars}:
        refuse("data", data, "what sweep gave")
    status = data["status"]
    columns: dict[str, Any] = {}
    units: dict[str, str] = {}

    def add(name: str, values: xarray.DataArray) -> None:
        columns[name] = values.broadcast_like(status).transpose(*status.dims).values.ravel()
        units[name] = str(values.attrs.get("units", ""))

    for name, coordinate in status.coords.items():
        if "key" in coordinate.attrs:
            add(str(name), coordinate)
    words = dict(
        zip(status.attrs["flag_values"], status.attrs["flag_meanings"].split(), strict=True)
    )
    columns["status"] = [words[code] for code in status.values.ravel()]
    units["status"] = ""
    for name, values in data.data_vars.items():
        if name not in ("status", "events"):
            add(str(name), values)
    for kind in data["event"].values.tolist():
        add(f"events_{kind}", data["events"].sel(event=kind))
    table = pd.DataFrame(columns)
    table.attrs["units"] = units
    return table
