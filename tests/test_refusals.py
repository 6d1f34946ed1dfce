"""Bad input of every kind: one line that names the place, the value and what is allowed.

Each module of `refusals` has a table of rows ``(name, function, error, words)``, where the function
is given an empty folder, or of rows ``(where, bad input, words)``, with ``WAYS``: for each `where`
a function that is given a folder and the bad input. A function raises the error, or returns what a
command printed of it.
"""

import datetime
import itertools
import math
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from stickslip import Scenario, ScenarioError
from stickslip._util.messages import shown
from stickslip.scenario.keys import known_keys
from stickslip.scenario.sections import SECTIONS

TABLES = [
    import_module(f"refusals.{path.stem}")
    for path in sorted((Path(__file__).parent / "refusals").glob("[a-z]*.py"))
]


def given(way, bad):
    """The function of a folder that `way` is with a bad input."""
    return lambda folder: way(folder, bad)


def cases():
    for table in TABLES:
        for number, (name, bad, *error, words) in enumerate(table.REFUSALS):
            way = bad if error else given(table.WAYS[name], bad)
            allowed = error[0] if error else (ValueError, TypeError)
            place = f"{table.__name__.rpartition('.')[2]}-{number}-{name}"
            yield pytest.param(way, allowed, words, id=place)


@pytest.mark.parametrize(("way", "error", "words"), list(cases()))
def test_bad_input_is_refused_in_one_line(tmp_path, way, error, words):
    try:
        message = way(tmp_path)
    except error as raised:
        message = str(raised)
        others = None if raised.__suppress_context__ else raised.__context__
    else:
        others = None
    assert others is None, "it shows two errors"
    assert isinstance(message, str), "it was taken"
    message = message.removesuffix("\n")
    assert message.isprintable()
    assert len(message) < 700
    for word in [words] if isinstance(words, str) else words:
        assert word in message, message


def test_every_way_is_tried():
    for table in TABLES:
        if hasattr(table, "WAYS"):
            assert {where for where, *_ in table.REFUSALS} == set(table.WAYS)


NO_VALUES = (
    *(math.nan, math.inf, -math.inf, 10**400, "1", "a\nb" * 1000),
    *(None, True, np.True_, [1.0], b"1", np.timedelta64(1, "s"), datetime.date(2008, 6, 25)),
)


@pytest.mark.parametrize("key", known_keys())
def test_every_key_refuses_what_is_no_value_of_it(key):
    known = known_keys()[key]
    beyond = [math.nextafter(known.low, -math.inf), math.nextafter(known.high, math.inf)]
    between = [known.low + 0.5] * (known.kind == "whole")
    words = [word.swapcase() for word in known.words]
    section = key.rpartition(".")[0]
    doors = [lambda value: Scenario().replace({key: value})]
    if section in SECTIONS:
        doors.append(lambda value: SECTIONS[section](**{known.field: value}))
    for value, door in itertools.product((*NO_VALUES, *beyond, *between, *words), doors):
        with pytest.raises(ScenarioError) as error:
            door(value)
        message = str(error.value)
        assert message.startswith(f"{key} = {shown(value)}: allowed is ")
        assert known.allowed in message
        assert message.isprintable()
        assert len(message) < 700
