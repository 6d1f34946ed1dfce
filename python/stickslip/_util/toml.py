"""TOML that a person wrote, and tables of the package."""

from __future__ import annotations

import re
import sys
from importlib import resources
from typing import Any

from stickslip.errors import ScenarioError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


_TEXTS = re.compile(
    r'''"""(?:[^"\\]|\\.|"(?!""))*(?:""")?|"(?:[^"\\\n]|\\.)*"?'''
    r"""|'''.*?(?:'''|\Z)|'[^'\n]*'?|#[^\n]*""",
    re.DOTALL,
)  # strings and comments, also those without an end
_MOST_DOTS = 30  # of a key; chosen: far more than any has, and tomllib takes the square of its time


def parse_toml(text: str) -> dict[str, Any]:
    """The document of a TOML text; a ScenarioError of one line says that it is none."""
    if max(part.count(".") for part in re.split(r"[,=\n]", _TEXTS.sub("", text))) > _MOST_DOTS:
        raise ScenarioError("is not valid TOML: a key in it has no end")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        comma = re.search(r"(?m)^[ \t]*[\w.\"-]+[ \t]*=[ \t]*[-+]?\d+,\d", text)
        hint = "; a number has a decimal point" if comma else ""
        raise ScenarioError(f"is not valid TOML: {' '.join(str(error).split())}{hint}") from None
    except (RecursionError, ValueError):  # lists in lists, or a number of thousands of digits
        raise ScenarioError("is not valid TOML: a list or a number in it has no end") from None


def own_text(path: str) -> str:
    """A text file of the package, by its path in there."""
    return resources.files("stickslip").joinpath(path).read_text("utf-8")


def own_table(path: str) -> dict[str, Any]:
    """A table of the package, by its path in there."""
    return parse_toml(own_text(path))
