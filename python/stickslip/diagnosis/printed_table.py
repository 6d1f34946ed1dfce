"""A pandas table that a person can read where it is printed."""

from __future__ import annotations

import pandas as pd

from stickslip.diagnosis.report.messages import four_digits


class PrintedTable(pd.DataFrame):  # type: ignore[misc]  # pandas has no types
    """A DataFrame that is printed with all its columns, however wide, and numbers to four digits.

    The values are whole, and what is taken of it is such a table too.
    """

    @property
    def _constructor(self) -> type[PrintedTable]:
        return PrintedTable

    def __repr__(self) -> str:
        most = pd.get_option("display.max_rows")
        return str(self.to_string(float_format=four_digits, max_rows=most))
