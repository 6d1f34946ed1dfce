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


_WORDS_OF_A_VERDICT = ("name", "verdict", "cause")


def digest() -> str:
    """The first 12 hex digits of the SHA-256 of the golden verdicts without their sentences."""
    rows = [_figures(json.loads(line)) for line in VERDICTS.read_text().splitlines()]
    return hashlib.sha256(json.dumps(rows, sort_keys=True).encode()).hexdigest()[:12]


def _figures(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: each if key in _WORDS_OF_A_VERDICT else _figures(each)
                for key, each in value.items()}  # fmt: skip
    if isinstance(value, list):
        return [*map(_figures, value)]
    return None if isinstance(value, str) else value


def stale(rows: Iterable[Mapping[str, Any]]) -> list[str]:
    """The line that marks rows of another engine; none where all are of the present one.

    The golden verdicts of a row are its ``golden``, or that of its ``state``.
    """
    present, stated = digest(), [row.get("state", row).get("golden") for row in rows]
    old = sum(each != present for each in stated)
    if not old:
        return []
    whose = f"the golden verdicts of the present engine, {present}"
    return [f"stale: {old} of {len(stated)} rows do not state {whose}"]
