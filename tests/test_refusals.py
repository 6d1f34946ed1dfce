"""Bad input of every kind: one line that names the place, the value and what is allowed.

Each module of `refusals` has a table, ``REFUSALS = [(where, bad input, words)]``, and ``WAYS``: for
each `where` a function that is given a folder and the bad input, and raises the error, or returns
what a command printed of it.
"""

from importlib import import_module
from pathlib import Path

import pytest

TABLES = [
    import_module(f"refusals.{path.stem}")
    for path in sorted((Path(__file__).parent / "refusals").glob("[a-z]*.py"))
]
CASES = [
    pytest.param(table.WAYS[where], bad, words, id=f"{table.__name__}-{where}-{number}")
    for table in TABLES
    for number, (where, bad, words) in enumerate(table.REFUSALS)
]


@pytest.mark.parametrize(("way", "bad", "words"), CASES)
def test_bad_input_is_refused_in_one_line(tmp_path, way, bad, words):
    try:
        message = way(tmp_path, bad)
    except (ValueError, TypeError) as error:
        message = str(error)
    assert message is not None, "it was taken"
    message = message.removesuffix("\n")
    assert message.isprintable()
    assert len(message) < 700
    for word in [words] if isinstance(words, str) else words:
        assert word in message, message


def test_every_way_is_tried():
    for table in TABLES:
        assert {where for where, *_ in table.REFUSALS} == set(table.WAYS)
