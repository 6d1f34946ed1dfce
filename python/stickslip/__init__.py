"""Stick-slip locomotion of magnetic micro-robots in the field of five square coils.

The public names below are imported on first use, so that ``import stickslip`` stays quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip._core import __version__
    from stickslip.coils import Coils

_HOME = {
    "__version__": "_core",
    "Coils": "coils",
}

__all__ = ["Coils", "__version__"]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'stickslip' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"stickslip.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
