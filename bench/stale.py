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
