"""The table of notes, which the core holds, and what of it others ask."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip import _core

if TYPE_CHECKING:
    from stickslip.scenario.scenario import Scenario

STEADY_PULSES = 4
"""Fewest pulses whose measuring window, from the end of the third, has no start-up; section VII."""


def _limits(row: dict[str, Any]) -> list[str]:
    return [f"{row['value']} > {row['above']:g}"] if "above" in row else []


TABLE = {"notes": [{**row, "when": _limits(row)} for row in _core.note_rows]}
"""Its rows (readings/note_rows.cpp): code and text, name and limit of the number concerned if there
are some, and of a note that is counted in sweeps what many runs are."""


def resting_force(scenario: Scenario) -> float:
    """Normal force on a body that lies still without field: weight and adhesion, N."""
    return scenario.robot.mass * scenario.environment.gravity + scenario.contact.adhesion
