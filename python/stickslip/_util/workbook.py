"""Excel workbooks as the lines of their sheet, which are read as those of a CSV file."""

from __future__ import annotations

import datetime
import io
import zipfile
from typing import Any

from stickslip._util.messages import shown
from stickslip.errors import ScenarioError
from stickslip.extras import naming_the_extra

_MOST = 1 << 29  # bytes that a workbook unpacks to; chosen: as the largest table of text


def is_workbook(data: bytes) -> bool:
    """Whether a file is an Excel workbook (.xlsx)."""
    if not data.startswith(b"PK\x03\x04"):
        return False
    try:
        return "xl/workbook.xml" in zipfile.ZipFile(io.BytesIO(data)).namelist()
    except zipfile.BadZipFile:
        return False


def sheet_text(data: bytes) -> bytes:
    """The only sheet of a workbook with data as lines with tabs; dates are as ISO 8601 has them.

    A ScenarioError names the sheets if several have data.
    """
    unpacked = sum(each.file_size for each in zipfile.ZipFile(io.BytesIO(data)).infolist())
    if unpacked > _MOST:
        raise ScenarioError(f"unpacks to {unpacked >> 20} MiB: allowed are {_MOST >> 20} MiB")
    with naming_the_extra("an Excel workbook"):
        import openpyxl
    try:
        book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True)
        sheets = {each.title: [*map(_line, each.iter_rows(values_only=True))]
                  for each in book.worksheets}  # fmt: skip
    except Exception as error:  # whatever a damaged one makes openpyxl raise
        raise ScenarioError(f"is a damaged Excel workbook: {error}") from None
    filled = [title for title, lines in sheets.items() if any(lines)]
    if len(filled) > 1:
        names = ", ".join(map(shown, filled))
        raise ScenarioError(f"sheets {names} have data: allowed is one; keep it in a file alone")
    return "\n".join(sheets[filled[0]] if filled else []).encode()


def _line(row: tuple[Any, ...]) -> str:
    cells = [_cell(value) for value in row]
    return "\t".join(cells) if any(cells) else ""


def _cell(value: Any) -> str:
    if isinstance(value, datetime.timedelta):  # as the format [h]:mm:ss has
        value = (datetime.datetime.min + value).time() if value.days == 0 else value
    if isinstance(value, bool | int | float):
        return repr(value)
    text = " ".join(str("" if value is None else value).split()).replace('"', '""')
    return f'"{text}"' if text else ""
