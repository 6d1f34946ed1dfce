"""The order of the notes of runs, and how they are printed and stored."""

from __future__ import annotations

import json
from collections.abc import Iterable

from stickslip._util.note import Note

MOST_SHOWN = 4
"""Notes that are printed at once; all are in `Run.notes` and in the JSON output."""

CODES = (
    # What was not simulated or measured whole.
    "record-cut", "condition-not-met", "window-cut",
    # Values in another unit, as far as can be seen.
    "unit-map", "unit-map-background", "unit-time", "unit-length", "unit-mass",
    "unit-inductance", "unit-angle",
    # A robot that does not walk.
    "rest-no-field", "rest-no-moment", "rest-torque", "rest-adhesion", "rest-drag", "rest-friction",
    "rest",
    "no-pulses", "flight", "no-friction", "dragged", "pulled", "backward", "roll-over",
    "beyond-upright", "no-slip",
    # A motion whose mean velocity says less than it seems to.
    "field-change", "velocity-grows", "turning", "start-up", "window-short", "pulses-short",
    "fluid", "inner",
    # Other values that are probably mistakes.
    "hidden-key", "prior", "inductance", "capacitor",
    "voltage", "density", "moment", "steep-surface", "adhesion", "tangential-restitution",
    "tolerance",
    # Facts, without a fault.
    "map", "shake-mean",
)  # fmt: skip
"""Codes of the notes of runs, the most serious first."""


def by_seriousness(notes: Iterable[Note]) -> list[Note]:
    """The most serious first."""
    ranks = {code: rank for rank, code in enumerate(CODES)}
    return sorted(notes, key=lambda note: ranks.get(note.code, len(CODES)))


def shown_lines(notes: Iterable[Note]) -> list[str]:
    """The notes that are printed, a line each, and how many more there are."""
    texts = [note.text for note in by_seriousness(notes)]
    more = len(texts) - MOST_SHOWN
    return texts[:MOST_SHOWN] + ([f"{more} more notes; --json has all"] if more > 0 else [])


def notes_json(notes: Iterable[Note]) -> str:
    """Notes as the attribute of a netCDF file has them."""
    return json.dumps([note.as_dict() for note in notes])


def lines_of_json(text: str) -> list[str]:
    """`shown_lines` of such an attribute."""
    return shown_lines(Note(**values) for values in json.loads(text))
