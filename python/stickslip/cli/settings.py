"""The option ``--set key=value``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stickslip.errors import ScenarioError
from stickslip.keys import Value
from stickslip.scenario import Scenario
from stickslip.sections import PROGRAM

FILE = "drive.file"


def parse_setting(text: str) -> tuple[str, Any]:
    """Key and value of ``key=value``; a value that reads as a number is one.

    Raises
    ------
    ScenarioError
        If there is no ``=`` or no key.
    """
    key, equals, value = text.partition("=")
    key, value = key.strip(), value.strip()
    if not equals or not key:
        raise ScenarioError(f'--set "{text}": allowed is key=value, such as drive.frequency=30')
    if key == FILE:
        return PROGRAM, _waveform(value)
    return key, parse_value(value)


def parse_value(text: str) -> Value:
    """A number if it reads as one, else a word, whose quotes can be left out."""
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    return text.strip("\"'")


def with_settings(scenario: Scenario, settings: tuple[str, ...]) -> Scenario:
    """The scenario with all ``--set`` options, the last of each key.

    Raises
    ------
    ScenarioError
        If a key is unknown or a value not allowed.
    """
    if not settings:
        return scenario
    changes = dict(parse_setting(text) for text in settings)
    if PROGRAM in changes:
        changes.setdefault("drive.mode", "program")
    elif changes.get("drive.mode", "program") != "program":
        changes[PROGRAM] = None
    try:
        return scenario.replace(changes)
    except ScenarioError as error:
        raise ScenarioError(f"--set: {error}") from None


def _waveform(path: str) -> Any:
    from stickslip.waveform import Waveform

    try:
        return Waveform.from_csv(Path(path))
    except ScenarioError as error:
        raise ScenarioError(f"--set {FILE}: {error}") from None
