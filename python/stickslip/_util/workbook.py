"""Excel workbooks as the lines of their sheet, which are read as those of a CSV file."""

from __future__ import annotations

import importlib
import io
import zipfile

from stickslip._util.messages import shown
from stickslip.errors import ScenarioError
from stickslip.extras import naming_the_extra

_MOST = 1 << 29  # bytes that a workbook unpacks to; chosen: as the largest table of text


def sheet_text(data: bytes) -> bytes:
    """Return the only sheet of a workbook with data as lines with tabs; other data as they are.

    A ScenarioError says that it is damaged, unpacks to too much, or has data in several sheets.
    """
    try:
        parts = zipfile.ZipFile(io.BytesIO(data)).infolist() if data[:2] == b"PK" else []
    except zipfile.BadZipFile:
        return data
    if "xl/workbook.xml" not in [part.filename for part in parts]:
        return data
    unpacked = sum(part.file_size for part in parts)
    if unpacked > _MOST:
        raise ScenarioError(f"unpacks to {unpacked >> 20} MiB: allowed are {_MOST >> 20} MiB")
    with naming_the_extra("an Excel workbook"):
        pandas = importlib.import_module("pandas")
        importlib.import_module("openpyxl")
    how = {"sheet_name": None, "header": None, "dtype": object, "na_filter": False}
    try:
        sheets = pandas.read_excel(io.BytesIO(data), engine="openpyxl", **how)
    except Exception as error:  # whatever a damaged one makes openpyxl raise
        raise ScenarioError(f"is a damaged Excel workbook: {error}") from None
    filled = {name: sheet for name, sheet in sheets.items() if not sheet.empty}
    if len(filled) > 1:
        names = ", ".join(map(shown, filled))
        raise ScenarioError(f"sheets {names} have data: allowed is one; keep it in a file alone")
    lines = (sheet.replace(r"\s+", " ", regex=True) for sheet in filled.values())
    return "".join(each.to_csv(sep="\t", header=False, index=False) for each in lines).encode()
