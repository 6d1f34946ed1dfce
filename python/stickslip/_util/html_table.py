"""What notebooks show of objects: small tables of two columns, and texts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from html import escape

from stickslip._util.plain_text import printable


def html_table(title: str, rows: Sequence[tuple[str, str]]) -> str:
    """A title with a row for each name and value; all texts are escaped.

    It has no style of its own but where the text stands, and so fits light and dark notebooks.
    """
    left = ' style="text-align: left"'
    lines = [
        f"<tr><th{left}>{_text(name)}</th><td{left}>{_text(value)}</td></tr>"
        for name, value in rows
    ]
    caption = f'<caption style="text-align: left"><b>{_text(title)}</b></caption>'
    return "\n".join(["<table>", caption, *lines, "</table>"])


class ShownBySummary(ABC):
    """What has a `summary` of text, which a notebook shows with its line ends, escaped."""

    @abstractmethod
    def summary(self) -> str:
        """The text."""

    def _repr_html_(self) -> str:
        shown = "\n".join(map(_text, self.summary().split("\n")))
        return f'<pre style="white-space: pre-wrap">{shown}</pre>'


def _text(value: str) -> str:
    return escape(printable(value))
