"""Rows of a CSV file with the line that each stands on; every CSV file of a user is read here."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

from stickslip.errors import ScenarioError


def text_lines(data: bytes) -> Iterator[str]:
    """The lines of a text in UTF-8 without their ends, whatever these are, and without its mark.

    The mark is the byte order mark, which spreadsheets write before the first line. A
    ScenarioError names the first byte that is not UTF-8.
    """
    try:
        data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ScenarioError(f"is no text: byte {error.start + 1} is not UTF-8") from None
    # Lines as they are wanted: all of them together would take ten times the room of the bytes.
    with io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig") as file:
        for line in file:
            yield line.rstrip("\n")


def csv_rows(data: bytes) -> Iterator[tuple[int, list[str]]]:
    """Rows of cells without the spaces around them, each with the number of its line, from 1.

    Empty lines, and lines that begin with # after any spaces, are comments: they are skipped and
    counted. A ScenarioError, which does not name the file, says that it is no text in UTF-8, or
    that a quoted cell goes on in the next line, which would hide all lines below a stray quote.
    """
    taken: list[int] = []

    def kept() -> Iterator[str]:
        for number, line in enumerate(text_lines(data), start=1):
            if line.strip() and not line.lstrip().startswith("#"):
                taken.append(number)
                yield line

    try:
        for row in csv.reader(kept()):
            if len(taken) > 1:
                raise ScenarioError(
                    f"line {taken[0]}: a quoted cell goes over several lines; allowed is one line"
                )
            yield taken.pop(), [cell.strip() for cell in row]
    except csv.Error as error:
        raise ScenarioError(f"cannot be read: {error}") from None


def refuse_other_separators(header: list[str]) -> None:
    """A ScenarioError where what stands between the columns is no comma."""
    for separator, name in ((";", "semicolons"), ("\t", "tabs")):
        if len(header) == 1 and separator in header[0]:
            raise ScenarioError(f"columns are separated by {name}; allowed are commas")
