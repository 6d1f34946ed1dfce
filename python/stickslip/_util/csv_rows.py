"""CSV files as text: separators, comments, the header, and rows with their lines.

Every CSV file of a user is read here.
"""

from __future__ import annotations

import codecs
import csv
import io
import itertools
import re
import textwrap
from collections.abc import Collection, Iterable, Iterator

from stickslip._util.units import split_unit
from stickslip.errors import ScenarioError

INSTRUMENTS_PAGE = "examples/read_instruments.py"
"""The page on tables from other programs."""

DECIMAL_COMMAS = (
    "if these are decimal commas, separate the columns by semicolons or write decimal points; "
    "else every column needs a name"
)
"""Advice for a row with more cells than the header, between commas."""

_OTHER_FORMATS = {
    b"PK\x03\x04": "an Excel workbook (.xlsx) or another ZIP archive",
    b"\xd0\xcf\x11\xe0": "an Excel workbook (.xls)",
    b"MATLAB 5.0": "a MATLAB file (.mat)",
    b"\x89HDF": "an HDF5 file, such as a MATLAB 7.3 file (.mat) or netCDF",
    b"<?xml": "an XML file, such as a TrackMate export",
    b"<html": "an HTML page",
    b"<!DOCTYPE": "an HTML page",
    b"\x1f\x8b": "a gzip archive",
    b"BZh": "a bzip2 archive",
    b"\xfd7zXZ": "an xz archive",
    b"\x28\xb5\x2f\xfd": "a Zstandard archive",
    b"LabVIEW Measurement": "a LabVIEW measurement file (.lvm)",
    b"{": "JSON",
    b"[{": "JSON",
    b"[[": "JSON",
}
"""First bytes of files that users take for tables."""

