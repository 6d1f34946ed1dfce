"""The sections of a scenario that are always there."""

from __future__ import annotations

from typing import Any

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
