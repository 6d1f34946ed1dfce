"""A part of the report."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.facts import Fact


@dataclass(frozen=True)
class ReportSection:
    """A figure, and what there is to say of it.

    Attributes
    ----------
    title : str
    picture : str
        PNG in base64, may be empty.
    lines : tuple of Fact
        What is said below it.
    numbers : dict
        For report.json.
    """

    title: str
    picture: str
    lines: tuple[Fact, ...]
    numbers: dict[str, object]
