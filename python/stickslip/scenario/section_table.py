"""The sections of a scenario that are always there."""

from __future__ import annotations

import dataclasses
import functools
from typing import Any

from stickslip.errors import ScenarioError
from stickslip.scenario.keys import shown, suggestion
from stickslip.scenario.sections import (
    Coil,
    Contact,
    Drag,
    Drive,
    Environment,
    Record,
    Robot,
    Solver,
)
from stickslip.scenario.state import State

SECTIONS: dict[str, type[Any]] = {
    each._key: each
    for each in (Drive, Coil, Robot, Contact, Drag, Environment, State, Solver, Record)
}
"""Their classes by name, in the order of a file."""


def _name_unknown_fields(section: str, kind: type[Any]) -> None:
    """Let the error of a field that a section has not name the nearest one that it has."""
    known = [each.name for each in dataclasses.fields(kind)]
    made = kind.__init__

    @functools.wraps(made)
    def init(self: object, *args: object, **values: object) -> None:
        for name, value in values.items():
            if name not in known:
                given = f"{section}.{name} = {shown(value)}"
                raise ScenarioError(f"{given}: there is no such key; {suggestion(name, known)}")
        made(self, *args, **values)

    kind.__init__ = init


for _section, _kind in SECTIONS.items():
    _name_unknown_fields(_section, _kind)
