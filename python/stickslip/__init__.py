"""Stick-slip locomotion of magnetic micro-robots in the field of five square coils.

The public names, which ``__init__.pyi`` lists, are imported on first use, so that ``import
stickslip`` stays quick.
"""

from __future__ import annotations

import importlib

# The stub is the one list of names: type checkers read it, and no computed one.
with open(f"{__file__}i", encoding="utf-8") as _stub:
    _HOMES = {words[3]: words[1] for words in map(str.split, _stub) if words and words[0] == "from"}

# No module may have the name of a function here: importing it would put it in the function's place.
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'stickslip' has no attribute {name!r}")
    from stickslip._util.extras import check_extras

    check_extras(f"stickslip.{name}", name)
    home = importlib.import_module(_HOMES[name])
    if name in vars(home):
        value = vars(home)[name]
    else:  # a module
        value = importlib.import_module(f"{_HOMES[name]}.{name}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
