"""A part of the report."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ReportSection:
    """A figure, and what there is to say of it.

    Attributes
    ----------
    title : str
    picture : str
        PNG in base64, may be empty.
    lines : tuple of str
        Sentences below it.
    numbers : dict
        For report.json.
    """

    title: str
    picture: str
    lines: tuple[str, ...]
    numbers: dict[str, object]
