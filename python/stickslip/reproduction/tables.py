"""Tables of numbers and words whose columns have units."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any

import pandas as pd

from stickslip._util.files import replacing


def table(columns: Mapping[str, Any], units: Mapping[str, str]) -> pd.DataFrame:
    """Columns by name; the attribute "units" has the SI unit of each, "1" for a pure number, and
    "" for words."""
    frame = pd.DataFrame(columns)
    frame.attrs["units"] = {name: units[name] for name in frame}
    return frame


def headings(frame: pd.DataFrame) -> list[str]:
    """The names of the columns with their units."""
    units = frame.attrs["units"]
    return [f"{name} ({units[name]})" if units[name] not in ("", "1") else name for name in frame]


def write_table(frame: pd.DataFrame, path: str | PathLike[str]) -> None:
    """Write a CSV file, whole or not at all; what is not known is an empty cell."""
    with replacing(path) as temporary:
        frame.to_csv(temporary, index=False, header=headings(frame))
