"""The option ``--set key=value``."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip.errors import ScenarioError
from stickslip.scenario.keys import FILE, PROGRAM, PROGRAM_HINT, Value, checked
from stickslip.scenario.scenario import Scenario
from stickslip.scenario.sections import refuse_sawtooth
from stickslip.scenario.toml_file import read_parts

QUOTES = ("'", '"')

_WITH_UNIT = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*[A-Za-zµμΩ%°][\w µμΩ%°/*^·-]*")


def split_setting(text: str) -> tuple[str, str]:
    """Key and text of ``key=value``.

    Raises
    ------
    ScenarioError
        If there is no ``=`` or no key.
    """
    key, equals, value = text.partition("=")
    key, value = key.strip(), value.strip()
    if not equals or not key:
        raise ScenarioError(f'--set "{text}": allowed is key=value, such as drive.frequency=30')
    return key, unquoted(value) if key == FILE else value


def parse_setting(text: str) -> tuple[str, Any]:
    """Key and value of ``key=value``; a value that reads as a number is one.

    Raises
    ------
    ScenarioError
        If there is no ``=`` or no key, or the value is a number with a unit or an open quote.
    """
    key, value = split_setting(text)
    if key == FILE:
        return PROGRAM, _waveform(value)
    if key == PROGRAM:
        raise ScenarioError(f"--set {key}: there is no such key; {PROGRAM_HINT}")
    try:
        return key, parse_value(value)
    except ScenarioError as error:
        raise ScenarioError(f"--set {key}: {error}") from None


def parse_value(text: str) -> Value:
    """A number if it reads as one, else a word, whose quotes can be left out.

    Raises
    ------
    ScenarioError
        If it is a number with a unit, or has a quote at one end only.
    """
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    with_unit = _WITH_UNIT.fullmatch(text)
    if with_unit is not None:
        raise ScenarioError(
            f"{text}: allowed is a number without its unit, in SI units: 2.5 mT is 2.5e-3"
        )
    return unquoted(text)


def unquoted(text: str) -> str:
    """A word without the quotes around it, which have to be a pair."""
    if text[:1] in QUOTES or text[-1:] in QUOTES:
        if len(text) < 2 or text[0] != text[-1]:
            raise ScenarioError(f"{text}: a quote has no partner")
        return text[1:-1]
    return text


def read_with(
    path: Path, settings: Sequence[str], vary: Mapping[str, Value] | None = None
) -> Scenario:
    """The scenario of a file with all ``--set`` options, the last of each key.

    `vary` has allowed values of ``--vary``, which come too. Voltages that are set take the place of
    the whole drive, but its direction. What the file has in place of a new value may be wrong.

    Raises
    ------
    ScenarioError
        If the file is no scenario, a key is unknown or a value not allowed.
    """
    changes = dict(parse_setting(text) for text in settings)
    if PROGRAM in changes:
        changes.setdefault("drive.mode", "program")
    elif changes.get("drive.mode", "program") != "program":
        changes[PROGRAM] = None
    try:
        for key, value in changes.items():
            if key != PROGRAM:
                checked(key, value)
    except ScenarioError as error:
        raise ScenarioError(f"--set: {error}") from None
    changes |= vary or {}
    parts = read_parts(path, changes)
    options = [name for name, given in (("--set", settings), ("--vary", vary)) if given]
    try:
        refuse_sawtooth(parts["drive"].mode, changes)
        return Scenario(**parts)
    except ScenarioError as error:
        where = f"{path} with {' and '.join(options)}" if options else path
        raise ScenarioError(f"{where}: {error}") from None


def _waveform(path: str) -> Any:
    from stickslip.scenario.waveform import Waveform

    try:
        return Waveform.from_csv(Path(path))
    except ScenarioError as error:
        raise ScenarioError(f"--set {FILE}: {error}") from None
