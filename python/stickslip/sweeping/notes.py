"""Notes of many simulations: how many of them would have each note."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from stickslip import _core
from stickslip._util.note import Note
from stickslip.errors import ScenarioError
from stickslip.simulation.note import by_seriousness
from stickslip.simulation.note_table import TABLE
from stickslip.simulation.quantities import NUMBERS
from stickslip.simulation.scenario_notes import scenario_notes
from stickslip.sweeping.points import Points


def notes_of(points: Points, columns: Mapping[str, NDArray[Any]], things: str) -> list[Note]:
    """The most serious first; the value of what the runs do is the number of `things` that do it.

    `columns` are those of the core by name, of all points. Notes on the scenario are those that do
    not depend on what is varied.
    """
    ok = columns["status"] == 0
    pulses = points.at_each("drive.pulses").reshape(ok.shape)[ok]
    numbers = {name: columns[name][ok] for name in NUMBERS if name in columns}
    counts = _core.count_notes(points.scenario.to_core(), numbers, pulses)
    still = (columns["mean_velocity"] == 0.0) & (columns["mean_velocity_y"] == 0.0)
    still &= columns["theta_min"] == columns["theta_max"]
    counts["rest"] = int((still & ok).sum())
    texts = {row["code"]: row["many"] for row in TABLE["notes"] if "many" in row}
    texts["rest"] = "the robot never moved; the notes of such a run alone say why"
    notes = [
        Note(code, f"{count} of {points.count} {things}: {texts[code]}", float(count))
        for code, count in counts.items()
        if count
    ]
    ends = []
    for end in (0, -1):
        changes = {key: points.at_each(key).flat[end].item() for key in points.keys}
        try:
            ends.append(scenario_notes(points.scenario.replace(changes)))
        except ScenarioError:  # a point that is refused
            return by_seriousness(notes)
    return by_seriousness([*notes, *(note for note in ends[0] if note in ends[1])])
