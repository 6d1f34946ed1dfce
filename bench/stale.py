"""Whether stored figures of the diagnosis are those of the present engine.

Each row states the golden verdicts of the engine that made it. Where they are others now, or none
are stated, the command that shows the rows says so.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

VERDICTS = Path(__file__).resolve().parents[1] / "tests" / "frozen" / "verdicts.jsonl"


SOURCES = "diagnosis", "models", "machines", "walker"
"""Folders of the package whose code is the engine of a diagnosis."""


def code() -> str:
    """The first 12 hex digits of the SHA-256 of the engine's sources in Python."""
    package, found = VERDICTS.parents[2] / "python" / "stickslip", hashlib.sha256()
    for path in sorted(path for each in SOURCES for path in (package / each).rglob("*.py")):
        found.update(path.read_bytes())
    return found.hexdigest()[:12]


def digest() -> str:
    """The first 12 hex digits of the SHA-256 of the golden problems, their verdicts and causes.

    Counts of names follow these; a figure beside them may move by what rounding or a slope is.
    """
    rows = [json.loads(line) for line in VERDICTS.read_text().splitlines()]
    said = [(row["name"], row.get("numbers", {})) for row in rows]
    words = [[name, numbers.get("verdict"), numbers.get("cause")] for name, numbers in said]
    return hashlib.sha256(json.dumps(words).encode()).hexdigest()[:12]


def stale(rows: Iterable[Mapping[str, Any]]) -> list[str]:
    """The line that marks rows of another engine; none where all are of the present one.

    The golden verdicts of a row are its ``golden``, or that of its ``engine``.
    """
    present, stated = digest(), [row.get("engine", row).get("golden") for row in rows]
    old = sum(each != present for each in stated)
    if not old:
        return []
    whose = f"the golden verdicts of the present engine, {present}"
    return [f"stale: {old} of {len(stated)} rows do not state {whose}"]
