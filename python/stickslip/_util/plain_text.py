"""Text from a user's files, made safe for a terminal, an HTML page and a TOML file.

Names of keys, columns and files can hold characters that control a terminal, or end a comment.
"""

from __future__ import annotations

import json


def printable(text: object) -> str:
    """The text with escapes for all that is not shown: control characters, line ends, directions.

    A text that went through it once stays as it is.
    """
    text = str(text)
    if text.isprintable():
        return text
    return "".join(
        each if each.isprintable() else each.encode("unicode_escape").decode() for each in text
    )


def printable_lines(text: str) -> str:
    """The same, but for the ends of lines, which stay."""
    return "\n".join(map(printable, text.split("\n")))


def shortened(text: object, most: int = 60) -> str:
    """The printable text, without the end of what is longer than `most` characters.

    For figures, whose axes would have no place beside a longer name. Chosen: a pair of the
    library's causes is not longer.
    """
    text = printable(text)
    return text if len(text) <= most else f"{text[: most - 3]}..."


def quoted(text: str) -> str:
    """The text as a TOML string in double quotes.

    It has what JSON escapes, and the other control characters too: TOML has no bare DEL.
    """
    return "".join(
        each if each.isprintable() else f"\\U{ord(each):08x}"
        for each in json.dumps(text, ensure_ascii=False)
    )
