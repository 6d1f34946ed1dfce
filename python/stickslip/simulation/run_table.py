"""A run as a pandas table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip._util.extras import naming_the_extra
from stickslip.simulation.columns import WORDS, column_units
from stickslip.simulation.record_blocks import recorded_names

with naming_the_extra("Run.to_dataframe"):
    import pandas as pd

if TYPE_CHECKING:
    from stickslip.simulation.run import Run


def run_table(run: Run) -> pd.DataFrame:
    """See `Run.to_dataframe`."""
    columns: dict[str, Any] = {}
    units: dict[str, str] = {}
    for name in recorded_names(run.scenario) or ("t",):  # whose absence is the error
        values = getattr(run, name)
        own = column_units(name)
        units |= own
        if name in WORDS:
            columns[name] = pd.Categorical.from_codes(values, list(WORDS[name]))
        else:
            parts = values.T if values.ndim == 2 else [values]
            columns |= dict(zip(own, parts, strict=True))
    table = pd.DataFrame(columns)
    table.attrs["units"] = units
    return table
