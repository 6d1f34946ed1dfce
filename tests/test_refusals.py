"""Bad input of every kind: one line that names the place, the value and what is allowed.

Each module of `refusals` has a table ``REFUSALS``. Its rows are ``(where, bad input, words)``, and
``WAYS`` has for each `where` a function that is given a folder and the bad input, and raises the
error or returns what a command printed. Or they are ``(name, call, error, words)``, where `call` is
given a folder, and raises an error of that kind.
"""

from functools import partial
from importlib import import_module
from pathlib import Path

import pytest

TABLES = [
    import_module(f"refusals.{path.stem}")
    for path in sorted((Path(__file__).parent / "refusals").glob("[a-z]*.py"))
]


def cases():
    for table in TABLES:
        for number, (where, given, *error, words) in enumerate(table.REFUSALS):
            call = given if error else partial(way_of(table, where), bad=given)
            kind = error[0] if error else (ValueError, TypeError)
            name = f"{table.__name__.rpartition('.')[2]}-{where}-{number}"
            yield pytest.param(call, kind, words, id=name)


def way_of(table, where):
    return lambda folder, bad: table.WAYS[where](folder, bad)


@pytest.mark.parametrize(("call", "kind", "words"), cases())
def test_bad_input_is_refused_in_one_line(tmp_path, call, kind, words):
    try:
        message = call(tmp_path)
    except kind as error:
        message = str(error)
    assert isinstance(message, str), "it was taken"
    message = message.removesuffix("\n")
    assert message.isprintable()
    assert len(message) < 700
    for word in [words] if isinstance(words, str) else words:
        assert word in message, message


def test_every_way_is_tried():
    for table in TABLES:
        assert {where for where, *_ in table.REFUSALS} >= {*getattr(table, "WAYS", ())}
