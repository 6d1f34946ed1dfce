"""JSON, which knows no infinity and no NaN."""

from __future__ import annotations

import json
import math
from typing import Any


def json_text(value: Any) -> str:
    """One JSON text; a number that is not finite is null."""
    return json.dumps(_finite(value), indent=2, allow_nan=False, ensure_ascii=False)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
