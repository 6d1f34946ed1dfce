"""The option ``--vary key=start:stop:count`` or ``--vary key=a,b,c``."""

from __future__ import annotations

import math
from decimal import Decimal, InvalidOperation

from stickslip.cli.settings import parse_value
from stickslip.errors import ScenarioError
from stickslip.scenario.keys import Value
from stickslip.sweeping.points import MOST_POINTS

_ALLOWED = "allowed is key=start:stop:count or key=a,b,c, such as drive.frequency=5:200:40"


def parse_vary(texts: tuple[str, ...]) -> dict[str, list[Value]]:
    """Values by key, in the order given; each key once."""
    vary: dict[str, list[Value]] = {}
    for text in texts:
        key, equals, values = (part.strip() for part in text.partition("="))
        if not equals or not key:
            raise ScenarioError(f'--vary "{text}": {_ALLOWED}')
        if key in vary:
            raise ScenarioError(f'--vary "{text}": {key} is there twice')
        try:
            vary[key] = _range(values) if ":" in values else _list(values)
        except ScenarioError as error:
            raise ScenarioError(f'--vary "{text}": {error}') from None
    return vary


def _range(values: str) -> list[Value]:
    """Evenly spaced values with both ends."""
    parts = [part.strip() for part in values.split(":")]
    if len(parts) != 3:
        raise ScenarioError(_ALLOWED)
    start, stop, count = _number(parts[0]), _number(parts[1]), _count(parts[2])
    if count == 1 and start != stop:
        raise ScenarioError("one value cannot be both start and stop")
    if count > 1 and start == stop:
        raise ScenarioError("the range is empty, as start and stop are the same")
    # Decimals, so that 0.1:0.5:5 gives 0.3 and not the sum of rounded steps.
    step = (stop - start) / max(count - 1, 1)
    return [float(start + place * step) for place in range(count)]


def _number(text: str) -> Decimal:
    try:
        number = Decimal(text)
        if math.isfinite(float(number)):
            return number
    except (InvalidOperation, ValueError):
        pass
    raise ScenarioError("allowed as start and stop are finite numbers")


def _count(text: str) -> int:
    if text.isdecimal() and len(text) < 12 and 1 <= int(text) <= MOST_POINTS:
        return int(text)
    raise ScenarioError(f"allowed as count is a whole number from 1 to {MOST_POINTS}")


def _list(values: str) -> list[Value]:
    parts = [part.strip() for part in values.split(",")]
    if parts == [""]:
        raise ScenarioError("there is no value")
    if "" in parts:
        raise ScenarioError("a value beside a comma is missing")
    return [parse_value(part) for part in parts]
