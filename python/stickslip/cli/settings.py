"""The options ``--set key=value`` and ``--vary key=start:stop:count`` or ``key=a,b,c``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any, TypeVar

from stickslip.errors import ScenarioError, prefixed
from stickslip.field.field_map import FieldMap
from stickslip.scenario.keys import Value, checked, full_name, in_radians
from stickslip.scenario.path_keys import COIL_MAP, FILE, OBJECTS, PATHS, PROGRAM, PROGRAM_HINT
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import refuse_sawtooth
from stickslip.scenario.toml_file import read_parts, with_uncertain_of
from stickslip.scenario.waveform import Waveform
from stickslip.sweeping.points import MOST_POINTS, Points, grid

_T = TypeVar("_T")

_QUOTES = ("'", '"')

_WITH_UNIT = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*[A-Za-zµμΩ%°][\w µμΩ%°/*^·-]*")

_IN_DEGREES = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?:°|deg(?:rees?)?)")

_VARY = "allowed is key=start:stop:count or key=a,b,c, such as drive.frequency=5:200:40"


def split_setting(text: str) -> tuple[str, str]:
    """Key and text of ``key=value``; a ScenarioError if there is no ``=`` or no key."""
    key, equals, value = (part.strip() for part in text.partition("="))
    if not equals or not key:
        raise ScenarioError(f'--set "{text}": allowed is key=value, such as drive.frequency=30')
    return key, _unquoted(value) if key in PATHS else value


def parse_setting(text: str) -> tuple[str, Any]:
    """Key and value of ``key=value``; a value that reads as a number is one."""
    key, value = split_setting(text)
    if key == PROGRAM:
        raise ScenarioError(f"--set {key}: there is no such key; {PROGRAM_HINT}")
    with prefixed(f"--set {key}"):
        if key == FILE:
            return PROGRAM, Waveform.from_csv(Path(value))
        if key == COIL_MAP:
            return key, FieldMap.from_file(Path(value))
        return key, parse_value(value)


def parse_value(text: str) -> Value:
    """A number if it reads as one, else a word, whose quotes can be left out.

    A ScenarioError says that it is a number with a unit, or has a quote at one end only.
    """
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    angle = _IN_DEGREES.fullmatch(text)
    if angle is not None:
        raise ScenarioError(
            f"{text}: allowed is a number without its unit, in SI units: "
            f"{in_radians(float(angle[1]))}"
        )
    if _WITH_UNIT.fullmatch(text):
        raise ScenarioError(
            f"{text}: allowed is a number without its unit, in SI units: 2.5 mT is 2.5e-3"
        )
    return _unquoted(text)


def _unquoted(text: str) -> str:
    """A word without the quotes around it, which have to be a pair."""
    if text[:1] in _QUOTES or text[-1:] in _QUOTES:
        if len(text) < 2 or text[0] != text[-1]:
            raise ScenarioError(f"{text}: a quote has no partner")
        return text[1:-1]
    return text


def read_with(
    path: Path, settings: Sequence[str], vary: Mapping[str, Value] | None = None
) -> Scenario:
    """The scenario of a file with all ``--set`` options, the last of each key.

    `vary` has allowed values of ``--vary``, which are applied too. Voltages that are set replace
    the whole drive, but its direction. A value of the file that is replaced is not checked.
    """
    changes = dict(parse_setting(text) for text in settings)
    if PROGRAM in changes:
        changes.setdefault("drive.mode", "program")
    elif changes.get("drive.mode", "program") != "program":
        changes[PROGRAM] = None
    with prefixed("--set"):
        for key, value in changes.items():
            if key not in OBJECTS:
                checked(key, value)
        refuse_sawtooth(changes.get("drive.mode"), changes)
    changes |= vary or {}
    parts = read_parts(path, changes)
    options = [name for name, given in (("--set", settings), ("--vary", vary)) if given]
    with prefixed(f"{path} with {' and '.join(options)}" if options else path):
        refuse_sawtooth(parts["drive"].mode, changes)
        return Scenario(**parts)


def with_uncertain_file(scenario: Scenario, path: Path | None, settings: Sequence[str]) -> Scenario:
    """The scenario with what is uncertain in a file, if there is one.

    A ScenarioError names an option ``--set`` without influence: its key has a prior, or the file
    is a scenario whose own value takes its place.
    """
    made = scenario if path is None else with_uncertain_of(scenario, path)
    drawn = made.uncertain
    for key in (full_name(split_setting(text)[0]) for text in settings):
        if drawn is not None and key in drawn.priors:
            raise ScenarioError(f"--set {key}: has no influence, as its prior says where it lies")
        if drawn is not None and key in drawn.keys and made.get(key) != scenario.get(key):
            raise ScenarioError(f"--set {key}: has no influence, as {path} has its own value")
    return made


def by_key(
    option: str, texts: Sequence[str], allowed: str, parse: Callable[[str], _T]
) -> dict[str, _T]:
    """What `parse` makes of each ``key=text`` of an option, in the order given; each key once.

    `allowed` is the error of a text without a key or ``=``.
    """
    found: dict[str, _T] = {}
    for text in texts:
        key, equals, values = (part.strip() for part in text.partition("="))
        with prefixed(f'{option} "{text}"'):
            if not equals or not key:
                raise ScenarioError(allowed)
            if key in found:
                raise ScenarioError(f"{key} is there twice")
            found[key] = parse(values)
    return found


def parse_vary(texts: Sequence[str]) -> dict[str, list[Value]]:
    """Values of all ``--vary`` options by key."""
    return by_key("--vary", texts, _VARY, lambda text: (_range if ":" in text else _list)(text))


def _range(values: str) -> list[Value]:
    """Evenly spaced values with both ends."""
    parts = [part.strip() for part in values.split(":")]
    if len(parts) != 3:
        raise ScenarioError(_VARY)
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
    # The length is compared first: int() of very long texts is slow.
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


def swept_points(scenario: Path, vary: Sequence[str], settings: Sequence[str]) -> Points:
    """The grid of a file's scenario with all ``--set`` and ``--vary`` options."""
    values = parse_vary(vary)
    for key, _ in map(parse_setting, settings):
        if key in values:
            raise ScenarioError(f"{key}: allowed is either --set or --vary, not both")
    base = _base(scenario, settings, values)
    with prefixed("--vary"):
        return grid(base, values)


def _base(
    scenario: Path, settings: Sequence[str], values: Mapping[str, Sequence[Value]]
) -> Scenario:
    """What the points have in common; a value that is varied is the file's own, if it can be."""
    try:
        return read_with(scenario, settings)
    except ScenarioError:
        if not scenario.is_file():  # a pipe can be read once
            raise
        with prefixed("--vary"):
            grid(Scenario(), values)
        return read_with(scenario, settings, {key: each[0] for key, each in values.items()})
