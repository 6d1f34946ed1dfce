"""JSON text. JSON has no infinity and no NaN."""

from __future__ import annotations

import json
import math
import re
from typing import Any

_UNUSUAL = re.compile(r"[^\n -~]")


def json_text(value: Any) -> str:
    """One JSON text; a number that is not finite is null.

    All characters that cannot be printed are escaped. JSON itself requires that of only half of the
    control characters, and the others, such as DEL, act on a terminal.
    """
    text = json.dumps(_finite(value), indent=2, allow_nan=False, ensure_ascii=False)
    return _UNUSUAL.sub(lambda each: _shown(each[0]), text)


def _shown(character: str) -> str:
    return character if character.isprintable() else json.dumps(character)[1:-1]


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
