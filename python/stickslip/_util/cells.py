"""Cells of CSV files: the header, and the rows below it."""

from __future__ import annotations

import codecs
import csv
import io
import itertools
import math
import re
import textwrap
from collections.abc import Collection, Iterable, Iterator, Sequence

from stickslip._util.units import is_unit, split_unit
from stickslip.errors import ScenarioError

INSTRUMENTS_PAGE = "examples/read_instruments.py"
"""The page on tables from other programs."""

_OTHER_FORMATS = {
    b"PK\x03\x04": "a NumPy archive (.npz), a damaged workbook or another ZIP archive",
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

MOST_COLUMNS = 1000
"""Limit of a table. Chosen: far beyond what a laboratory has."""
_PREAMBLE = 50
"""Lines above a header at most. Chosen: loggers write twenty."""
_SEPARATOR_LINE = re.compile(r'"?sep=([,;|\t])"?[,; \t]*', re.IGNORECASE)
_QUOTED = re.compile('"[^"]*"')
_DECIMAL = re.compile(r"[+\u2212-]?(?=\d|[.,]\d)\d*([.,])\d*(?:[eEdD][+\u2212-]?\d+)?")
_THOUSANDS = re.compile(r"[+\u2212-]?[1-9]\d{0,2}(,\d{3})+")
_MARKS = {".": "point", ",": "comma"}

LARGEST = 1e60
"""Beyond every quantity of a laboratory, in any unit; its fourth power is still a number."""

LIMIT = re.compile(r"[<>≤≥]=?\s*[+-]?[\d.,]+(?:[eE][+-]?\d+)?")
"""A reading that is a limit, such as ``<25.0``: a gap."""

STAMP = re.compile(
    r"(?P<date>\d{4}[-/]\d\d[-/]\d\d[T ]\s*|\d{1,2}\.\d{1,2}\.\d{4}\s+)?"
    r"(?P<clock>\d{1,2}:\d\d(:\d\d)?([.,]\d+)?)(Z|(?P<zone>[+-]\d\d:?\d\d))?"
)
"""A date or a clock as ISO 8601 writes it, or a date such as 1.5.2026."""

_FORTRAN = re.compile(r"([+-]?[\d.]+)[dD]([+-]?\d+)")
_GAP = re.compile(
    r"|[-.\u2212\u2013\u2014]{1,6}|[+-]?(nan|inf|infinity)(\(\w*\))?|[+-]?1\.#(ind|inf|qnan|snan)0*|"
    r"#?n/?a|null|none|nil|nat|<na>|\?+|err|error|fault|fail|failed|invalid|missing|bad|"
    r"lost|open|no[ _]?(data|reading|value)|"
    r"[+-]?(ol|ovl|ovld|over|overflow|overload|overrange|under|underflow|underrange)|"
    r"#(div/0|value|num|ref|name\?|null)!?",
    re.IGNORECASE,
)
"""An empty cell, and what spreadsheets, programs and meters write where they have no reading."""


def number(cell: str) -> float | None:
    """The number of a cell, NaN if it is a gap, or None if it is neither.

    Every reader of tables takes its cells here. A minus may be U+2212, an exponent Fortran's D, and
    True and False are 1 and 0.
    """
    try:
        value = float(cell)
    except ValueError:
        pass
    else:  # Python reads 1_000 as a number; no laboratory writes it.
        if abs(value) < LARGEST and "_" not in cell:
            return value
    if _GAP.fullmatch(cell) or LIMIT.fullmatch(cell):
        return math.nan
    if cell.casefold() in ("true", "false"):
        return float(cell.casefold() == "true")
    usual = _FORTRAN.sub(r"\1e\2", cell.replace("\u2212", "-"))
    return None if usual == cell else number(usual)


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
        at, what = data.find(b"\0"), "NUL"
    except UnicodeDecodeError as error:
        at, what = error.start, "not UTF-8"
    if at >= 0:
        wide = " (UTF-16 without its mark?)" if what == "NUL" and at < 2 else ""
        raise ScenarioError(f"is not text: byte {at + 1} is {what}{wide}; save it as CSV in UTF-8")
    # Lines as they are wanted: all of them together would take ten times the room of the bytes.
    with io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig") as file:
        for line in file:
            yield line.rstrip("\n")


class CsvTable:
    """The header of a CSV file and, by `rows`, what is below it.

    Commas, semicolons or tabs separate cells; a first line ``sep=;`` says which. The header is that
    of fifty lines which names the most of `columns`, else the last one above rows of as many
    numbers and below none, else the first without a #, or a comment above it. A row of units may
    follow.

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
        Headings as they stand there with their units, "" for a column without one.
    separator : str
    above : int
        Lines above the header that are no comments.
    comments, beyond : int
        Comments below the header, and empty columns beyond it, as far as `rows` has come.

    Raises
    ------
    ScenarioError
        Without the file's name, if the file is no text, blanks separate the columns, or a quoted
        cell goes on in the next line, which would hide all lines below a stray quote.
    """

    def __init__(self, data: bytes, columns: Collection[str]) -> None:
        self.line, self.header, self.separator = 0, list[str](), ","
        self.comments = self.beyond = self.above = 0
        self._mark: tuple[str, str, int] | None = None
        # By column, the first cell that may have thousands, and the first without any mark.
        self._thousands, self._bare = dict[int, tuple[int, str]](), dict[int, tuple[int, str]]()
        self._decimals = False
        self._rows: Iterator[tuple[int, list[str]]] = iter(())
        lines = enumerate(text_lines(data), start=1)
        comments, stated = [], None
        for at, line in lines:
            if at == 1 and (stated := _SEPARATOR_LINE.fullmatch(line)):
                continue
            if line.lstrip().startswith("#"):
                comments.append((at, line))
            elif line.strip():
                break
        else:
            return
        near = [(at, line), *itertools.islice(lines, _PREAMBLE)]
        k = self._place_of_names([line for _, line in near], columns, stated and stated[1])
        self.separator = stated[1] if stated else _separator_of(near[k][1])
        self.above = sum(bool(line.strip()) for _, line in near[:k])
        is_row = any(map(_is_number, self._cells(near[k][1])))
        above = self._take_header(comments, columns, near[k][1]) if is_row else []
        self._rows = self._parsed(itertools.chain(above, near[k:], lines))
        if not self.line:
            self.line, self.header = next(self._rows)
        if len(self.header) <= MOST_COLUMNS:  # else it is refused, see `columns`
            self._take_units()
        if len(self.header) == 1 and " " in split_unit(self.header[0])[0]:
            names = textwrap.shorten(self.header[0], 60, placeholder=" ...")
            raise ScenarioError(
                f'line {self.line}: "{names}" has no comma, semicolon or tab between '
                "names of columns; blanks do not separate columns; write commas "
                '(numpy.savetxt with delimiter=",")'
            )

    def _place_of_names(
        self, lines: list[str], columns: Collection[str], separator: str | None
    ) -> int:
        """Place of the line of names, which may be below others, as loggers write."""
        known = {name.casefold() for name in columns}
        best = (0, 0, 0)
        for k, line in enumerate(lines):
            self.separator = separator or _separator_of(line)
            cells = [] if line.lstrip().startswith("#") else self._cells(line)
            named = sum(split_unit(cell)[0].casefold() in known for cell in cells[:MOST_COLUMNS])
            if named and (k == 0 or (len(cells) > 1 and not any(map(_is_number, cells)))):
                best = max(best, (named, len(cells), -k))
        if best[0]:
            return -best[2]
        rows = [(k, self._cells(line)) for k, line in enumerate(lines) if line.strip()]
        last, width = rows[-1][0], len(rows[-1][1])
        above = itertools.dropwhile(lambda row: any(map(_is_number, row[1])), reversed(rows))
        names = [(k, cells) for k, cells in itertools.islice(above, 2)
                 if len(cells) == width > 1]  # fmt: skip
        if not names or names[0][0] == last or any(map(_is_number, names[0][1])):
            return 0
        # Names below as many numbers are of a logger that began anew: the first names count.
        if any(len(cells) == width and all(map(_is_number, cells))
               for k, cells in rows if k < names[0][0]):  # fmt: skip
            return 0
        units = len(names) > 1 and any(map(is_unit, self._bare_units(names[0][1])))
        return names[units][0]

    @staticmethod
    def _bare_units(cells: list[str]) -> list[str]:
        """Cells without brackets, and without what Campbell's loggers write of time and number."""
        return ["" if cell in ("TS", "RN") else cell.strip("()[] ") for cell in cells]

    def _take_header(
        self, comments: list[tuple[int, str]], columns: Collection[str], first: str
    ) -> list[tuple[int, str]]:
        """Make the last comment that names columns of the first row the header; those below it."""
        ends = f"{self.separator} "
        count = len(self._cells(first.rstrip(ends)))
        spelled = {name.casefold() for name in columns}
        for k in reversed(range(len(comments))):
            at, line = comments[k]
            names = self._cells(line.lstrip().lstrip("#").rstrip(ends))
            known = any(split_unit(name)[0].casefold() in spelled for name in names)
            if known and len(names) == count and not any(map(_is_number, names)):
                self.line, self.header = at, names
                return comments[k + 1 :]
        return []

    def _take_units(self) -> None:
        """Join a row of units below the names with them."""
        below = list(itertools.islice(self._rows, 2))
        units = self._bare_units(below[0][1]) if below else []
        if any(map(is_unit, units)) and not any(each != "1" and _is_number(each) for each in units):
            pairs = itertools.zip_longest(self.header, units, fillvalue="")
            self.header = [
                f"{name} ({unit})" if unit and split_unit(name)[1] is None else name
                for name, unit in pairs
            ]
            # Below them such a logger says how each was made: Smp, Avg.
            made = "TS" in below[0][1] and not any(map(_is_number, below[-1][1]))
            below = below[2 if made else 1 :]
        self._rows = itertools.chain(below, self._rows)

    def rows(self) -> Iterator[tuple[int, list[str], int]]:
        """Line, cells and 0 of each row that has a cell, or how many, if too many or too few.

        Their cells are empty here. A line that begins with # is a row if it has as many cells as
        the header, else a comment.
        """
        width = len(self.header)
        for at, row in self._rows:
            if any(row):
                fits = len(fitted := self._fitted(row)) == width
                yield at, fitted if fits else [""] * width, 0 if fits else len(fitted)

    def pointed(self, column: int, lines: Sequence[int], given: Sequence[str]) -> Sequence[str]:
        """The cells of numbers of a column, whose decimal commas are decimal points.

        A ScenarioError if an earlier cell has the other one: either may separate thousands.
        """
        if self.separator == ",":
            return given
        cells = list(given)
        for k, (line, cell) in enumerate(zip(lines, given, strict=True)):
            decimal = _DECIMAL.fullmatch(cell)
            if decimal is None:
                if cell.isdigit():
                    self._bare.setdefault(column, (line, cell))
                continue
            if _THOUSANDS.fullmatch(cell):
                self._thousands.setdefault(column, (line, cell))
            else:
                self._decimals = True
            mark, other, at = self._mark = self._mark or (decimal[1], cell, line)
            if mark != decimal[1]:
                raise ScenarioError(
                    f'line {line}: "{cell}" has a decimal {_MARKS[decimal[1]]} and "{other}" in '
                    f"line {at} a decimal {_MARKS[mark]}; allowed is one of them, and no "
                    "separators of thousands"
                )
            cells[k] = cell.replace(",", ".")
        return cells

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
            for at, line in lines:
                text = line.lstrip()
                if not text:
                    continue
                if text[0] == "#" and len(self._fitted(self._cells(line))) != len(self.header):
                    self.comments += 1
                    continue
                taken.append(at)
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


def _is_number(cell: str) -> bool:
    value = number(cell.replace(",", "."))
    return value is not None and not math.isnan(value)


def _separator_of(line: str) -> str:
    """The separator of a line's cells: a semicolon if there is one, else a tab, else a comma."""
    bare = _QUOTED.sub("", line)
    if ";" in bare:
        return ";"
    # Tabs beside commas only align them.
    return "\t" if "\t" in re.sub(r"\s*,\s*", ",", bare.strip(" ")) else ","
