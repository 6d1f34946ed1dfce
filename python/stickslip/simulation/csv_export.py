"""A run as a CSV file."""

from __future__ import annotations

from os import PathLike
from typing import Any

import pandas as pd

from stickslip._util.atomic_files import replacing
from stickslip.scenario.sections import COIL_NAMES
from stickslip.simulation.run import WORDS, Run, recorded_columns


def write_csv(run: Run, path: str | PathLike[str]) -> None:
    """See `Run.to_csv`."""
    columns: dict[str, Any] = {}
    for name, column in recorded_columns(run).items():
        values = getattr(run, name)
        if name == "current":
            for place, coil in enumerate(COIL_NAMES):
                columns[f"current {coil} ({column.unit})"] = values[:, place]
        elif name in WORDS:
            columns[name] = pd.Categorical.from_codes(values, list(WORDS[name]))
        else:
            columns[f"{name} ({column.unit})"] = values
    with replacing(path) as temporary:
        pd.DataFrame(columns).to_csv(temporary, index=False)
