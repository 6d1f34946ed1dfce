"""Angles of a tumbling micro-robot as its page of the documentation has them, for the diagnosis."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import stickslip

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "tumbler.md"
_FILES = ("tumbler.csv", "nominal.toml", "measurement.toml")


def diagnose_tumbler(page: Path = PAGE) -> stickslip.Diagnosis:
    """The diagnosis of the page's measurement with the simulator and all of its causes."""
    text = page.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        for name in _FILES:
            found = re.search(rf"^```\w+\n# {re.escape(name)}\n(.*?)^```", text, re.M | re.S)
            if found is None:
                raise ValueError(f"{page}: there is no block {name}")
            (Path(folder) / name).write_text(found[1], encoding="utf-8")
        measured = stickslip.read_measurement(Path(folder) / "measurement.toml")
        return stickslip.diagnose(measured, threads=1)