_SEPARATOR_LINE = re.compile(r'"?sep=([,;|\t])"?[,; \t]*', re.IGNORECASE)
_QUOTED = re.compile('"[^"]*"')
_DECIMAL = re.compile(r"[+-]?(?=\d|[.,]\d)\d*([.,])\d*(?:[eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
_MARKS = {".": "point", ",": "comma"}


def text_lines(data: bytes) -> Iterator[str]:
    """The lines of a text without their ends and without its byte order mark.

    With the mark of UTF-16 it is decoded as such. A ScenarioError names the first byte that is not
    UTF-8, or the format of a file that is no text.
    """
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        try:
            data = data.decode("utf-16").encode()
        except UnicodeError:
            raise ScenarioError("is damaged UTF-16; save it as CSV in UTF-8") from None
    start = data[:256].removeprefix(codecs.BOM_UTF8).lstrip()
    for signature, name in _OTHER_FORMATS.items():
        if start[: len(signature)].lower() == signature.lower():
            raise ScenarioError(f"is {name}, not CSV; export it as CSV, see {INSTRUMENTS_PAGE}")
    try:
        data.decode("utf-8")
        wrong, what = data.find(b"\0"), "NUL"
    except UnicodeDecodeError as error:
        wrong, what = error.start, "not UTF-8"
    if wrong >= 0:
        wide = " (UTF-16 without its mark?)" if what == "NUL" and wrong < 2 else ""
        said = f"is not text: byte {wrong + 1} is {what}{wide}"
        raise ScenarioError(f"{said}; save it as CSV in UTF-8")
    # Lines as they are wanted: all of them together would take ten times the room of the bytes.
    with io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig") as file:
        for line in file:
            yield line.rstrip("\n")


def csv_line(line: str, cells: list[str]) -> str:
    """A line of these cells between commas; the given one if it has just these."""
    if [cell.strip() for cell in next(_reader([line], ","), [])] == cells:
        return line
    file = io.StringIO()
    csv.writer(file, lineterminator="").writerow(cells)
    return file.getvalue()


class CsvTable:
    """The header of a CSV file and, by `rows`, the rows below it.

    Commas, semicolons or tabs separate the cells; a first line such as ``sep=;`` says which. Lines
    above the header that begin with # are comments. If the first other line has a number, the
    header is the last of them that has as many cells, names one of `columns` and has no number, as
    `numpy.savetxt` writes it.

    Parameters
    ----------
    data : bytes
    columns : collection of str
        Names that a column may have.

    Attributes
    ----------
    line : int
        Line of the header, from 1; 0 in a file without.
    header : list of str
        Names of the columns as they stand there, "" for a column without one.
    separator : str
    comments : int
        Comments below the header, as far as `rows` has come.
    beyond : int
        Empty columns beyond the header, the same.

    Raises
    ------
    ScenarioError
        Without the file's name, if the file is no text, blanks separate the columns, or a quoted
        cell goes on in the next line, which would hide all lines below a stray quote.
    """

    def __init__(self, data: bytes, columns: Collection[str]) -> None:
        self.line, self.header, self.separator = 0, list[str](), ","
        self.comments = self.beyond = 0
        self._mark: tuple[str, str, int] | None = None
        # By column, the first cell that may have thousands, and the first without any mark.
        self._thousands, self._bare = dict[int, tuple[int, str]](), dict[int, tuple[int, str]]()
        self._decimals = False
        self._rows: Iterator[tuple[int, list[str]]] = iter(())
        lines = enumerate(text_lines(data), start=1)
        comments = []
        stated = None
        for number, line in lines:
            if number == 1 and (stated := _SEPARATOR_LINE.fullmatch(line)):
                continue
            if line.lstrip().startswith("#"):
                comments.append((number, line))
            elif line.strip():
                break
        else:
            return
        self.separator = stated[1] if stated else _separator_of(line)
        self._rows = self._parsed(itertools.chain([(number, line)], lines))
        if any(map(_is_number, self._cells(line))):
            self._take_header(comments, columns, (number, line), lines)
        if not self.line:
            self.line, self.header = next(self._rows)
        if len(self.header) == 1 and " " in split_unit(self.header[0])[0]:
            names = textwrap.shorten(self.header[0], 60, placeholder=" ...")
            raise ScenarioError(
                f'line {self.line}: "{names}" has no comma, semicolon or tab between '
                "names of columns; blanks do not separate columns; write commas "
                '(numpy.savetxt with delimiter=",")'
            )

    def _take_header(
        self,
        comments: list[tuple[int, str]],
        columns: Collection[str],
        first: tuple[int, str],
        below: Iterator[tuple[int, str]],
    ) -> None:
        """Make the last comment that names columns of the first row the header, if there is one."""
        count = len(named_cells(self._cells(first[1])))
        for k in reversed(range(len(comments))):
            number, line = comments[k]
            names = named_cells(self._cells(line.lstrip().lstrip("#")))
            known = any(split_unit(name)[0] in columns for name in names)
            if known and len(names) == count and not any(map(_is_number, names)):
                self.line, self.header = number, names
                self._rows = self._parsed(itertools.chain(comments[k + 1 :], [first], below))
                return

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line and cells of each row that has any, without the spaces around the cells.

        A line that begins with # is a row if it has as many cells as the header, else a comment.
        """
        width = len(self.header)
        for number, row in self._rows:
            if not any(row):
                continue
            if len(row) != width:
                row = self._fitted(row)
            yield number, row

    def with_point(self, line: int, column: int, cell: str) -> str:
        """A cell of numbers whose decimal comma, if it has one, is a decimal point.

        A ScenarioError if an earlier cell has the other one: either may separate thousands.
        """
        found = None if self.separator == "," else _DECIMAL.fullmatch(cell)
        if found is None:
            if cell.isdigit():
                self._bare.setdefault(column, (line, cell))
            return cell
        if _THOUSANDS.fullmatch(cell):
            self._thousands.setdefault(column, (line, cell))
        else:
            self._decimals = True
        mark, other, at = self._mark = self._mark or (found[1], cell, line)
        if mark != found[1]:
            raise ScenarioError(
                f'line {line}: "{cell}" has a decimal {_MARKS[found[1]]} and "{other}" in line '
                f"{at} a decimal {_MARKS[mark]}; allowed is one of them, and no separators of "
                "thousands"
            )
        return cell.replace(",", ".")

    def check_thousands(self) -> None:
        """Refuse, once all cells are read, commas that separate thousands as well as decimals."""
        for column, (line, cell) in self._thousands.items():
            if column in self._bare and not self._decimals:
                at, bare = self._bare[column]
                raise ScenarioError(
                    f'line {line}: "{cell}" may be {cell.replace(",", "")} or '
                    f'{cell.replace(",", ".", 1)}, as "{bare}" in line {at} has no comma; write '
                    "numbers without separators of thousands"
                )

    def _parsed(self, lines: Iterator[tuple[int, str]]) -> Iterator[tuple[int, list[str]]]:
        taken: list[int] = []

        def kept() -> Iterator[str]:
            for number, line in lines:
                text = line.lstrip()
                if not text:
                    continue
                if text[0] == "#" and len(self._fitted(self._cells(line))) != len(self.header):
                    self.comments += 1
                    continue
                taken.append(number)
                yield line

        try:
            for row in _reader(kept(), self.separator):
                if len(taken) > 1:
                    raise ScenarioError(
                        f"line {taken[0]}: a quoted cell goes over several lines; allowed is one "
                        "line"
                    )
                yield taken.pop(), [cell.strip() for cell in row]
        except csv.Error as error:
            raise ScenarioError(f"cannot be read: {error}") from None

    def _cells(self, line: str) -> list[str]:
        """The cells of a line by itself; a line that is too long for them is one cell."""
        try:
            return [cell.strip() for cell in next(_reader([line], self.separator))]
        except csv.Error:
            return [line]

    def _fitted(self, row: list[str]) -> list[str]:
        """A row with as many cells as the header, if only empty ones are too many or missing."""
        width = len(self.header)
        if len(row) > width and not any(row[width:]):
            self.beyond = max(self.beyond, len(row) - width)
            return row[:width]
        if len(row) < width and not any(self.header[len(row) :]):
            return row + [""] * (width - len(row))
        return row


def _reader(lines: Iterable[str], separator: str) -> Iterator[list[str]]:
    """Cells of lines; a quote counts after spaces too, as people write them behind commas."""
    return csv.reader(lines, delimiter=separator, skipinitialspace=True)


def named_cells(cells: list[str]) -> list[str]:
    """Cells without the empty ones at the end."""
    while cells and not cells[-1]:
        cells = cells[:-1]
    return cells


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _separator_of(line: str) -> str:
    """The separator of a line's cells: commas, unless there is another one."""
    bare = _QUOTED.sub("", line)
    if ";" in bare:
        return ";"
    # Tabs beside commas only align them.
    return "\t" if "\t" in re.sub(r"\s*,\s*", ",", bare.strip(" ")) else ","
