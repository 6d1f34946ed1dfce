"""TOML text; what the parser would need minutes for, or refuse without a reason, is refused."""

from __future__ import annotations

import re
import sys
from typing import Any

from stickslip.errors import ScenarioError
from stickslip.scenario.keys import known_keys, shown

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_DEEPEST = 16
"""Parts of a key, and tables or lists in each other; chosen: the formats need four."""

_PART = r"""(?:[A-Za-z0-9_-]+|"(?:\\.|[^"\\\n])*"|'[^'\n]*')"""
# Strings and comments are passed over as a whole, also those that never end, so that each character
# is looked at a bounded number of times.
_DEEP_KEY = re.compile(
    rf"""({_PART}(?:[ \t]*\.[ \t]*{_PART}){{{_DEEPEST}}})"""
    r"""|\"{3}(?:\\.|[^\\])*?(?:\"{3}|\Z)|'{3}.*?(?:'{3}|\Z)"""
    r"""|"(?:\\.|[^"\\\n])*|'[^'\n]*|\#[^\n]*|[A-Za-z0-9_-]+""",
    re.DOTALL,
)
_LONG_NUMBER = re.compile(r"[0-9_]{1000,}")
_SECTION = re.compile(r"^[ \t]*\[([^\[\]\n]+)\]", re.MULTILINE)
_WHOLE = range(-(2**63), 2**63)


def parse_toml(text: str) -> dict[str, Any]:
    """The document.

    A ScenarioError of one line says that the text is no TOML, a whole number has more than 64 bits,
    or keys, tables and lists are nested deeper than any format of this package.
    """
    # The parser's time grows with the square of a key's parts.
    deep = next((each for each in _DEEP_KEY.finditer(text) if each[1]), None)
    if deep is not None:
        raise _refused(text, deep.start(), f"a key of at most {_DEEPEST} parts")
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"is not valid TOML: {' '.join(str(error).split())}") from None
    except RecursionError:
        raise ScenarioError(f"is nested deeper than {_DEEPEST} tables and lists") from None
    except ValueError:  # Python converts no number of thousands of digits
        number = _LONG_NUMBER.search(text)
        start = number.start() if number else 0
        key = _key_at(text, start)
        raise _refused(text, start, _whole(key), key) from None
    _check("", document, _DEEPEST)
    return document


def _refused(text: str, place: int, allowed: str, key: str = "") -> ScenarioError:
    """The error of what stands at a place of the text, with its line."""
    number = text.count("\n", 0, place) + 1
    line = text.split("\n")[number - 1].strip()
    begin = line if len(line) <= 60 else f"{line[:57]}..."
    whose = f" for {key}" if key in known_keys() else ""
    return ScenarioError(f"line {number}, {begin}: allowed{whose} is {allowed}")


def _check(key: str, value: object, levels: int) -> None:
    """Refuse whole numbers that TOML does not have, and what is nested deeply."""
    if isinstance(value, dict | list):
        if not levels:
            raise ScenarioError(f"{key} is nested deeper than {_DEEPEST} tables and lists")
        for name, each in value.items() if isinstance(value, dict) else enumerate(value):
            _check(f"{key}.{name}" if key else str(name), each, levels - 1)
    elif isinstance(value, int) and value not in _WHOLE:
        raise ScenarioError(f"{key} = {shown(value)}: allowed is {_whole(key)}")


def _whole(key: str) -> str:
    """What is allowed in place of a whole number that is too large."""
    most = "a whole number of at most 64 bits, from -2^63 to 2^63 - 1"
    known = known_keys().get(key)
    return f"{known.allowed}; in TOML, {most}" if known else most


def _key_at(text: str, place: int) -> str:
    """The dotted key of the line with that place, as far as its text tells."""
    before = text[:place]
    name = before.rpartition("\n")[2].partition("=")[0].strip()
    sections = _SECTION.findall(before)
    return f"{sections[-1].strip()}.{name}" if sections else name
